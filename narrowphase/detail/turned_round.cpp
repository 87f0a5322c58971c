// Cylinder and cone against sphere and plane, in closed form.
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/plane_form.hpp>
#include <carom/narrowphase/detail/round_contact.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/turned_contact.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

// The surface nearest to a point, in the half-plane through the axis and the point: x across the axis, y along it.
struct NearestSurface {
    double distance = 0.0;      // negative inside
    dvec2 normal{1.0, 0.0};     // from the surface to the outside
};

dvec2 nearest_on_segment(const dvec2& a, const dvec2& b, const dvec2& p) noexcept {
    const dvec2 d = b - a;
    const double dd = glm::dot(d, d);
    return dd > 0.0 ? a + std::clamp(glm::dot(p - a, d) / dd, 0.0, 1.0) * d : a;
}

NearestSurface nearest_surface(const TruncatedCone& solid, const dvec2& p) noexcept {
    const double h = solid.half_height;
    const dvec2 lower{solid.lower_radius, -h}, upper{solid.upper_radius, h};
    const dvec2 line = upper - lower;
    const dvec2 side = dvec2{line.y, -line.x} / std::sqrt(glm::dot(line, line));
    const double over_side = glm::dot(side, p - lower);
    NearestSurface inside{over_side, side};
    if (-h - p.y > inside.distance) inside = {-h - p.y, {0.0, -1.0}};
    if (solid.upper_radius > 0.0 && p.y - h > inside.distance) inside = {p.y - h, {0.0, 1.0}};
    if (!(inside.distance > 0.0)) return inside;

    dvec2 nearest = nearest_on_segment(lower, upper, p);
    const auto closer = [&](const dvec2& q) {
        if (glm::dot(q - p, q - p) < glm::dot(nearest - p, nearest - p)) nearest = q;
    };
    closer(nearest_on_segment({0.0, -h}, lower, p));
    closer(nearest_on_segment({0.0, h}, upper, p));
    const dvec2 out = p - nearest;
    const double distance = std::sqrt(glm::dot(out, out));
    return distance > 1e-140 ? NearestSurface{distance, out / distance} : inside;  // else the squares underflowed: it touches
}

TruncatedCone first_of(const PairFrame& pair) noexcept { return truncated_cone(pair.first, dmat3{1.0}, dvec3{0.0}); }

// Adds a point of the solid's rim if it is near enough to the plane.
void add_to_plane(const dvec3& p, const PlaneForm& plane, double margin, std::uint32_t name, PolygonScratch& scratch,
                  const ContactPlane& contact) {
    const double distance = plane.distance(p);
    if (distance > margin) return;
    const dvec3 position = p - (0.5 * distance) * plane.normal;
    scratch.candidates.push_back({position, distance, glm::dot(position, contact.axis_u), glm::dot(position, contact.axis_w),
                                  feature_name(FeatureKind::VertexOfFirst, name, 0)});
}

}  // namespace

CollideStatus turned_sphere(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const TruncatedCone solid = first_of(pair);
    const double radius = static_cast<double>(as<Sphere>(pair.second).radius);
    const dvec3& centre = pair.translation;
    if (!is_finite(glm::dot(centre, centre))) return CollideStatus::Ok;  // farther apart than any margin
    const dvec3 across = solid.outward(centre);
    const NearestSurface surface = nearest_surface(solid, {glm::dot(centre, across), centre.y});
    if (!(surface.distance - radius <= pair.margin)) return CollideStatus::Ok;
    Patch patch;
    patch.normal = surface.normal.x * across + dvec3{0.0, surface.normal.y, 0.0};
    patch.add(centre - (0.5 * (surface.distance + radius)) * patch.normal, surface.distance - radius, 0);
    sink.add(patch);
    return CollideStatus::Ok;
}

// The deepest points of both rims, and the corners of the flat end where that faces the plane better than the side does.
CollideStatus turned_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const TruncatedCone solid = first_of(pair);
    const PlaneForm plane = plane_in_first(pair);
    Patch patch;
    patch.normal = -plane.normal;
    const ContactPlane contact = contact_plane(patch.normal, pair.margin, 0.0);

    PolygonScratch& scratch = workspace.polygons;
    scratch.candidates.clear();
    const dvec3 down = solid.outward(patch.normal);
    const bool upper = patch.normal.y > 0.0;
    const bool has_end = !upper || solid.upper_radius > 0.0;
    const double tolerance = kPointTolerance * solid.size();
    double deepest = std::numeric_limits<double>::infinity();
    if (has_end && std::abs(patch.normal.y) >= glm::dot(solid.side_normal(down), patch.normal)) {
        const FacePolygon end = disc_of(solid, upper, contact, scratch.first);
        for (const FaceCorner& c : end.corners) {
            add_to_plane(c.point, plane, pair.margin, c.vertex, scratch, contact);
            deepest = std::min(deepest, plane.distance(c.point));
        }
    }
    // A rim is lowest between its corners as a rule; the corners of one that lies flat are steadier than its lowest point, which is
    // anywhere then.
    const dvec3 lower = solid.lower_centre() + solid.lower_radius * down, upper_point = solid.upper_centre() + solid.upper_radius * down;
    if (plane.distance(lower) < deepest - tolerance) add_to_plane(lower, plane, pair.margin, kRimPoint, scratch, contact);
    if (plane.distance(upper_point) < deepest - tolerance) add_to_plane(upper_point, plane, pair.margin, kRimPoint + 1, scratch, contact);

    Chosen chosen{};
    const int count = reduce_points(scratch.candidates, tolerance, outline_start(patch.normal, contact.axis_u, contact.axis_w),
                                    overlook(pair.steady, solid.size()), chosen);
    for (int i = 0; i < count; ++i) {
        const Candidate& c = scratch.candidates[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
        patch.add(c.position, c.separation, c.feature);
    }
    if (patch.count > 0) sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
