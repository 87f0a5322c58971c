#include <carom/collision/import/detail/mesh_builder.hpp>

#include <glm/geometric.hpp>

#include <cmath>

namespace carom {
namespace {

constexpr std::size_t kMostTriangles = std::size_t{1} << 28;
constexpr std::size_t kMostConcaveCorners = 1024;

// Which way the path a, b, c turns about the normal: positive is to the left.
double turn(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& normal) { return glm::dot(glm::cross(b - a, c - b), normal); }

}  // namespace

void MeshBuilder::reserve(std::size_t vertices, std::size_t triangles) {
    mesh_.vertices.reserve(vertices);
    mesh_.triangles.reserve(triangles);
}

bool MeshBuilder::add_vertex(const dvec3& position) {
    const vec3 rounded(position);
    if (!is_finite(rounded)) return false;
    mesh_.vertices.push_back(rounded);
    return true;
}

const char* MeshBuilder::add_face(std::span<const std::uint32_t> corners) {
    for (const std::uint32_t corner : corners) {
        if (corner >= mesh_.vertices.size()) return "a face names a vertex that is not there";
    }
    if (corners.size() < 3) return nullptr;
    if (corners.size() == 3) {
        mesh_.triangles.push_back({corners[0], corners[1], corners[2]});
        return nullptr;
    }
    const auto at = [&](std::size_t i) { return dvec3(mesh_.vertices[corners[i % corners.size()]]); };
    dvec3 normal{0.0};  // twice the area, as a sum over the edges (Newell's method), about the first corner
    for (std::size_t i = 0; i < corners.size(); ++i) {
        normal += glm::cross(at(i) - at(0), at(i + 1) - at(0));
    }
    bool convex = true;
    for (std::size_t i = 0; convex && i < corners.size(); ++i) {
        convex = turn(at(i), at(i + 1), at(i + 2), normal) >= 0.0;
    }
    if (convex) {
        for (std::size_t i = 2; i < corners.size(); ++i) {
            mesh_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
        }
        return nullptr;
    }
    if (corners.size() > kMostConcaveCorners) return "a concave face has more than 1024 corners";
    add_concave(corners, normal);
    return nullptr;
}

// Cuts off corners whose triangle holds no other corner. A face without such an ear crosses itself: the rest becomes a fan.
void MeshBuilder::add_concave(std::span<const std::uint32_t> corners, const dvec3& normal) {
    rest_.assign(corners.begin(), corners.end());
    const auto is_ear = [&](std::size_t i) {
        const std::size_t count = rest_.size();
        const std::uint32_t corner[3]{rest_[(i + count - 1) % count], rest_[i], rest_[(i + 1) % count]};
        const dvec3 a(mesh_.vertices[corner[0]]), b(mesh_.vertices[corner[1]]), c(mesh_.vertices[corner[2]]);
        if (!(turn(a, b, c, normal) > 0.0)) return false;
        for (std::size_t k = 2; k + 1 < count; ++k) {
            const dvec3 p(mesh_.vertices[rest_[(i + k) % count]]);
            if (p == a || p == b || p == c) continue;  // where a bridge leads to a hole and back
            if (turn(a, b, p, normal) >= 0.0 && turn(b, c, p, normal) >= 0.0 && turn(c, a, p, normal) >= 0.0) return false;
        }
        return true;
    };
    while (rest_.size() > 3) {
        std::size_t ear = 0;
        while (ear < rest_.size() && !is_ear(ear)) ++ear;
        if (ear == rest_.size()) break;
        const std::size_t count = rest_.size();
        mesh_.triangles.push_back({rest_[(ear + count - 1) % count], rest_[ear], rest_[(ear + 1) % count]});
        rest_.erase(rest_.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    for (std::size_t i = 2; i < rest_.size(); ++i) {
        mesh_.triangles.push_back({rest_[0], rest_[i - 1], rest_[i]});
    }
}

Error MeshBuilder::not_finite() const {
    return {ErrorCode::NotFinite, "vertex " + std::to_string(mesh_.vertices.size()) + " is not finite", where_};
}

Result<MeshData> MeshBuilder::finish() {
    if (mesh_.triangles.empty()) return Error{ErrorCode::Empty, "has no triangles", where_};
    if (mesh_.triangles.size() > kMostTriangles) return Error{ErrorCode::InvalidArgument, "has more than 2^28 triangles", where_};
    return std::move(mesh_);
}

}  // namespace carom
