// Half-spaces: what moves towards one, or what one moves towards, touches first with the point that is lowest along its normal.
#include <carom/narrowphase/sweep.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/sweep_frame.hpp>

#include <span>

namespace carom::geo {
namespace {

using namespace carom::detail;
using geo::fit;

/// A lowest point of a solid along n, and the size of what it was computed from.
struct Lowest {
    dvec3 point{0.0};
    double size = 0.0;
};

Lowest lower_end(const dvec3& a, const dvec3& b, const dvec3& n) noexcept {
    return {glm::dot(n, a) <= glm::dot(n, b) ? a : b, std::max(glm::length(a), glm::length(b))};
}
template <class T>
Lowest lowest(const Sphere<T>& s, const dvec3& n) noexcept {
    return {dvec3(s.center) - double(s.radius) * n, glm::length(dvec3(s.center)) + double(s.radius)};
}
template <class T>
Lowest lowest(const Capsule<T>& c, const dvec3& n) noexcept {
    const Lowest end = lower_end(dvec3(c.axis.a), dvec3(c.axis.b), n);
    return {end.point - double(c.radius) * n, end.size + double(c.radius)};
}
template <class T>
Lowest lowest(const Aabb<T>& b, const dvec3& n) noexcept {
    dvec3 p{0.0};
    for (int k = 0; k < 3; ++k) p[k] = n[k] > 0.0 ? double(b.lower[k]) : double(b.upper[k]);
    return {p, glm::length(glm::max(glm::abs(dvec3(b.lower)), glm::abs(dvec3(b.upper))))};
}
template <class T>
Lowest lowest(const Obb<T>& b, const dvec3& n) noexcept {
    Lowest low{dvec3(b.center), glm::length(dvec3(b.center))};
    for (int k = 0; k < 3; ++k) {
        const dvec3 side = double(b.half_extents[k]) * dvec3(b.axes[k]);
        low.point += glm::dot(n, side) > 0.0 ? -side : side;
        low.size += glm::length(side);
    }
    return low;
}
/// @return what the rim of a disc across `axis` has against n, from its centre. Without an axis it faces anywhere.
dvec3 rim_against(dvec3 axis, double radius, const dvec3& n) noexcept {
    const double longest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
    if (longest == 0.0) return -radius * n;
    const int exponent = std::ilogb(longest);
    axis = {std::ldexp(axis.x, -exponent), std::ldexp(axis.y, -exponent), std::ldexp(axis.z, -exponent)};
    // The part of n across the axis, which keeps its accuracy where n runs along it.
    const dvec3 across = glm::cross(axis, glm::cross(n, axis));
    const double length = glm::length(across);
    return length > 0.0 ? -(radius / length) * across : dvec3{0.0};
}
template <class T>
Lowest lowest(const Cylinder<T>& c, const dvec3& n) noexcept {
    Lowest low = lower_end(dvec3(c.axis.a), dvec3(c.axis.b), n);
    low.size += double(c.radius);
    low.point += rim_against(dvec3(c.axis.b) - dvec3(c.axis.a), double(c.radius), n);
    return low;
}
template <class T>
Lowest lowest(const Cone<T>& c, const dvec3& n) noexcept {
    const dvec3 tip(c.tip), base(c.base_center), rim = base + rim_against(base - tip, double(c.radius), n);
    return {glm::dot(n, tip) <= glm::dot(n, rim) ? tip : rim, std::max(glm::length(tip), glm::length(base) + double(c.radius))};
}
Lowest lowest(std::span<const vec3> vertices, const dvec3& n) noexcept {
    Lowest low{dvec3(vertices.front())};
    double square = 0.0;
    for (const vec3& vertex : vertices) {
        const dvec3 v(vertex);
        square = std::max(square, glm::dot(v, v));
        if (glm::dot(n, v) < glm::dot(n, low.point)) low.point = v;
    }
    low.size = std::sqrt(square);
    return low;
}
Lowest lowest(const ConvexHull& hull, const dvec3& n) noexcept { return lowest(hull.vertices(), n); }
Lowest lowest(const TriangleMesh& mesh, const dvec3& n) noexcept { return lowest(mesh.vertices(), n); }

bool fit(const ConvexHull&) noexcept { return true; }  // checked when it was built, and so is
bool fit(const TriangleMesh&) noexcept { return true; }
template <class T>
Lowest lowest(const Triangle<T>& t, const dvec3& n) noexcept {
    const Lowest ab = lower_end(dvec3(t.a), dvec3(t.b), n), end = lower_end(ab.point, dvec3(t.c), n);
    return {end.point, std::max(ab.size, end.size)};
}

/// @param motion  of the solid, against the plane.
template <class T, class Solid>
Impact fall(const Solid& solid, const dvec3& motion, const Plane<T>& plane) noexcept {
    const dvec3 given(plane.normal);
    const double scale = glm::length(given);
    const dvec3 n = given / scale;
    const double offset = double(plane.offset) / scale;
    const Lowest low = lowest(solid, n);
    const double height = glm::dot(n, low.point) - offset - (kGrowth * (low.size + std::abs(offset)) + kLeastGrowth);
    if (!(height > 0.0)) return {.status = ImpactStatus::Overlapping, .t = 0.0};
    // Enlarged by what its products may have lost.
    const double closing = -glm::dot(n, motion) + 8.0 * 0x1p-52 * glm::dot(glm::abs(n), glm::abs(motion));
    if (!(closing > 0.0)) return {};
    const double t = height / closing * kRounded;
    if (!(t <= 1.0)) return {};
    return {ImpactStatus::Touching, t, low.point, -n, 0};
}

/// @return the answer for a solid that moves.
template <class T, class A>
BasicImpact<T> onto_plane(const A& a, const Vec3<T>& motion, const Plane<T>& b) noexcept {
    if (!fit(a) || !fit(b) || !usual_vector(motion)) return rounded<T>(kInvalidImpact);
    Impact impact = fall(a, dvec3(motion), b);
    impact.point += impact.t * (impact.status == ImpactStatus::Touching ? dvec3(motion) : dvec3{0.0});
    return rounded<T>(impact);
}
/// @return the answer for a plane that moves.
template <class T, class B>
BasicImpact<T> onto_solid(const Plane<T>& a, const Vec3<T>& motion, const B& b) noexcept {
    if (!fit(a) || !fit(b) || !usual_vector(motion)) return rounded<T>(kInvalidImpact);
    Impact impact = fall(b, -dvec3(motion), a);
    impact.normal = -impact.normal;
    return rounded<T>(impact);
}

}  // namespace

template <class T>
BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Plane<T>& b) noexcept {
    return onto_plane(a, motion, b);
}
template <class T>
BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Plane<T>& b) noexcept {
    return onto_plane(a, motion, b);
}

