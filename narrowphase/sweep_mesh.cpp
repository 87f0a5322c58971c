#include <carom/narrowphase/sweep.hpp>

#include <carom/collision/bvh_sweep.hpp>
#include <carom/narrowphase/detail/one_sided.hpp>
#include <carom/narrowphase/detail/sweep_frame.hpp>

#include <algorithm>

namespace carom::geo {
namespace {

Triangle<double> triangle_of(const vec3& a, const vec3& b, const vec3& c) noexcept { return {dvec3(a), dvec3(b), dvec3(c)}; }

/// The first contact of A with those of a mesh's triangles that are asked for.
template <class A>
class FirstContact {
public:
    /// @param centre  of A at the start.
    FirstContact(const A& a, const dvec3& motion, const TriangleMesh& b, const dvec3& centre) noexcept
        : a_(a), motion_(motion), mesh_(b), centre_(centre), path_(b, centre) {}

    /// @param corners  of the triangle, or null: the mesh's. @return when the first contact is so far, or 1.
    double look_at(std::uint32_t index, const vec3* corners) {
        if (path_.passes(index)) return first_.t;
        const Impact next = sweep(a_, motion_, corners != nullptr ? triangle_of(corners[0], corners[1], corners[2]) : triangle(index));
        const bool earlier = !may_touch(first_.status) || next.t < first_.t || (next.t == first_.t && index < first_.triangle);
        if (may_touch(next.status) && earlier && !path_.is_back(index, [&] { return centre_ + next.t * motion_; })) {
            static_cast<Impact&>(first_) = next;
            first_.triangle = index;
        }
        return first_.t;
    }
    [[nodiscard]] const MeshImpact& found() const noexcept { return first_; }

private:
    [[nodiscard]] Triangle<double> triangle(std::uint32_t index) const noexcept {
        const auto corners = mesh_.corners(index);
        return triangle_of(corners[0], corners[1], corners[2]);
    }

    const A& a_;
    const dvec3& motion_;
    const TriangleMesh& mesh_;
    const dvec3& centre_;
    carom::detail::OneSidedPath path_;
    MeshImpact first_;
};

}  // namespace

MeshImpact sweep(const Sphere<double>& a, const Vec3<double>& motion, const TriangleMesh& b) {
    if (!fit(a) || !usual_vector(motion)) return {kInvalidImpact};
    FirstContact<Sphere<double>> first(a, motion, b, a.center);
    triangles_along(b.bvh(), {.origin = a.center, .direction = motion, .t_max = 1.0}, a.radius,
                    [&](std::uint32_t index, const vec3* corners) { return first.look_at(index, corners); });
    return first.found();
}

MeshImpact sweep(const Capsule<double>& a, const Vec3<double>& motion, const TriangleMesh& b) {
    if (!fit(a) || !usual_vector(motion)) return {kInvalidImpact};
    const dvec3 centre = 0.5 * (a.axis.a + a.axis.b);
    FirstContact<Capsule<double>> first(a, motion, b, centre);
    triangles_along(b.bvh(), {.origin = centre, .direction = motion, .t_max = 1.0}, 0.5 * glm::abs(a.axis.b - a.axis.a) + a.radius,
                    [&](std::uint32_t index) { return first.look_at(index, nullptr); });
    return first.found();
}

}  // namespace carom::geo
