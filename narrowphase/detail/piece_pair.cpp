#include <carom/narrowphase/detail/piece_pair.hpp>

#include <carom/collision/clipping.hpp>
#include <carom/narrowphase/detail/gjk.hpp>
#include <carom/narrowphase/detail/polytope_axis.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/segment.hpp>
#include <carom/narrowphase/detail/segment_polytope.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace carom::detail {
namespace {

constexpr double kUlps = 64.0 * 0x1p-52;  // of sizes and distance: some dozen roundings of each
constexpr double kOverlap = 2e-12;        // what gjk() calls overlap, twice

double rounding_of(const ConvexPiece& a, const ConvexPiece& b) {
    // Of both boxes, both from A's origin.
    const dvec3 far = glm::max(glm::max(glm::abs(a.box.lower), glm::abs(a.box.upper)), glm::max(glm::abs(b.box.lower), glm::abs(b.box.upper)));
    return kUlps * (std::max({far.x, far.y, far.z}) + a.size() + b.size());
}

GjkResult search(const ConvexPiece& a, const ConvexPiece& b, GjkSimplex& last) {
    constexpr double kNoCutoff = std::numeric_limits<double>::infinity();
    if (a.turned && b.turned) return gjk(*a.turned, *b.turned, kNoCutoff, last);
    if (a.turned) return gjk(*a.turned, b.points, kNoCutoff, last);
    if (!b.turned) return gjk(a.points, b.points, kNoCutoff, last);
    GjkResult r = gjk(*b.turned, a.points, kNoCutoff, last);
    std::swap(r.on_a, r.on_b);
    std::swap(last.on_a, last.on_b);
    return r;
}

double gap_along(const ConvexPiece& a, const ConvexPiece& b, const dvec3& normal) { return -b.reach(-normal) - a.reach(normal); }

dvec3 largest_axis(const dvec3& v) {
    int k = 0;
    for (int i = 1; i < 3; ++i) k = std::abs(v[i]) > std::abs(v[k]) ? i : k;
    dvec3 axis{0.0};
    axis[k] = v[k] < 0.0 ? -1.0 : 1.0;
    return axis;
}

AxisSource source_of(const PieceSupport& a, const PieceSupport& b, AxisSource otherwise) {
    if (a.feature.kind == SupportKind::Face) return AxisSource::FaceOfA;
    if (b.feature.kind == SupportKind::Face) return AxisSource::FaceOfB;
    if (a.feature.kind == SupportKind::Edge && b.feature.kind == SupportKind::Edge) return AxisSource::Edges;
    return otherwise;
}

PairVerdict verdict_of(double gap, double rounding) {
    if (gap > rounding) return PairVerdict::Apart;
    return gap < -rounding ? PairVerdict::Touching : PairVerdict::Undecided;
}

// Keeps the direction of the greatest gap, the first of equals.
class AxisChooser {
public:
    AxisChooser(const ConvexPiece& a, const ConvexPiece& b) : a_(a), b_(b) {}

    void offer(const dvec3& direction, AxisSource source) {
        const double length = glm::length(direction);
        if (!is_finite(length) || !(length > 0.0)) return;
        const dvec3 normal = direction / length;
        const double gap = gap_along(a_, b_, normal);
        if (found_ && !(gap > gap_)) return;
        found_ = true;
        gap_ = gap;
        normal_ = normal;
        source_ = source;
    }
    [[nodiscard]] bool found() const noexcept { return found_; }
    [[nodiscard]] const dvec3& normal() const noexcept { return normal_; }