#define CAROM_PLANE_SWEEPS(B)                                                                  \
    template <class T>                                                                         \
    BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const B<T>& b) noexcept {   \
        return onto_solid(a, motion, b);                                                       \
    }                                                                                          \
    template BasicImpact<float> sweep(const Plane<float>&, const Vec3<float>&, const B<float>&) noexcept; \
    template BasicImpact<double> sweep(const Plane<double>&, const Vec3<double>&, const B<double>&) noexcept;
CAROM_PLANE_SWEEPS(Sphere)
CAROM_PLANE_SWEEPS(Capsule)
CAROM_PLANE_SWEEPS(Aabb)
CAROM_PLANE_SWEEPS(Obb)
CAROM_PLANE_SWEEPS(Cylinder)
CAROM_PLANE_SWEEPS(Cone)
CAROM_PLANE_SWEEPS(Triangle)
#undef CAROM_PLANE_SWEEPS

Impact sweep(const Plane<double>& a, const Vec3<double>& motion, const ConvexHull& b) noexcept { return onto_solid(a, motion, b); }
Impact sweep(const Plane<double>& a, const Vec3<double>& motion, const TriangleMesh& b) noexcept { return onto_solid(a, motion, b); }

template BasicImpact<float> sweep(const Sphere<float>&, const Vec3<float>&, const Plane<float>&) noexcept;
template BasicImpact<double> sweep(const Sphere<double>&, const Vec3<double>&, const Plane<double>&) noexcept;
template BasicImpact<float> sweep(const Capsule<float>&, const Vec3<float>&, const Plane<float>&) noexcept;
template BasicImpact<double> sweep(const Capsule<double>&, const Vec3<double>&, const Plane<double>&) noexcept;

}  // namespace carom::geo
