#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/polytope_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#ifndef CAROM_NARROWPHASE_POLYTOPE_LANES_ONCE
#define CAROM_NARROWPHASE_POLYTOPE_LANES_ONCE
namespace carom::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Eight edges, with the normals beside them.
struct EdgeBundle {
    PointBundle from, direction, left, right;
};

// Buffers of a thread, which grow once.
struct LaneScratch {
    std::vector<DoubleBundle> promises;      // by face: how high it can be at most
    std::vector<std::uint64_t> above[2];     // by plane, a bit: whether a point lies above the floor over it
    std::vector<Polytope::Edge> edges_of_a;
    std::vector<EdgeBundle> edges_of_b;
    std::vector<std::uint32_t> numbers_of_a, numbers_of_b;
};

LaneScratch& lane_scratch() {
    thread_local LaneScratch scratch;
    return scratch;
}

bool bit(const std::vector<std::uint64_t>& words, std::uint32_t k) noexcept { return (words[k / 64] >> (k % 64) & 1u) != 0; }

}  // namespace
}  // namespace carom::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

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

Extreme lowest_of(std::span<const PointBundle> points, const dvec3& direction) {
    const Doubles3 along = everywhere(direction);
    constexpr std::size_t kKept = 4;  // bundles whose heights are kept, so that up to 32 points need no second look
    alignas(64) double kept[kKept * kWidth];
    Doubles best(kInfinity);
    for (std::size_t k = 0; k < points.size(); ++k) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const Doubles height = dot(read(points[k], lane), along);
            if (k < kKept) store(height, kept + k * kWidth + static_cast<std::size_t>(lane));
            best = min(height, best);
        }
    }
    const double least = least_lane(best);
    // Of the kept ones in one word, without a branch a bundle.
    const std::size_t kept_points = std::min(points.size(), kKept) * kWidth;
    std::uint32_t equal = 0;
    for (std::size_t i = 0; i < kept_points; i += kLaneStep) equal |= static_cast<std::uint32_t>(bits(load(kept + i) == Doubles(least))) << i;
    if (equal != 0) return {least, static_cast<std::uint32_t>(std::countr_zero(equal))};
    for (std::size_t k = kKept; k < points.size(); ++k) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const unsigned found = bits(dot(read(points[k], lane), along) == Doubles(least));
            if (found != 0) return {least, static_cast<std::uint32_t>(k * kWidth) + static_cast<std::uint32_t>(lane + std::countr_zero(found))};
        }
    }
    return {least, 0};
}

Extreme Lowest(std::span<const PointBundle> points, const dvec3& direction) { return lowest_of(points, direction); }

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
    HWY_INLINE Doubles3 turned(const Doubles3& v) const {
        return (columns[0] * v.x + columns[1] * v.y) + columns[2] * v.z;
    }
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

// Lowers each promise to the height of `point` over the plane.
HWY_INLINE void lower_promises(std::span<const PlaneBundle> planes, const dvec3& point, DoubleBundle* promises) {
    const Doubles3 p = everywhere(point);
    for (const PlaneBundle& plane : planes) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            double* const at = promises->lane + lane;
            store(min(load(at), heights(plane, lane, p)), at);
        }
        ++promises;
    }
}

HWY_INLINE Extreme best_promise(std::span<const DoubleBundle> promises) {
    Greatest best;
    Doubles numbers = double_lane_numbers();
    for (const DoubleBundle& p : promises) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            best.offer(load(p.lane + lane), numbers);
            numbers = numbers + Doubles(kLaneStep);
        }
    }
    return best.take();
}

FaceSeparation best_plane(std::span<const PlaneBundle> planes, std::span<const PointBundle> points, const dvec3& point, double floor,
                          double enough, std::vector<DoubleBundle>& promises) {
    constexpr DoubleBundle kNothingKnown{{kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity}};
    promises.assign(planes.size(), kNothingKnown);
    lower_promises(planes, point, promises.data());
    FaceSeparation best;
    best.separation = floor;
    std::uint32_t last = 0;
    bool met = false;
    for (;;) {
        const Extreme next = best_promise(promises);
        if (!(next.value > best.separation)) break;
        const Extreme low = lowest_of(points, normal_of(planes, next.number));
        const double separation = low.value - offset_of(planes, next.number);
        met = true;
        last = low.number;
        if (separation > best.separation) best = {separation, next.number, low.number};
        if (best.separation > enough) break;
        lower_promises(planes, point_of(points, low.number), promises.data());
        promises[next.number / kWidth].lane[next.number % kWidth] = -kInfinity;
    }
    if (best.separation == floor && met) best.deepest = last;
    return best;
}

