#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/polytope_search.cpp>
#include <hwy/foreach_target.h>

#include <carom/narrowphase/detail/polytope_reads.hpp>
#include <carom/narrowphase/detail/polytope_search.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <cmath>

#ifndef CAROM_NARROWPHASE_POLYTOPE_SEARCH_ONCE
#define CAROM_NARROWPHASE_POLYTOPE_SEARCH_ONCE
namespace carom::detail {
namespace {

// Eight edges, with the normals beside them.
struct EdgeBundle {
    PointBundle from, direction, left, right;
};

// Of a triangle's corners over eight planes.
struct CornerHeights {
    DoubleBundle of[3];
};

// Buffers of a thread, which grow once.
struct SearchScratch {
    std::vector<CornerHeights> heights;     // over the faces of a
    std::vector<DoubleBundle> promises;     // by face: how high it can be at most
    std::vector<dvec3> met_of_a, met_of_b;  // points that bound the faces of the other
    std::vector<DoubleBundle> words;
    std::vector<std::uint32_t> numbers_of_a, numbers_of_b;
    std::vector<EdgeBundle> edges_of_b;
};

SearchScratch& search_scratch() {
    thread_local SearchScratch scratch;
    return scratch;
}

}  // namespace
}  // namespace carom::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

// Lowers each promise to the height of `point` over the plane. @return the best promise.
template <bool is_first>
HWY_INLINE Extreme lower_promises(std::span<const PlaneBundle> planes, const dvec3& point, std::vector<DoubleBundle>& promises) {
    const Doubles3 p = everywhere(point);
    Greatest best;
    Doubles numbers = double_lane_numbers();
    for (std::size_t k = 0; k < planes.size(); ++k) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            double* const at = promises[k].lane + lane;
            Doubles promise = heights(planes[k], lane, p);
            if constexpr (!is_first) promise = min(load(at), promise);
            store(promise, at);
            best.offer(promise, numbers);
            numbers = numbers + Doubles(kLaneStep);
        }
    }
    return best.take();
}

// @param met  begins with one point of the other polytope, and gets the vertices that were found.
HWY_INLINE FaceSeparation best_plane(std::span<const PlaneBundle> planes, std::span<const PointBundle> points, double floor, double enough,
                                     std::vector<dvec3>& met) {
    std::vector<DoubleBundle>& promises = search_scratch().promises;
    promises.resize(planes.size());
    FaceSeparation best;
    best.separation = floor;
    Extreme next = lower_promises<true>(planes, met.front(), promises);
    while (next.value > best.separation) {
        const Extreme low = lowest_of(points, normal_of(planes, next.number));
        const double separation = low.value - offset_of(planes, next.number);
        if (separation > best.separation) best = {separation, next.number, low.number};
        if (best.separation > enough) break;
        met.push_back(point_of(points, low.number));
        promises[next.number / kWidth].lane[next.number % kWidth] = -kInfinity;
        next = lower_promises<false>(planes, met.back(), promises);
    }
    return best;
}

