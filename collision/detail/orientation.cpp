#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/detail/orientation.hpp>
#include <carom/core/check.hpp>

#include <cmath>

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
    static constexpr int kCapacity = 96;  // 24 triple products in four parts each
    double terms_[kCapacity];
    int count_ = 0;
};

void add_product(ExactSum& sum, double x, double y) noexcept {
    const double product = x * y;
    sum.add(product_error(x, y, product));
    sum.add(product);
}

/// Adds sign · x y z.
void add_product(ExactSum& sum, double sign, double x, double y, double z) noexcept {
    const double xy = sign * x * y;
    add_product(sum, product_error(sign * x, y, xy), z);
    add_product(sum, xy, z);
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

bool in_range(double x) noexcept { return x == 0.0 || (std::abs(x) >= 0x1p-300 && std::abs(x) <= 0x1p300); }
bool in_range(const dvec3& p) noexcept { return in_range(p.x) && in_range(p.y) && in_range(p.z); }

/// Whether x - y is `difference`, exactly (Knuth's two-sum has no error).
bool is_exact(double x, double y, double difference) noexcept {
    const double part = x - difference;
    return ((x - (difference + part)) + (part - y)) == 0.0;
}
bool is_exact(const dvec3& x, const dvec3& y, const dvec3& difference) noexcept {
    return is_exact(x.x, y.x, difference.x) && is_exact(x.y, y.y, difference.y) && is_exact(x.z, y.z, difference.z);
}

}  // namespace

int exact_orientation(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) noexcept {
    CAROM_ASSERT(in_range(a) && in_range(b) && in_range(c) && in_range(d));
    ExactSum sum;
    // Differences of corners that are floats, and of ones near each other, have no error as a rule: then six products are all.
    const dvec3 u = b - a, v = c - a, w = d - a;
    if (is_exact(b, a, u) && is_exact(c, a, v) && is_exact(d, a, w) && in_range(u) && in_range(v) && in_range(w)) {
        add_triple(sum, 1.0, u, v, w);
        return sum.sign();
    }
    add_triple(sum, 1.0, b, c, d);
    add_triple(sum, -1.0, a, c, d);
    add_triple(sum, 1.0, a, b, d);
    add_triple(sum, -1.0, a, b, c);
    return sum.sign();
}

namespace {

int exact_orientation(const dvec2& a, const dvec2& b, const dvec2& c) noexcept {
    ExactSum sum;
    const dvec2* const corners[3] = {&a, &b, &c};
    for (int k = 0; k < 3; ++k) {
        const dvec2 &p = *corners[k], &q = *corners[(k + 1) % 3];
        add_product(sum, p.x, q.y);
        add_product(sum, -p.y, q.x);
    }
    return sum.sign();
}

constexpr double kUnit = 0x1p-53;

}  // namespace

int orientation(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) noexcept {
    const int sign = FilteredCross(b - a, c - a).side(d - a);
    return sign != 0 ? sign : exact_orientation(a, b, c, d);
}

int orientation(const dvec2& a, const dvec2& b, const dvec2& c) noexcept {
    const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
    const double determinant = left - right;
    const double error = (3.0 + 16.0 * kUnit) * kUnit * (std::abs(left) + std::abs(right)) + 0x1p-1000;
    if (determinant > error) return 1;
    if (determinant < -error) return -1;
    return exact_orientation(a, b, c);
}

}  // namespace carom::detail
