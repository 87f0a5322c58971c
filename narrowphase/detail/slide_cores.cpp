#include <carom/narrowphase/detail/gjk_simplex.hpp>
#include <carom/narrowphase/detail/slide_cores.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

constexpr int kMostRounds = 32;

class Slider {
public:
    explicit Slider(const SlideInput& input) noexcept : in_(input) { out_.t = input.t; }

    Slide run() noexcept {
        dvec3 v = in_.a.centre - in_.b.centre;
        double length = std::sqrt(glm::dot(v, v)), last = std::numeric_limits<double>::infinity();
        for (int round = 0; round < kMostRounds && length > 0.0; ++round) {
            const CoreSupport of_a = in_.a.support(-v), of_b = in_.b.support(v);
            const dvec3 w = of_a.point - of_b.point;  // where the two were at first
            const bool moved = advance(v, length, w);
            const bool added = !out_.passes && keep({w - shift_, {}, {}, of_a.index, of_b.index, 1.0});
            if (out_.passes || !(moved || added) || simplex_.count == 4) break;
            v = simplex_.point();
            length = std::sqrt(glm::dot(v, v));
            if (length - in_.least <= in_.near || !(moved || length < last)) break;
            last = length;
        }
        for (int i = 0; i < simplex_.count; ++i) {
            out_.closest.a[out_.closest.count] = static_cast<std::uint32_t>(simplex_[i].index_a);
            out_.closest.b[out_.closest.count++] = static_cast<std::uint32_t>(simplex_[i].index_b);
        }
        return out_;
    }

private:
    // Up to where the plane across `v` through the support point no longer parts the two. @return whether t has moved.
    bool advance(const dvec3& v, double length, const dvec3& w) noexcept {
        const double gap = glm::dot(v, w - shift_) / length - in_.least;
        if (!(gap > 0.0)) return false;
        out_.normal = v * (-1.0 / length);
        const double closing = glm::dot(v, in_.along) / length;  // per unit of t
        if (gap - closing * (1.0 - out_.t) >= 0.0) {
            out_.passes = true;
            return false;
        }
        const double t = out_.t + (gap - std::min(0.5 * in_.near, 0.5 * gap)) / closing * (1.0 - 0x1p-50);
        if (!(t > out_.t)) return false;
        out_.passes = t > in_.until;
        out_.t = t;
        const dvec3 shift = (t - in_.t) * in_.along;
        simplex_.shift(shift_ - shift);  // its rounding has no part in what is proved
        shift_ = shift;
        return true;
    }

    // Makes the simplex the part nearest to the origin of what it was and `next`. @return whether that is new.
    bool keep(const Corner& next) noexcept {
        bool known = false;
        for (int i = 0; i < simplex_.count; ++i) known |= simplex_[i].index_a == next.index_a && simplex_[i].index_b == next.index_b;
        if (!known) simplex_.add(next, 1.0);
        simplex_.keep(nearest_part(simplex_, false));
        return !known;
    }

    const SlideInput in_;
    Slide out_;
    Simplex simplex_;
    dvec3 shift_{0.0};  // of B since it was at in_.t
};

}  // namespace

Slide slide_cores(const SlideInput& input) noexcept { return Slider(input).run(); }

}  // namespace carom::detail
