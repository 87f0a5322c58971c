#include <carom/narrowphase/sweep.hpp>

#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/narrowphase/detail/sweep_frame.hpp>

#include <algorithm>

namespace carom::geo {
namespace {

/// @return a share of the motion within which a point of A most likely hits the mesh, and so A does: only a guess.
double likely_end(const dvec3& from, const dvec3& motion, const TriangleMesh& b) {
    const Ray<float> ray{.origin = vec3(from), .direction = vec3(motion), .t_min = 0.0f, .t_max = 1.0f};
    const MeshHit hit = closest_hit(b.bvh(), ray);
    return hit ? std::min(1.0, 1.0001 * static_cast<double>(hit.t)) : 1.0;
}

template <class A>
struct FirstTriangle {
    const A& a;
    const dvec3& motion;
    const TriangleMesh& b;
    MeshImpact first{};

    bool operator()(std::uint32_t index) {
        const auto corners = b.corners(index);
        const Impact next = sweep(a, motion, Triangle<double>{dvec3(corners[0]), dvec3(corners[1]), dvec3(corners[2])});
        if (!may_touch(next.status)) return true;
        if (may_touch(first.status) && (next.t > first.t || (next.t == first.t && index > first.triangle))) return true;
        static_cast<Impact&>(first) = next;
        first.triangle = index;
        return true;
    }
};

template <class A, class Look>
MeshImpact first_within(const A& a, const dvec3& motion, const TriangleMesh& b, double end, const Look& look) {
    for (const double share : {end, 1.0}) {
        FirstTriangle<A> found{a, motion, b};
        look(share, TriangleVisit(found));
        // Whatever is met up to `share` was looked at; what is met later may not be the first.
        if (may_touch(found.first.status) && found.first.t <= share) return found.first;
        if (share == 1.0) break;
    }
    return {};
}

}  // namespace

MeshImpact sweep(const Sphere<double>& a, const Vec3<double>& motion, const TriangleMesh& b) {
    if (!fit(a) || !usual_vector(motion)) return {kInvalidImpact};
    return first_within(a, motion, b, likely_end(a.center, motion, b), [&](double share, TriangleVisit visit) {
        overlapping_triangles(b.bvh(), Capsule<double>{{a.center, a.center + share * motion}, a.radius}, visit);
    });
}

MeshImpact sweep(const Capsule<double>& a, const Vec3<double>& motion, const TriangleMesh& b) {
    if (!fit(a) || !usual_vector(motion)) return {kInvalidImpact};
    const double end = std::min(likely_end(a.axis.a, motion, b), likely_end(a.axis.b, motion, b));
    return first_within(a, motion, b, end, [&](double share, TriangleVisit visit) {
        const dvec3 by = share * motion;
        const dvec3 low = glm::min(a.axis.a, a.axis.b), high = glm::max(a.axis.a, a.axis.b);
        overlapping_triangles(b.bvh(), Aabb<double>{glm::min(low, low + by) - a.radius, glm::max(high, high + by) + a.radius}, visit);
    });
}

}  // namespace carom::geo
