#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/search_points.cpp>
#include <hwy/foreach_target.h>

#include <carom/narrowphase/detail/polytope_reads.hpp>
#include <carom/narrowphase/detail/search_points.hpp>
#include <carom/narrowphase/detail/simplex_parts.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#ifndef CAROM_NARROWPHASE_SEARCH_POINTS_ONCE
#define CAROM_NARROWPHASE_SEARCH_POINTS_ONCE
namespace carom::detail {
namespace {

constexpr std::size_t kMostBundles = 8;

// A point of the difference, and whose it is.
struct Difference {
    dvec3 w;
    std::uint32_t a, b;
};

// The simplex. Corners stay where they were put, whichever are kept: what was just written number by number is slow to copy.
struct Corners {
    std::array<Difference, 4> place;
    unsigned order = 0;  // four bits for the place of each corner
    int count = 0;

    [[nodiscard]] const Difference& operator[](int i) const noexcept { return place[order >> 4 * i & 3u]; }
    // A place for a corner after the last.
    Difference& add() noexcept {
        unsigned taken = 0;
        for (int i = 0; i < count; ++i) taken |= 1u << (order >> 4 * i & 3u);
        const auto free = static_cast<unsigned>(std::countr_one(taken));
        order = (order & ((1u << 4 * count) - 1u)) | free << 4 * count;
        ++count;
        return place[free];
    }
    void keep(const DirectedPart& part) noexcept {
        unsigned kept = 0;
        for (int i = 0; i < part.count; ++i) kept |= (order >> 4 * part.corner[i] & 3u) << 4 * i;
        order = kept;
        count = part.count;
    }
};

// The eight corners of a box about its centre, in the order of ConvexCore::place().
PointBundle corners_of(const dvec3& half) noexcept {
    PointBundle points;
    for (std::size_t k = 0; k < 8; ++k) {
        set_point(points, k, {(k & 1) != 0 ? half.x : -half.x, (k & 2) != 0 ? half.y : -half.y, (k & 4) != 0 ? half.z : -half.z});
    }
    return points;
}

}  // namespace
}  // namespace carom::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

// The least of all lanes, in each.
HWY_INLINE Doubles least_everywhere(Doubles x) {
#if HWY_TARGET == HWY_AVX3
    const Doubles half = min(x, Doubles{hn::ConcatLowerUpper(DoubleTag(), x.raw, x.raw)});
    const Doubles quarter = min(half, Doubles{hn::SwapAdjacentBlocks(half.raw)});
    return min(quarter, Doubles{hn::Shuffle01(quarter.raw)});
#else
    return Doubles{hn::MinOfLanes(DoubleTag(), x.raw)};
#endif
}

