#include <carom/narrowphase/sweep.hpp>

#include <carom/collision/bvh_sweep.hpp>
#include <carom/narrowphase/detail/one_sided.hpp>
#include <carom/narrowphase/detail/sweep_frame.hpp>

#include <algorithm>

namespace carom::geo {
namespace {

/// @param centre, half  of A's box at the start.
template <class A>
MeshImpact sweep_mesh(const A& a, const dvec3& motion, const TriangleMesh& b, const dvec3& centre, const dvec3& half) {
    MeshImpact first;
    const carom::detail::OneSidedPath path(b, centre);
    triangles_along(b.bvh(), {.origin = centre, .direction = motion, .t_max = 1.0}, half, [&](std::uint32_t index) {
        if (path.passes(index)) return first.t;
        const auto corners = b.corners(index);
        const Impact next = sweep(a, motion, Triangle<double>{dvec3(corners[0]), dvec3(corners[1]), dvec3(corners[2])});
        const bool earlier = !may_touch(first.status) || next.t < first.t || (next.t == first.t && index < first.triangle);
        if (may_touch(next.status) && earlier && !path.is_back(index, [&] { return centre + next.t * motion; })) {
            static_cast<Impact&>(first) = next;
            first.triangle = index;
        }
        return first.t;
    });
    return first;
}

}  // namespace

MeshImpact sweep(const Sphere<double>& a, const Vec3<double>& motion, const TriangleMesh& b) {
    if (!fit(a) || !usual_vector(motion)) return {kInvalidImpact};
    return sweep_mesh(a, motion, b, a.center, dvec3{a.radius});
}

MeshImpact sweep(const Capsule<double>& a, const Vec3<double>& motion, const TriangleMesh& b) {
    if (!fit(a) || !usual_vector(motion)) return {kInvalidImpact};
    return sweep_mesh(a, motion, b, 0.5 * (a.axis.a + a.axis.b), 0.5 * glm::abs(a.axis.b - a.axis.a) + a.radius);
}

}  // namespace carom::geo
