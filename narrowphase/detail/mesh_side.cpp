#include <carom/collision/bvh_queries.hpp>
#include <carom/narrowphase/detail/mesh_side.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::detail {
namespace {

// A point behind a surface is nowhere nearest to an edge that stands out, so where the nearest point lies this far to the side of all
// planes there (as a sine), the surface ends there.
constexpr double kBeside = 0.1;

dvec3 cross_of(const Corners& t) noexcept { return glm::cross(t[1] - t[0], t[2] - t[0]); }

}  // namespace

void MeshSide::set(const TriangleMesh& mesh, const dmat3& rotation, const dvec3& translation, const OtherMesh& other) {
    mesh_ = &mesh;
    rotation_ = rotation;
    translation_ = translation;
    toward_ = (other.centre - translation) * rotation;
    turned_ = each_ = false;
    const Aabb& box = mesh.local_bounds();
    const double diagonal = glm::length(box.upper - box.lower);
    touching_ = kInsideTolerance * std::max(diagonal, glm::length(glm::max(glm::abs(box.lower), glm::abs(box.upper))) * 1e-6);
    if (mesh.is_closed() || 2.0 * other.diagonal > diagonal) return;
    each_ = !mesh.is_oriented();
    if (each_) return;
    const std::optional<SurfacePoint> nearest = measure(other.centre, std::numeric_limits<double>::infinity());
    turned_ = nearest && nearest->separation < 0.0;
}

bool MeshSide::is_turned(std::uint32_t triangle) const noexcept {
    if (!each_) return turned_;
    const std::array<vec3, 3> c = mesh_->corners(triangle);
    const dvec3 a(c[0]);
    return glm::dot(glm::cross(dvec3(c[1]) - a, dvec3(c[2]) - a), toward_ - a) < 0.0;
}

Corners MeshSide::corners(std::uint32_t triangle) const noexcept {
    const std::array<vec3, 3> c = mesh_->corners(triangle);
    Corners out{to_pair(c[0]), to_pair(c[1]), to_pair(c[2])};
    if (is_turned(triangle)) std::swap(out[1], out[2]);
    return out;
}

TriangleMesh::Triangle MeshSide::vertices(std::uint32_t triangle) const noexcept {
    TriangleMesh::Triangle out = mesh_->triangles()[triangle];
    if (is_turned(triangle)) std::swap(out[1], out[2]);
    return out;
}

bool MeshSide::allows(const dvec3& p, const dvec3& outward, double tolerance) const {
    bool highest = true;
    double leaning = 0.0;  // of the triangle that faces along `outward` most, or against it
    for_each_at(p, tolerance, [&](std::uint32_t, const Corners& t) {
        for (const dvec3& corner : t) {
            const dvec3 d = corner - p;
            const double rise = glm::dot(outward, d) - tolerance;
            if (rise > 0.0 && rise * rise > kRidgeSine * kRidgeSine * glm::dot(d, d)) highest = false;
        }
        const dvec3 n = cross_of(t);
        const double area = std::sqrt(glm::dot(n, n));
        const double cosine = area > 0.0 ? glm::dot(n, outward) / area : 0.0;
        if (std::abs(cosine) > std::abs(leaning)) leaning = cosine;
    });
    return highest && leaning > -kBeside;
}

std::optional<SurfacePoint> MeshSide::measure(const dvec3& p, double reach) const {
    const dvec3 own = (p - translation_) * rotation_;
    const std::optional<ClosestOnMesh> nearest = closest_point(mesh_->bvh(), own, reach);
    if (!nearest) return std::nullopt;
    return measure_at(p, rotation_ * nearest->point + translation_);
}

std::optional<SurfacePoint> MeshSide::measure_at(const dvec3& p, const dvec3& nearest) const {
    SurfacePoint out;
    out.point = nearest;
    const dvec3 gap = p - out.point;
    const double distance = std::sqrt(glm::dot(gap, gap));
    double height = 0.0;
    dvec3 sum{0.0};
    int count = 0;
    for_each_at(out.point, touching_, [&](std::uint32_t, const Corners& t) {
        const dvec3 n = cross_of(t);
        const double area = std::sqrt(glm::dot(n, n));
        if (!(area > 0.0)) return;
        const double over = glm::dot(n, gap) / area;
        if (std::abs(over) > std::abs(height)) height = over;
        sum += n / area;
        ++count;
    });
    const double length = std::sqrt(glm::dot(sum, sum));
    if (distance <= touching_) {
        // On the surface: out along the mean of the normals there.
        if (!(length > kBeside)) return std::nullopt;
        out.outward = sum / length;
        out.separation = height;
        return out;
    }
    const bool lone_edge = count == 1 && std::abs(height) < (1.0 - kBeside) * distance;
    const bool behind = height < -kBeside * distance && !lone_edge;
    out.separation = behind ? -distance : distance;
    out.outward = gap / out.separation;
    return out;
}

void MeshSide::faces_over(const dvec3& p, double reach, double tolerance, std::vector<SurfaceFace>& faces) const {
    faces.clear();
    const dvec3 own = (p - translation_) * rotation_, around{reach};
    mesh_->overlap({own - around, own + around}, [&](std::uint32_t triangle) {
        const Corners t = corners(triangle);
        const dvec3 n = cross_of(t);
        const double area = std::sqrt(glm::dot(n, n));
        if (!(area > 0.0)) return true;
        const dvec3 unit = n / area;
        const double height = glm::dot(unit, p - t[0]);
        if (height > 0.0 || height < -reach) return true;
        const dvec3 foot = p - height * unit, aside = closest_on_triangle(t, foot).point - foot;
        if (glm::dot(aside, aside) <= tolerance * tolerance) faces.push_back({unit, height});
        return true;
    });
}

}  // namespace carom::detail