// The points of a core in the pair's frame, with the bits of ConvexCore::place().
class PlacedPoints {
public:
    HWY_INLINE explicit PlacedPoints(const ConvexCore& core) {
        if (core.kind == ConvexCore::Kind::Box) {
            const PointBundle box = corners_of(core.half);
            place(core, {&box, 1});
        } else {
            place(core, core.bundles);
        }
    }
    // The first of those that are lowest.
    [[nodiscard]] HWY_INLINE std::uint32_t lowest(const dvec3& direction) const {
        const Doubles3 along = everywhere(direction);
        switch (bundles_) {
            case 1:
                return lowest_of_few<1>(along);
            case 2:
                return lowest_of_few<2>(along);
            case 3:
                return lowest_of_few<3>(along);
            case 4:
                return lowest_of_few<4>(along);
            default:
                return lowest_of_many(along);
        }
    }
    [[nodiscard]] HWY_INLINE dvec3 point(std::uint32_t number) const { return {x_[number], y_[number], z_[number]}; }

private:
    HWY_INLINE void place(const ConvexCore& core, std::span<const PointBundle> from) {
        const Doubles3 x = everywhere(core.axes[0]), y = everywhere(core.axes[1]), z = everywhere(core.axes[2]),
                       centre = everywhere(core.centre);
        bundles_ = from.size();
        for (std::size_t k = 0; k < bundles_; ++k) {
            for (int lane = 0; lane < kWidth; lane += kLaneStep) {
                const Doubles3 p = read(from[k], lane);
                const Doubles3 placed = centre + ((x * p.x + y * p.y) + z * p.z);
                const std::size_t to = k * kWidth + static_cast<std::size_t>(lane);
                store(placed.x, x_ + to), store(placed.y, y_ + to), store(placed.z, z_ + to);
            }
        }
    }
    [[nodiscard]] HWY_INLINE Doubles height(std::size_t at, const Doubles3& along) const {
        return dot(Doubles3{load(x_ + at), load(y_ + at), load(z_ + at)}, along);
    }
    // As lowest_of_few() of bundles.
    template <std::size_t bundles>
    [[nodiscard]] HWY_INLINE std::uint32_t lowest_of_few(const Doubles3& along) const {
        constexpr std::size_t kCount = bundles * kWidth / kLaneStep;
        Doubles heights[kCount];
#pragma GCC unroll 16
        for (std::size_t k = 0; k < kCount; ++k) heights[k] = height(k * kLaneStep, along);
        const Doubles least = least_everywhere(least_of<kCount>(heights));
        std::uint32_t equal = 0;
#pragma GCC unroll 16
        for (std::size_t k = 0; k < kCount; ++k) equal |= static_cast<std::uint32_t>(bits(heights[k] == least)) << (k * kLaneStep);
        return equal != 0 ? static_cast<std::uint32_t>(std::countr_zero(equal)) : 0;
    }
    [[nodiscard]] HWY_INLINE std::uint32_t lowest_of_many(const Doubles3& along) const {
        Doubles least(kInfinity);
        for (std::size_t at = 0; at < bundles_ * kWidth; at += kLaneStep) least = min(height(at, along), least);
        least = least_everywhere(least);
        for (std::size_t at = 0; at < bundles_ * kWidth; at += kLaneStep) {
            const unsigned equal = bits(height(at, along) == least);
            if (equal != 0) return static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(std::countr_zero(equal));
        }
        return 0;
    }

    static constexpr std::size_t kMost = kMostBundles * kWidth;
    alignas(64) double x_[kMost];
    alignas(64) double y_[kMost];
    alignas(64) double z_[kMost];
    std::size_t bundles_;
};

class Search {
public:
    HWY_INLINE Search(const CorePair& pair, const ProximityGoal& goal, Proximity& known)
        : goal_(goal), rounding_(pair.rounding), a_(pair.a), b_(pair.b), known_(known), lower_(known.lower) {
        const dvec3 between = pair.a.centre - pair.b.centre;
        v_ = between != dvec3{0.0} ? between : dvec3{0.0, 1.0, 0.0};
    }

    HWY_INLINE bool run(DistanceCache& last) {
        length_ = std::sqrt(glm::dot(v_, v_));
        probe(corners_.add());
        DirectedPart part;
        part.add(0, 1.0, 1.0);
        const bool is_done = go_on(part);
        note_points(part);
        if (is_done) return true;
        last.count = static_cast<std::uint32_t>(corners_.count);
        for (int i = 0; i < corners_.count; ++i) {
            last.a[static_cast<std::size_t>(i)] = corners_[i].a;
            last.b[static_cast<std::size_t>(i)] = corners_[i].b;
        }
        return false;
    }

private:
    // A support point of the difference; the plane across it counts as a bound. `v` points from b to a.
    HWY_INLINE void probe(Difference& next) {
        const std::uint32_t a = a_.lowest(v_), b = b_.lowest(-v_);
        next = {a_.point(a) - b_.point(b), a, b};
        const double bound = glm::dot(v_, next.w) / length_ - rounding_;
        if (bound > lower_) {
            lower_ = bound;
            normal_ = v_;
            normal_length_ = length_;
        }
        ++iterations_;
    }

    [[nodiscard]] HWY_INLINE bool met() const { return upper_ - lower_ <= 3.0 * rounding_ + goal_.tolerance * upper_; }

