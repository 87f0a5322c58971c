// What kernels over the vertices, planes and edges of a polytope share: reading bundles, the best of many, and which planes a point lies above.
//
//   mark_above(p, points, floor, above); list_edges(p, [&](std::uint64_t either) { return either == all; }, above, numbers);

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_POLYTOPE_READS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_POLYTOPE_READS_HPP
#undef CAROM_NARROWPHASE_POLYTOPE_READS_HPP
#else
#define CAROM_NARROWPHASE_POLYTOPE_READS_HPP
#endif

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLaneStep = kDoubleLanes;
constexpr int kWidth = kDoubleBundleWidth;

HWY_INLINE Doubles3 everywhere(const dvec3& v) { return {Doubles(v.x), Doubles(v.y), Doubles(v.z)}; }
HWY_INLINE Doubles3 read(const PointBundle& p, int lane) { return {load(p.x.lane + lane), load(p.y.lane + lane), load(p.z.lane + lane)}; }
HWY_INLINE Doubles3 read_normals(const PlaneBundle& p, int lane) {
    return {load(p.x.lane + lane), load(p.y.lane + lane), load(p.z.lane + lane)};
}
HWY_INLINE Doubles heights(const PlaneBundle& p, int lane, const Doubles3& point) {
    return dot(read_normals(p, lane), point) - load(p.offset.lane + lane);
}

// The greatest of many values and the first of those that have it.
class Greatest {
public:
    HWY_INLINE Greatest() : best_(-kInfinity), at_(0.0) {}
    HWY_INLINE void offer(Doubles values, Doubles numbers) {
        const DoubleMask better = values > best_;
        best_ = select(better, values, best_);
        at_ = select(better, numbers, at_);
    }
    HWY_INLINE Extreme take() const {
        const double value = greatest_lane(best_);
        return {value, static_cast<std::uint32_t>(least_lane(select(best_ == Doubles(value), at_, Doubles(kInfinity))))};
    }

private:
    Doubles best_, at_;
};

template <std::size_t count>
HWY_INLINE Doubles least_of(const Doubles* values) {
    if constexpr (count == 1) {
        return values[0];
    } else {
        return min(least_of<count / 2>(values), least_of<count - count / 2>(values + count / 2));
    }
}

// Of up to 32 points: all heights stay in registers, and no branch depends on them.
template <std::size_t bundles>
HWY_INLINE Extreme lowest_of_few(const PointBundle* points, const Doubles3& along) {
    constexpr std::size_t kStep = kLaneStep, kParts = kWidth / kStep, kCount = bundles * kParts;
    Doubles height[kCount];
#pragma GCC unroll 16
    for (std::size_t k = 0; k < kCount; ++k) height[k] = dot(read(points[k / kParts], static_cast<int>(k % kParts * kStep)), along);
    const double least = least_lane(least_of<kCount>(height));
    std::uint32_t equal = 0;
#pragma GCC unroll 16
    for (std::size_t k = 0; k < kCount; ++k) equal |= static_cast<std::uint32_t>(bits(height[k] == Doubles(least))) << (k * kStep);
    return {least, equal != 0 ? static_cast<std::uint32_t>(std::countr_zero(equal)) : 0};
}

HWY_INLINE Extreme lowest_of_many(std::span<const PointBundle> points, const Doubles3& along) {
    Doubles best(kInfinity);
    for (const PointBundle& p : points) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) best = min(dot(read(p, lane), along), best);
    }
    const double least = least_lane(best);
    for (std::size_t k = 0; k < points.size(); ++k) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const unsigned found = bits(dot(read(points[k], lane), along) == Doubles(least));
            if (found != 0)
                return {least, static_cast<std::uint32_t>(k * kWidth) + static_cast<std::uint32_t>(lane + std::countr_zero(found))};
        }
    }
    return {least, 0};
}

HWY_INLINE Extreme lowest_of(std::span<const PointBundle> points, const dvec3& direction) {
    const Doubles3 along = everywhere(direction);
    switch (points.size()) {
        case 1:
            return lowest_of_few<1>(points.data(), along);
        case 2:
            return lowest_of_few<2>(points.data(), along);
        case 3:
            return lowest_of_few<3>(points.data(), along);
        case 4:
            return lowest_of_few<4>(points.data(), along);
        default:
            return lowest_of_many(points, along);
    }
}

// For each plane, sides after faces, a word whose bit i says whether point i lies higher over it than `floor`. At most 64 points are looked at.
// @return the word of a plane that all of these lie above.
HWY_INLINE std::uint64_t mark_above(const Polytope& p, std::span<const dvec3> points, double floor, std::vector<DoubleBundle>& words) {
    const std::size_t count = std::min<std::size_t>(points.size(), 64);
    const hn::Repartition<std::uint64_t, DoubleTag> word_tag;
    words.resize(p.planes.size() + (p.side_count > 0 ? 1 : 0));
    const auto mark = [&](const PlaneBundle& planes, DoubleBundle& to) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            auto marks = hn::Zero(word_tag);
            for (std::size_t i = 0; i < count; ++i) {
                const DoubleMask is_above =
                    heights(planes, lane, everywhere(points[i])) > Doubles(floor);  // never in lanes without a plane
                const auto bit = hn::Set(word_tag, std::uint64_t{1} << i);
                marks = hn::Or(marks, hn::IfThenElseZero(hn::RebindMask(word_tag, is_above.raw), bit));
            }
            store(Doubles(hn::BitCast(DoubleTag(), marks)), to.lane + lane);
        }
    };
    for (std::size_t k = 0; k < p.planes.size(); ++k) mark(p.planes[k], words[k]);
    if (p.side_count > 0) mark(p.sides, words.back());
    return count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

// The edges of whose two planes the words, joined, are `wanted`.
template <class Wanted>
HWY_INLINE void list_edges(const Polytope& p, const std::vector<DoubleBundle>& words, const Wanted& wanted,
                           std::vector<std::uint32_t>& out) {
    const std::uint32_t faces = p.face_count(), gap = static_cast<std::uint32_t>(kWidth * p.planes.size()) - faces;
    const double* const of_plane = words.data()->lane;
    const auto word = [&](std::uint32_t plane) { return std::bit_cast<std::uint64_t>(of_plane[plane < faces ? plane : plane + gap]); };
    out.resize(p.edge_count());
    std::size_t count = 0;  // no branch an edge: few are wanted, and which cannot be foretold
    for (std::uint32_t k = 0; k < p.edge_count(); ++k) {
        out[count] = k;
        count += wanted(word(p.half_edges[2 * k].face) | word(p.half_edges[2 * k + 1].face)) ? 1 : 0;
    }
    out.resize(count);
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
