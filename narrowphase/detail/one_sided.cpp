#include <carom/narrowphase/detail/mesh_side.hpp>
#include <carom/narrowphase/detail/one_sided.hpp>

#include <glm/geometric.hpp>

#include <array>
#include <limits>

namespace carom::detail {

bool is_behind(const TriangleMesh& mesh, const dvec3& centre) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    MeshSide side;
    side.set(mesh, dmat3{1.0}, dvec3{0.0}, {centre, kAny});  // to what is large a mesh has its winding's side
    const std::optional<SurfacePoint> nearest = side.measure(centre, kAny);
    return nearest && nearest->separation < 0.0;
}

bool is_behind(const TriangleMesh& mesh, std::uint32_t triangle, const dvec3& centre) noexcept {
    const std::array<vec3, 3> t = mesh.corners(triangle);
    const dvec3 a(t[0]);
    return glm::dot(glm::cross(dvec3(t[1]) - a, dvec3(t[2]) - a), centre - a) < 0.0;
}

}  // namespace carom::detail