    // @return whether the search is done, with `part` what is left of the simplex.
    HWY_INLINE bool go_on(DirectedPart& part) {
        double distance_sq = glm::dot(corners_[0].w, corners_[0].w);
        aim(part, corners_[0].w);
        while (true) {
            const double distance = std::sqrt(distance_sq);
            upper_ = distance + rounding_;
            if (!(distance > 4.0 * rounding_)) return false;
            if (goal_.decide >= 0.0 && (lower_ > goal_.decide || upper_ < goal_.decide)) return true;
            if (met()) return true;
            if (iterations_ >= goal_.most_iterations) {
                known_.status = DistanceStatus::Stopped;
                return true;
            }
            Difference& next = corners_.add();
            probe(next);
            const bool ends = met();
            bool again = false;
            for (int i = 0; i + 1 < corners_.count; ++i) again = again || corners_[i].w == next.w;
            if (ends || again) {
                --corners_.count;
                return ends;
            }
            const DirectedPart grown = nearest();
            if (grown.count == 4) {
                if (!holds_origin(corners_, rounding_)) return false;
                known_.status = DistanceStatus::Overlap;
                return true;
            }
            const dvec3 nearer = part_point(corners_, grown);
            const double nearer_sq = glm::dot(nearer, nearer);
            if (!(nearer_sq < distance_sq)) {
                --corners_.count;
                return false;
            }
            part = grown;
            corners_.keep(part);
            for (int i = 0; i < part.count; ++i) part.corner[i] = i;
            aim(part, nearer);
            distance_sq = nearer_sq;
        }
    }

    // The next direction, from b to a: that of the part's point, which need not wait for quotients.
    HWY_INLINE void aim(const DirectedPart& part, const dvec3& point) {
        v_ = part_direction(corners_, part);
        double square = glm::dot(v_, v_);
        if (!(square > 1e-200)) {  // beyond what squares hold
            v_ = point;
            square = glm::dot(v_, v_);
        }
        length_ = std::sqrt(square);
    }

    [[nodiscard]] HWY_INLINE DirectedPart nearest() const {
        switch (corners_.count) {
            case 2:
                return part_of_segment<DirectedPart>(corners_, 0, 1);
            case 3:
                return part_of_triangle<DirectedPart>(corners_, 0, 1, 2);
            default:
                return part_of_tetrahedron<false, DirectedPart>(corners_);
        }
    }

    // The points that are nearest, unless the simplex holds the origin.
    HWY_INLINE void note_points(const DirectedPart& part) {
        if (normal_length_ > 0.0) known_.normal = normal_ * (-1.0 / normal_length_);
        known_.iterations = iterations_;
        if (known_.status == DistanceStatus::Overlap) {
            known_.lower = known_.upper = 0.0;
            return;
        }
        known_.lower = lower_;
        known_.upper = upper_;
        for (int i = 0; i < part.count; ++i) {
            known_.on_a += part.weight[i] * a_.point(corners_[part.corner[i]].a);
            known_.on_b += part.weight[i] * b_.point(corners_[part.corner[i]].b);
        }
    }

    const ProximityGoal goal_;
    const double rounding_;
    PlacedPoints a_, b_;
    Proximity& known_;
    Corners corners_;
    dvec3 v_, normal_{0.0};
    double length_ = 0.0, normal_length_ = 0.0;
    double lower_, upper_ = std::numeric_limits<double>::infinity();  // of the distance
    int iterations_ = 0;
};

bool SearchPoints(const CorePair& pair, const ProximityGoal& goal, Proximity& known, DistanceCache& last) {
    return Search(pair, goal, known).run(last);
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(SearchPoints);

bool is_searched_by_points(const CorePair& pair) noexcept {
    const auto fits = [](const ConvexCore& core) {
        return core.kind == ConvexCore::Kind::Box || (core.kind == ConvexCore::Kind::Points && core.bundles.size() <= kMostBundles);
    };
    return fits(pair.a) && fits(pair.b);
}

bool search_points(const CorePair& pair, const ProximityGoal& goal, Proximity& known, DistanceCache& last) noexcept {
    return HWY_DYNAMIC_DISPATCH(SearchPoints)(pair, goal, known, last);
}
}  // namespace carom::detail
#endif
