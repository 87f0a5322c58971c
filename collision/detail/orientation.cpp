#include <carom/collision/detail/orientation.hpp>
#include <carom/core/check.hpp>

namespace carom::detail {
namespace {

/// A sum held without rounding, as non-zero doubles that do not overlap, in order of growing magnitude.
class ExactSum {
public:
    void add(double value) noexcept {
        int kept = 0;
        for (int i = 0; i < count_; ++i) {
            // Knuth's two-sum: sum + error = value + terms_[i], exactly.
            const double sum = value + terms_[i];
            const double part = sum - value;
            const double error = (value - (sum - part)) + (terms_[i] - part);
            if (error != 0.0) terms_[kept++] = error;
            value = sum;
        }
        count_ = kept;
        if (value != 0.0) terms_[count_++] = value;
    }

    [[nodiscard]] int sign() const noexcept {
        if (count_ == 0) return 0;
        return terms_[count_ - 1] > 0.0 ? 1 : -1;
    }

private:
    static constexpr int kCapacity = 48;  // 24 triple products in two parts each
    double terms_[kCapacity];
    int count_ = 0;
};

/// Adds sign · x y z, where each factor has 24 bits.
void add_product(ExactSum& sum, double sign, double x, double y, double z) noexcept {
    const double xy = sign * x * y;  // 48 bits: exact
    // Dekker's split leaves two halves of at most 26 bits, so that each times z is exact.
    const double scaled = 134217729.0 * xy;  // 2^27 + 1
    const double high = scaled - (scaled - xy);
    sum.add(high * z);
    sum.add((xy - high) * z);
}

/// Adds sign · u · (v × w).
void add_triple(ExactSum& sum, double sign, const dvec3& u, const dvec3& v, const dvec3& w) noexcept {
    add_product(sum, sign, u.x, v.y, w.z);
    add_product(sum, sign, u.y, v.z, w.x);
    add_product(sum, sign, u.z, v.x, w.y);
    add_product(sum, -sign, u.x, v.z, w.y);
    add_product(sum, -sign, u.y, v.x, w.z);
    add_product(sum, -sign, u.z, v.y, w.x);
}

[[maybe_unused]] bool is_float(const dvec3& p) noexcept { return dvec3{vec3{p}} == p; }

}  // namespace

int orientation(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) noexcept {
    CAROM_ASSERT(is_float(a) && is_float(b) && is_float(c) && is_float(d));
    ExactSum sum;
    add_triple(sum, 1.0, b, c, d);
    add_triple(sum, -1.0, a, c, d);
    add_triple(sum, 1.0, a, b, d);
    add_triple(sum, -1.0, a, b, c);
    return sum.sign();
}

}  // namespace carom::detail