FaceSeparation BestSide(const Polytope& triangle, const Polytope& other, double floor) {
    std::vector<dvec3>& met = search_scratch().met_of_b;
    met.assign(1, other.centre);
    return best_plane({&triangle.sides, 1}, other.points, floor, kInfinity, met);
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

void list_edges_above(const Polytope& p, std::span<const dvec3> points, double floor, std::vector<std::uint32_t>& out) {
    std::vector<DoubleBundle>& words = search_scratch().words;
    const std::uint64_t all = mark_above(p, points, floor, words);
    list_edges(
        p, words, [all](std::uint64_t either) { return either == all; }, out);
}

// @param arcs  the edges `of_b`, eight by eight.
EdgePair best_of_listed(const Polytope& a, const Polytope& b, std::span<const std::uint32_t> of_a, std::span<const std::uint32_t> of_b,
                        std::span<const EdgeBundle> arcs) {
    // Numbered edge of a by edge of a, so that of equal ones the first pair counts.
    Greatest greatest;
    Doubles places = double_lane_numbers();
    for (const std::uint32_t number : of_a) {
        const Polytope::Edge e = a.edge(number);
        for (const EdgeBundle& f : arcs) {
            for (int lane = 0; lane < kWidth; lane += kLaneStep) {
                greatest.offer(separations(e, f, lane), places);
                places = places + Doubles(kLaneStep);
            }
        }
    }
    const Extreme found = greatest.take();
    EdgePair best;
    if (found.value == -kInfinity) return best;
    const std::size_t width = kWidth * arcs.size();
    best = {found.value, dvec3{0.0}, of_a[found.number / width], of_b[found.number % width]};
    const Polytope::Edge e = a.edge(best.a);
    const dvec3 normal = glm::cross(e.direction, b.edge(best.b).direction);
    best.normal = normal * ((glm::dot(normal, e.left + e.right) < 0.0 ? -1.0 : 1.0) / std::sqrt(glm::dot(normal, normal)));
    return best;
}

EdgePair best_edges(const Polytope& a, const Polytope& b, double floor) {
    SearchScratch& scratch = search_scratch();
    list_edges_above(a, scratch.met_of_b, floor, scratch.numbers_of_a);
    if (scratch.numbers_of_a.empty()) return {};
    list_edges_above(b, scratch.met_of_a, floor, scratch.numbers_of_b);
    if (scratch.numbers_of_b.empty()) return {};
    fill_edges(b, scratch.numbers_of_b, scratch.edges_of_b);
    return best_of_listed(a, b, scratch.numbers_of_a, scratch.numbers_of_b, scratch.edges_of_b);
}

// A triangle has three corners and two faces: they are all looked at, and at once.

HWY_INLINE FaceSeparation best_over_corners(std::span<const PlaneBundle> planes, const Polytope& triangle,
                                            std::vector<CornerHeights>& all) {
    const Doubles3 corners[3] = {everywhere(triangle.vertex(0)), everywhere(triangle.vertex(1)), everywhere(triangle.vertex(2))};
    all.resize(planes.size());
    Greatest best;
    Doubles numbers = double_lane_numbers();
    for (std::size_t k = 0; k < planes.size(); ++k) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            Doubles height[3];
            for (std::size_t i = 0; i < 3; ++i) {
                height[i] = heights(planes[k], lane, corners[i]);
                store(height[i], all[k].of[i].lane + lane);
            }
            best.offer(min(min(height[0], height[1]), height[2]), numbers);
            numbers = numbers + Doubles(kLaneStep);
        }
    }
    const Extreme found = best.take();
    const CornerHeights& over = all[found.number / kWidth];
    std::uint32_t deepest = 0;
    while (deepest < 2 && over.of[deepest].lane[found.number % kWidth] != found.value) ++deepest;
    return {found.value, found.number, deepest};
}

// @param met  gets the vertices farthest below either face.
HWY_INLINE FaceSeparation better_side_of(const Polytope& triangle, std::span<const PointBundle> points, double floor, dvec3 (&met)[3]) {
    FaceSeparation best;
    best.separation = floor;
    for (std::uint32_t face = 0; face < 2; ++face) {
        const Extreme low = lowest_of(points, normal_of(triangle.planes, face));
        met[face] = point_of(points, low.number);
        const double separation = low.value - offset_of(triangle.planes, face);
        if (separation > best.separation) best = {separation, face, low.number};
    }
    return best;
}

// The edges of which each corner lies higher than `floor` over a face beside them.
HWY_INLINE void list_edges_below(const Polytope& p, std::span<const CornerHeights> over, double floor, std::vector<std::uint32_t>& out) {
    std::vector<DoubleBundle>& words = search_scratch().words;
    const hn::Repartition<std::uint64_t, DoubleTag> word_tag;
    words.resize(over.size());
    for (std::size_t k = 0; k < over.size(); ++k) {
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            auto marks = hn::Zero(word_tag);
            for (std::size_t i = 0; i < 3; ++i) {
                const DoubleMask is_above = load(over[k].of[i].lane + lane) > Doubles(floor);
                marks = hn::Or(marks, hn::IfThenElseZero(hn::RebindMask(word_tag, is_above.raw), hn::Set(word_tag, std::uint64_t{1} << i)));
            }
            store(Doubles(hn::BitCast(DoubleTag(), marks)), words[k].lane + lane);
        }
    }
    list_edges(
        p, words, [](std::uint64_t either) { return either == 7; }, out);
}

