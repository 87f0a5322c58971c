#include <carom/studies/peers/ray_peers.hpp>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <boost/variant/get.hpp>
#include <glm/geometric.hpp>

namespace carom::peers {
namespace {

template <class Kernel>
class CgalMesh {
public:
    explicit CgalMesh(const TriangleMesh& mesh) {
        triangles_.reserve(mesh.triangles().size());
        for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) {
            const auto c = mesh.corners(i);
            triangles_.emplace_back(point(dvec3(c[0])), point(dvec3(c[1])), point(dvec3(c[2])));
        }
        tree_.insert(triangles_.begin(), triangles_.end());
        tree_.build();
    }

    [[nodiscard]] std::optional<double> distance(const dvec3& origin, const dvec3& direction) const {
        const auto from = point(origin);
        const auto hit =
            tree_.first_intersection(typename Kernel::Ray_3(from, typename Kernel::Vector_3(direction.x, direction.y, direction.z)));
        if (!hit) return std::nullopt;
        // A ray in the plane of a triangle meets it in a segment.
        if (const auto* const place = boost::get<typename Kernel::Point_3>(&hit->first)) return length(*place - from);
        const auto* const segment = boost::get<typename Kernel::Segment_3>(&hit->first);
        return std::min(length(segment->source() - from), length(segment->target() - from));
    }

private:
    static typename Kernel::Point_3 point(const dvec3& p) { return {p.x, p.y, p.z}; }
    static double length(const typename Kernel::Vector_3& v) { return glm::length(dvec3(v.x(), v.y(), v.z())); }

    using Triangles = std::vector<typename Kernel::Triangle_3>;
    using Primitive = CGAL::AABB_triangle_primitive<Kernel, typename Triangles::const_iterator>;
    Triangles triangles_;
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

template <class Kernel>
accuracy::RayCaster caster(const char* predicates) {
    const auto prepare = [](const accuracy::RayCases& part) -> accuracy::RayCaster::Cast {
        return [mesh = std::make_shared<const CgalMesh<Kernel>>(*part.mesh), offset = part.offset](const Ray& ray) {
            return mesh->distance(relative_origin(ray, offset, true), ray.direction);
        };
    };
    return {"cgal", {{"predicates", predicates}, {"world", "double"}, {"test", "double"}}, prepare};
}

}  // namespace

std::vector<accuracy::RayCaster> cgal_rays() {
    return {caster<CGAL::Simple_cartesian<double>>("plain"), caster<CGAL::Exact_predicates_inexact_constructions_kernel>("exact")};
}

}  // namespace carom::peers
