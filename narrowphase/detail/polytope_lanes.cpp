#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/polytope_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/narrowphase/detail/polytope_reads.hpp>

#ifndef CAROM_NARROWPHASE_POLYTOPE_LANES_ONCE
#define CAROM_NARROWPHASE_POLYTOPE_LANES_ONCE
namespace carom::detail {
namespace {

std::vector<DoubleBundle>& thread_words() {
    thread_local std::vector<DoubleBundle> words;
    return words;
}

}  // namespace
}  // namespace carom::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

Extreme Lowest(std::span<const PointBundle> points, const dvec3& direction) { return lowest_of(points, direction); }

std::array<std::uint32_t, 2> LowestOfTwo(std::span<const PointBundle> a, const dvec3& along_a, std::span<const PointBundle> b,
                                         const dvec3& along_b) {
    return {lowest_of(a, along_a).number, lowest_of(b, along_b).number};
}

Aabb BoundsOf(std::span<const PointBundle> points, const dvec3& origin, const dmat3& axes) {
    const Doubles3 start = everywhere(origin), columns[3] = {everywhere(axes[0]), everywhere(axes[1]), everywhere(axes[2])};
    Doubles lower[3] = {kInfinity, kInfinity, kInfinity}, upper[3] = {-kInfinity, -kInfinity, -kInfinity};
    for (const PointBundle& p : points) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const Doubles3 from = read(p, lane) - start;
            for (int k = 0; k < 3; ++k) {
                const Doubles along = dot(columns[k], from);
                lower[k] = min(along, lower[k]);
                upper[k] = max(along, upper[k]);
            }
        }
    }
    Aabb bounds;
    for (int k = 0; k < 3; ++k) {
        bounds.lower[k] = least_lane(lower[k]);
        bounds.upper[k] = greatest_lane(upper[k]);
    }
    return bounds;
}

Extreme FaceAlong(std::span<const PlaneBundle> planes, const dvec3& direction) {
    const Doubles3 along = everywhere(direction);
    Greatest best;
    Doubles numbers = double_lane_numbers();
    for (const PlaneBundle& p : planes) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const Doubles value = dot(read_normals(p, lane), along);
            best.offer(select(load(p.offset.lane + lane) == Doubles(kInfinity), Doubles(-kInfinity), value), numbers);
            numbers = numbers + Doubles(kLaneStep);
        }
    }
    return best.take();
}

struct Motion {
    Doubles3 columns[3];
    Doubles3 origin;
    HWY_INLINE Doubles3 turned(const Doubles3& v) const { return (columns[0] * v.x + columns[1] * v.y) + columns[2] * v.z; }
};

void PlacePolytope(std::span<const PointBundle> points, std::span<const PlaneBundle> planes, const dmat3& axes, const dvec3& origin,
                   PointBundle* to_points, PlaneBundle* to_planes) {
    const Motion motion{{everywhere(axes[0]), everywhere(axes[1]), everywhere(axes[2])}, everywhere(origin)};
    for (const PointBundle& p : points) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const Doubles3 moved = motion.turned(read(p, lane)) + motion.origin;
            store(moved.x, to_points->x.lane + lane);
            store(moved.y, to_points->y.lane + lane);
            store(moved.z, to_points->z.lane + lane);
        }
        ++to_points;
    }
    for (const PlaneBundle& p : planes) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const Doubles3 normal = motion.turned(read_normals(p, lane));
            store(normal.x, to_planes->x.lane + lane);
            store(normal.y, to_planes->y.lane + lane);
            store(normal.z, to_planes->z.lane + lane);
            store(load(p.offset.lane + lane) + dot(normal, motion.origin), to_planes->offset.lane + lane);
        }
        ++to_planes;
    }
}

void ListEdgesAboveOne(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& out) {
    std::vector<DoubleBundle>& words = thread_words();
    mark_above(p, points, floor, words);
    list_edges(
        p, words, [](std::uint64_t either) { return either != 0; }, out);
}

void ListEdgesAboveBoth(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& out) {
    std::vector<DoubleBundle>& words = thread_words();
    const std::uint64_t all = mark_above(p, points, floor, words);
    list_edges(
        p, words, [all](std::uint64_t either) { return either == all; }, out);
}

Extreme HighestFace(std::span<const PlaneBundle> planes, const dvec3& from, const dvec3& to) {
    const Doubles3 one = everywhere(from), other = everywhere(to);
    Greatest best;
    Doubles numbers = double_lane_numbers();
    for (const PlaneBundle& p : planes) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            best.offer(min(heights(p, lane, one), heights(p, lane, other)), numbers);
            numbers = numbers + Doubles(kLaneStep);
        }
    }
    return best.take();
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(Lowest);
HWY_EXPORT(LowestOfTwo);
HWY_EXPORT(BoundsOf);
HWY_EXPORT(FaceAlong);
HWY_EXPORT(PlacePolytope);
HWY_EXPORT(HighestFace);
HWY_EXPORT(ListEdgesAboveOne);
HWY_EXPORT(ListEdgesAboveBoth);

void place_polytope(std::span<const PointBundle> points, std::span<const PlaneBundle> planes, const dmat3& axes, const dvec3& origin,
                    PointBundle* to_points, PlaneBundle* to_planes) {
    HWY_DYNAMIC_DISPATCH(PlacePolytope)(points, planes, axes, origin, to_points, to_planes);
}
Extreme lowest(std::span<const PointBundle> points, const dvec3& direction) noexcept {
    return HWY_DYNAMIC_DISPATCH(Lowest)(points, direction);
}
std::array<std::uint32_t, 2> lowest_of_two(std::span<const PointBundle> a, const dvec3& along_a, std::span<const PointBundle> b,
                                           const dvec3& along_b) noexcept {
    return HWY_DYNAMIC_DISPATCH(LowestOfTwo)(a, along_a, b, along_b);
}
Aabb bounds_of(const Polytope& p, const dvec3& origin, const dmat3& axes) noexcept {
    return HWY_DYNAMIC_DISPATCH(BoundsOf)(p.points, origin, axes);
}
Extreme face_along(const Polytope& p, const dvec3& direction) noexcept { return HWY_DYNAMIC_DISPATCH(FaceAlong)(p.planes, direction); }
Extreme highest_face(const Polytope& p, const dvec3& from, const dvec3& to) noexcept {
    return HWY_DYNAMIC_DISPATCH(HighestFace)(p.planes, from, to);
}
void list_edges_above_one(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& numbers) {
    HWY_DYNAMIC_DISPATCH(ListEdgesAboveOne)(p, points, floor, numbers);
}
void list_edges_above_both(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& numbers) {
    HWY_DYNAMIC_DISPATCH(ListEdgesAboveBoth)(p, points, floor, numbers);
}
}  // namespace carom::detail
#endif