FaceSeparations BestFaces(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double enough) {
    std::vector<DoubleBundle>& promises = lane_scratch().promises;
    FaceSeparations pair;
    pair.of_a = best_plane(a.planes, b.points, point_of_b, -kInfinity, enough, promises);
    if (!(pair.of_a.separation > enough)) pair.of_b = best_plane(b.planes, a.points, point_of_a, pair.of_a.separation, enough, promises);
    return pair;
}

FaceSeparation BestSide(const Polytope& triangle, const Polytope& other, double floor) {
    return best_plane({&triangle.sides, 1}, other.points, other.centre, floor, kInfinity, lane_scratch().promises);
}

// Sets the bits of the planes over which `point` is higher than `floor`.
void mark_above(const Polytope& p, const dvec3& point, double floor, std::vector<std::uint64_t>& words) {
    const Doubles3 at = everywhere(point);
    const Doubles limit(floor);
    words.assign((p.face_count() + p.side_count + 63) / 64, 0);
    std::uint32_t first = 0;
    for (const PlaneBundle& plane : p.planes) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            const std::uint64_t found = bits(heights(plane, lane, at) > limit);  // empty lanes never are
            if (found != 0) words[first / 64] |= found << (first % 64);
            first += static_cast<std::uint32_t>(kLaneStep);
        }
    }
    for (std::uint32_t k = 0; k < p.side_count; ++k) {
        const std::uint32_t plane = p.face_count() + k;
        const double height = glm::dot(normal_of({&p.sides, 1}, k), point) - offset_of({&p.sides, 1}, k);
        if (height > floor) words[plane / 64] |= std::uint64_t{1} << (plane % 64);
    }
}

template <class Wanted>
HWY_INLINE void list_edges(const Polytope& p, const dvec3 (&points)[2], double floor, const Wanted& wanted, std::vector<std::uint32_t>& out) {
    LaneScratch& scratch = lane_scratch();
    mark_above(p, points[0], floor, scratch.above[0]);
    mark_above(p, points[1], floor, scratch.above[1]);
    const auto &first = scratch.above[0], &second = scratch.above[1];
    out.clear();
    for (std::uint32_t k = 0; k < p.edge_count(); ++k) {
        const std::uint32_t left = p.half_edges[2 * k].face, right = p.half_edges[2 * k + 1].face;
        if (wanted(bit(first, left) || bit(first, right), bit(second, left) || bit(second, right))) out.push_back(k);
    }
}

void ListEdgesAboveOne(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& out) {
    list_edges(p, points, floor, [](bool one, bool other) { return one || other; }, out);
}

void ListEdgesAboveBoth(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& out) {
    list_edges(p, points, floor, [](bool one, bool other) { return one && other; }, out);
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

// Whether the arc of edge `e` crosses the arcs of edges `f`, seen from the other side, on the sphere of normals.
HWY_INLINE DoubleMask arcs_cross(const Polytope::Edge& e, const EdgeBundle& f, const Doubles3& f_direction, int lane) {
    const Doubles zero(0.0);
    const Doubles3 e_direction = everywhere(e.direction);
    const Doubles cba = -dot(read(f.left, lane), e_direction), dba = -dot(read(f.right, lane), e_direction);
    const Doubles adc = dot(everywhere(e.left), f_direction), bdc = dot(everywhere(e.right), f_direction);
    return (cba * dba < zero) & (adc * bdc < zero) & (cba * bdc > zero);
}

// The separations of edge `e` and edges `f` along their common normals, outward from e; -infinity where they make no axis.
HWY_INLINE Doubles separations(const Polytope::Edge& e, const EdgeBundle& f, int lane) {
    const Doubles3 direction = read(f.direction, lane);
    const DoubleMask crossing = arcs_cross(e, f, direction, lane);
    const Doubles never(-kInfinity);
    if (none(crossing)) return never;
    const Doubles3 normal = cross(everywhere(e.direction), direction);
    const Doubles length_sq = dot(normal, normal);
    const Doubles sides = Doubles(glm::dot(e.direction, e.direction)) * dot(direction, direction);
    const Doubles along = dot(normal, read(f.from, lane) - everywhere(e.from)) / sqrt(length_sq);
    const Doubles outward = select(dot(normal, everywhere(e.left + e.right)) < Doubles(0.0), -along, along);
    return select(crossing & (length_sq > Doubles(kParallelSine * kParallelSine) * sides), outward, never);
}

void fill_edges(const Polytope& p, std::span<const std::uint32_t> numbers, std::vector<EdgeBundle>& out) {
    out.assign(double_bundle_count(numbers.size()), EdgeBundle{});  // edges without length cross nothing
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        EdgeBundle& bundle = out[i / kWidth];
        const Polytope::Edge e = p.edge(numbers[i]);
        set_point(bundle.from, i % kWidth, e.from);
        set_point(bundle.direction, i % kWidth, e.direction);
        set_point(bundle.left, i % kWidth, e.left);
        set_point(bundle.right, i % kWidth, e.right);
    }
}