    [[nodiscard]] SeparatingAxis axis(double rounding) const {
        const PieceSupport of_a = a_.support(normal_), of_b = b_.support(-normal_);
        SeparatingAxis axis{source_of(of_a, of_b, source_), vec3(normal_), gap_, rounding, verdict_of(gap_, rounding), of_a.feature, of_b.feature,
                            of_a.middle,                    of_b.middle};
        if (axis.source == AxisSource::FaceOfA) axis.on_a = of_b.middle - gap_ * normal_;
        if (axis.source == AxisSource::FaceOfB) axis.on_b = of_a.middle + gap_ * normal_;
        if (axis.source == AxisSource::Edges) {
            const Segment e{of_a.ends[0], of_a.ends[1]}, f{of_b.ends[0], of_b.ends[1]};
            const SegmentParameters closest = closest_parameters(e, f);
            axis.on_a = e.at(closest.s);
            axis.on_b = f.at(closest.t);
        }
        return axis;
    }

private:
    const ConvexPiece& a_;
    const ConvexPiece& b_;
    bool found_ = false;
    double gap_ = 0.0;
    dvec3 normal_{0.0};
    AxisSource source_ = AxisSource::Points;
};

// A sphere's or capsule's core in a flat piece.
void offer_core_axis(const ConvexPiece& round, const ConvexPiece& flat, bool round_is_a, AxisChooser& axes) {
    if (round.turned) return;
    ContactAxis axis;
    PolygonScratch scratch;
    if (!find_axis(RoundSegment{{round.points.front(), round.points.back()}, 0.0}, *flat.polytope, flat.size(), scratch, axis)) return;
    axes.offer(round_is_a ? axis.normal : -axis.normal, AxisSource::Points);
}

void offer_overlap_axes(const ConvexPiece& a, const ConvexPiece& b, AxisChooser& axes) {
    if (a.polytope && !b.polytope) offer_core_axis(b, a, false, axes);
    if (b.polytope && !a.polytope) offer_core_axis(a, b, true, axes);
    if (a.points.size() == 2 && b.points.size() == 2) {
        // Crossing segments part square to both.
        const dvec3 across = glm::cross(a.points[1] - a.points[0], b.points[1] - b.points[0]);
        axes.offer(across, AxisSource::Points);
        axes.offer(-across, AxisSource::Points);
    }
}

void note_distance(const ConvexPiece& a, const ConvexPiece& b, const GjkResult& r, const GjkSimplex& last, DistanceBounds& out) {
    const double radii = a.radius + b.radius;
    const dvec3 between = r.on_b - r.on_a;
    const double length = glm::length(between);
    const dvec3 n = length > 0.0 ? between / length : dvec3{0.0};
    out.cores_overlap = r.overlap;
    out.converged = r.converged;
    out.upper = std::max(0.0, r.distance - radii);
    out.on_a = r.on_a + a.radius * n;
    out.on_b = r.on_b - b.radius * n;
    for (std::size_t i = 0; i < static_cast<std::size_t>(last.count); ++i) {
        out.simplex_a.push_back(last.on_a[i]);
        out.simplex_b.push_back(last.on_b[i]);
    }
}

}  // namespace

PieceFinding compare(const ConvexPiece& a, const ConvexPiece& b, std::span<const dvec3> contact_normals) {
    const double rounding = rounding_of(a, b);
    PieceFinding found;
    GjkSimplex last;
    const GjkResult r = search(a, b, last);
    AxisChooser axes(a, b);
    if (a.polytope && b.polytope) {
        constexpr double kAll = std::numeric_limits<double>::infinity();
        const ContactAxis axis = greatest_separation(*a.polytope, *b.polytope, a.polytope->centre, b.polytope->centre, kAll);
        axes.offer(axis.normal, AxisSource::Points);
    }
    if (r.beyond) {  // so far apart that squares of lengths overflow
        axes.offer(largest_axis(0.5 * (b.box.lower + b.box.upper) - 0.5 * (a.box.lower + a.box.upper)), AxisSource::Points);
        found.distance.upper = std::numeric_limits<double>::infinity();
    } else {
        note_distance(a, b, r, last, found.distance);
        if (!r.overlap) axes.offer(r.on_b - r.on_a, AxisSource::Points);
        if (r.overlap || r.distance <= kTouching * std::max(a.size(), b.size())) offer_overlap_axes(a, b, axes);
    }
    // Of cylinders and cones nothing above tells the depth; and two spheres with one centre part along any direction.
    for (const dvec3& normal : contact_normals) axes.offer(normal, AxisSource::Contact);
    if (!axes.found()) axes.offer(dvec3{0.0, 1.0, 0.0}, AxisSource::Contact);

    found.axis = axes.axis(rounding);
    if (found.axis.source == AxisSource::Points && !r.overlap && !r.beyond) {
        found.axis.on_a = found.distance.on_a;
        found.axis.on_b = found.distance.on_b;
    }
    found.distance.lower = std::min(std::max(0.0, found.axis.gap - rounding), found.distance.upper);
    const double known_overlap = r.overlap ? kOverlap / kUlps * rounding : rounding;
    const bool overlap = r.overlap || r.distance - a.radius - b.radius < -rounding;
    found.verdict = found.axis.verdict == PairVerdict::Apart             ? PairVerdict::Apart
                    : overlap && found.axis.gap < -known_overlap && !r.beyond ? PairVerdict::Touching
                                                                              : PairVerdict::Undecided;
    return found;
}