// The edges of a triangle in the order of load_triangle(), each towards either face, that some point bounds no lower than `floor`.
// @param promise  gets how high the lowest of the points is over the side over which it is highest.
// @return whether there is any; the others are left without length, and cross nothing.
HWY_INLINE bool fill_arcs(const Polytope& triangle, const dvec3 (&met)[3], double floor, EdgeBundle& arcs, double& promise) {
    unsigned towards[2] = {7, 7};  // either face: the sides that are left
    Doubles promises[kWidth / kLaneStep];
    for (Doubles& of_lanes : promises) of_lanes = Doubles(kInfinity);
    for (const dvec3& point : met) {
        const Doubles3 p = everywhere(point);
        unsigned faces = 0, sides = 0;
        for (int lane = 0; lane < kWidth; lane += kLaneStep) {
            faces |= bits(heights(triangle.planes[0], lane, p) > Doubles(floor)) << lane;
            const Doubles over_sides = heights(triangle.sides, lane, p);
            sides |= bits(over_sides > Doubles(floor)) << lane;
            promises[lane / kLaneStep] = min(promises[lane / kLaneStep], over_sides);
        }
        for (unsigned face = 0; face < 2; ++face) towards[face] &= (faces >> face & 1) != 0 ? 7 : sides;
    }
    Doubles most = promises[0];
    for (const Doubles& of_lanes : promises) most = max(most, of_lanes);
    promise = greatest_lane(most);
    if ((towards[0] | towards[1]) == 0) return false;
    arcs = {};
    const auto put = [&](std::size_t arc, std::uint32_t from, const dvec3& left, const dvec3& right) {
        const dvec3 corner = triangle.vertex(from);
        set_point(arcs.from, arc, corner);
        set_point(arcs.direction, arc, triangle.vertex((from + 1) % 3) - corner);
        set_point(arcs.left, arc, left);
        set_point(arcs.right, arc, right);
    };
    for (std::uint32_t k = 0; k < 3; ++k) {
        const dvec3 side = normal_of({&triangle.sides, 1}, k);
        if ((towards[0] >> k & 1) != 0) put(k, k, triangle.normal(0), side);
        if ((towards[1] >> k & 1) != 0) put(k + 3, k, side, triangle.normal(1));
    }
    return true;
}

Separations find_separations_of_triangle(const Polytope& a, const Polytope& triangle, double enough) {
    constexpr std::uint32_t kArcs[] = {0, 1, 2, 3, 4, 5};
    SearchScratch& scratch = search_scratch();
    Separations best;
    best.of_a = best_over_corners(a.planes, triangle, scratch.heights);
    if (best.of_a.separation > enough) return best;
    dvec3 met[3] = {a.centre, a.centre, a.centre};
    best.of_b = better_side_of(triangle, a.points, best.of_a.separation, met);
    if (best.of_b.separation > enough) return best;
    const double floor = std::min(0.0, best.of_b.separation);
    EdgeBundle arcs;
    if (!fill_arcs(triangle, met, floor, arcs, best.side_promise)) return best;
    list_edges_below(a, scratch.heights, floor, scratch.numbers_of_a);
    best.edges = best_of_listed(a, triangle, scratch.numbers_of_a, kArcs, {&arcs, 1});
    return best;
}

Separations FindSeparations(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double enough) {
    if (b.side_count > 0 && a.side_count == 0) return find_separations_of_triangle(a, b, enough);
    SearchScratch& scratch = search_scratch();
    scratch.met_of_a.assign(1, point_of_a);
    scratch.met_of_b.assign(1, point_of_b);
    Separations best;
    best.of_a = best_plane(a.planes, b.points, -kInfinity, enough, scratch.met_of_b);
    if (best.of_a.separation > enough) return best;
    best.of_b = best_plane(b.planes, a.points, best.of_a.separation, enough, scratch.met_of_a);
    // Below zero the bound holds for every normal of an arc; above, the arc of a sharp edge may do better than both its ends.
    if (!(best.of_b.separation > enough)) best.edges = best_edges(a, b, std::min(0.0, best.of_b.separation));
    return best;
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(FindSeparations);
HWY_EXPORT(BestSide);

Separations find_separations(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double enough) {
    return HWY_DYNAMIC_DISPATCH(FindSeparations)(a, b, point_of_a, point_of_b, enough);
}
FaceSeparation best_side(const Polytope& triangle, const Polytope& other, double floor) {
    return HWY_DYNAMIC_DISPATCH(BestSide)(triangle, other, floor);
}
}  // namespace carom::detail
#endif