EdgePair BestEdges(const Polytope& a, const Polytope& b, const dvec3 (&points_of_a)[2], const dvec3 (&points_of_b)[2], double floor) {
    LaneScratch& scratch = lane_scratch();
    ListEdgesAboveBoth(a, points_of_b, floor, scratch.numbers_of_a);
    if (scratch.numbers_of_a.empty()) return {};
    ListEdgesAboveBoth(b, points_of_a, floor, scratch.numbers_of_b);
    fill_edges(b, scratch.numbers_of_b, scratch.edges_of_b);
    EdgePair best;
    for (const std::uint32_t number : scratch.numbers_of_a) {
        const Polytope::Edge e = a.edge(number);
        Greatest of_e;
        Doubles places = double_lane_numbers();
        for (const EdgeBundle& f : scratch.edges_of_b) {
            for (int lane = 0; lane < kWidth; lane += kLaneStep) {
                of_e.offer(separations(e, f, lane), places);
                places = places + Doubles(kLaneStep);
            }
        }
        const Extreme found = of_e.take();
        if (found.value > best.separation) best = {found.value, dvec3{0.0}, number, scratch.numbers_of_b[found.number]};
    }
    if (best.separation == -kInfinity) return best;
    const Polytope::Edge e = a.edge(best.a);
    const dvec3 normal = glm::cross(e.direction, b.edge(best.b).direction);
    best.normal = normal * ((glm::dot(normal, e.left + e.right) < 0.0 ? -1.0 : 1.0) / std::sqrt(glm::dot(normal, normal)));
    return best;
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(Lowest);
HWY_EXPORT(FaceAlong);
HWY_EXPORT(PlacePolytope);
HWY_EXPORT(BestFaces);
HWY_EXPORT(BestSide);
HWY_EXPORT(BestEdges);
HWY_EXPORT(HighestFace);
HWY_EXPORT(ListEdgesAboveOne);
HWY_EXPORT(ListEdgesAboveBoth);

void place_polytope(std::span<const PointBundle> points, std::span<const PlaneBundle> planes, const dmat3& axes, const dvec3& origin,
                    PointBundle* to_points, PlaneBundle* to_planes) {
    HWY_DYNAMIC_DISPATCH(PlacePolytope)(points, planes, axes, origin, to_points, to_planes);
}
Extreme lowest(std::span<const PointBundle> points, const dvec3& direction) noexcept { return HWY_DYNAMIC_DISPATCH(Lowest)(points, direction); }
Extreme face_along(const Polytope& p, const dvec3& direction) noexcept { return HWY_DYNAMIC_DISPATCH(FaceAlong)(p.planes, direction); }
FaceSeparations best_faces(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double enough) {
    return HWY_DYNAMIC_DISPATCH(BestFaces)(a, b, point_of_a, point_of_b, enough);
}
FaceSeparation best_side(const Polytope& triangle, const Polytope& other, double floor) {
    return HWY_DYNAMIC_DISPATCH(BestSide)(triangle, other, floor);
}
EdgePair best_edges(const Polytope& a, const Polytope& b, const dvec3 (&points_of_a)[2], const dvec3 (&points_of_b)[2], double floor) {
    return HWY_DYNAMIC_DISPATCH(BestEdges)(a, b, points_of_a, points_of_b, floor);
}
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