PieceFinding compare(const ConvexPiece& a, const HalfSpace& b) {
    const dvec3 normal = -b.normal;
    const PieceSupport lowest = a.support(normal);
    PieceFinding found;
    SeparatingAxis& axis = found.axis;
    axis.source = AxisSource::FaceOfB;
    axis.normal = vec3(normal);
    axis.gap = -a.reach(normal) - b.offset;
    axis.rounding = kUlps * (std::abs(b.offset) + std::abs(a.reach(normal)) + a.size());
    axis.verdict = verdict_of(axis.gap, axis.rounding);
    axis.of_a = lowest.feature;
    axis.of_b = {SupportKind::Face, 0};
    axis.on_a = lowest.middle;
    axis.on_b = lowest.middle + axis.gap * normal;
    found.verdict = axis.verdict;
    DistanceBounds& distance = found.distance;
    distance.lower = std::max(0.0, axis.gap - axis.rounding);
    distance.upper = std::max(0.0, axis.gap + axis.rounding);
    distance.on_a = axis.on_a;
    distance.on_b = axis.on_b;
    distance.cores_overlap = axis.gap < 0.0;
    return found;
}

PieceFinding swapped(PieceFinding found) {
    SeparatingAxis& axis = found.axis;
    axis.normal = -axis.normal;
    if (axis.source == AxisSource::FaceOfA || axis.source == AxisSource::FaceOfB) {
        axis.source = axis.source == AxisSource::FaceOfA ? AxisSource::FaceOfB : AxisSource::FaceOfA;
    }
    std::swap(axis.of_a, axis.of_b);
    std::swap(axis.on_a, axis.on_b);
    std::swap(found.distance.on_a, found.distance.on_b);
    std::swap(found.distance.simplex_a, found.distance.simplex_b);
    return found;
}

std::optional<FacePatch> common_patch(const ConvexPiece& a, const ConvexPiece& b, const dvec3& normal, double height) {
    if (!a.polytope || !b.polytope) return std::nullopt;
    const std::uint32_t face_a = face_along(*a.polytope, normal).number, face_b = face_along(*b.polytope, -normal).number;
    // The rule by which the kernels take points from faces.
    if (glm::dot(a.polytope->normal(face_a), normal) < kFacingCosine) return std::nullopt;
    if (-glm::dot(b.polytope->normal(face_b), normal) < kFacingCosine) return std::nullopt;
    FacePatch patch{a.corners_of(face_a), b.corners_of(face_b), {}};
    const auto flatten = [&](dvec3 p) { return p + (height - glm::dot(p, normal)) * normal; };
    std::vector<geo::Plane<double>> sides;
    for (std::size_t i = 0; i < patch.face_a.size(); ++i) {
        const dvec3 from = flatten(patch.face_a[i]), to = flatten(patch.face_a[(i + 1) % patch.face_a.size()]);
        const dvec3 outward = glm::cross(to - from, normal);  // a's face runs counter-clockwise about the normal
        sides.push_back({outward, glm::dot(outward, from)});
    }
    std::vector<dvec3> flat;
    for (const dvec3& p : patch.face_b) flat.push_back(flatten(p));
    geo::PolygonClipper<double> clipper;
    const auto common = clipper.clip(flat, sides);
    if (common.size() < 3) return std::nullopt;
    patch.common.assign(common.begin(), common.end());
    return patch;
}

}  // namespace carom::detail
