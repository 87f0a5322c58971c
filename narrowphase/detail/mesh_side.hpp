// One of two meshes in contact: where it lies, which of its sides pushes, how far a point is from its surface, and which normals the
// surface allows.
//
//   side.set(mesh, rotation, translation, other);
//   if (auto s = side.measure(p, reach)) { s->separation; s->outward; }
#pragma once

#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/triangle.hpp>

#include <optional>
#include <vector>

namespace carom::detail {

/// A point of a surface nearest to another point, all in the frame of the pair.
struct SurfacePoint {
    dvec3 point{0.0};
    dvec3 outward{0.0, 1.0, 0.0};  ///< unit: the way out of what the surface bounds, through the other point or from it
    double separation = 0.0;       ///< negative: the other point is behind the surface [m]
};

/// A face above or below a point.
struct SurfaceFace {
    dvec3 normal{0.0, 1.0, 0.0};
    double height = 0.0;  ///< of the point over it [m]
};

/// What one mesh has to know of the other.
struct OtherMesh {
    dvec3 centre{0.0};      ///< of its box, in the frame of the pair
    double diagonal = 0.0;  ///< of its box [m]
};

/// Which side of a mesh pushes. A closed mesh is solid: it pushes to the outside. So does an open one by its winding, but to something at
/// most half its size it has two sides, and pushes to the one on which that thing's centre lies; triangle by triangle where
/// neighbours are not wound alike.
class MeshSide {
public:
    /// @param rotation, translation  from the mesh's frame to that of the pair.
    void set(const TriangleMesh& mesh, const dmat3& rotation, const dvec3& translation, const OtherMesh& other);

    [[nodiscard]] const TriangleMesh& mesh() const noexcept { return *mesh_; }
    [[nodiscard]] dvec3 to_pair(const vec3& p) const noexcept { return rotation_ * dvec3(p) + translation_; }
    /// The corners in the frame of the pair, counter-clockwise seen from the side that pushes.
    [[nodiscard]] Corners corners(std::uint32_t triangle) const noexcept;
    /// The numbers of these corners.
    [[nodiscard]] TriangleMesh::Triangle vertices(std::uint32_t triangle) const noexcept;

    /// Whether the surface is locally highest along the unit vector `outward` at its point `p`, to `tolerance` [m], and `outward` leads
    /// to the side that pushes. Triangles are found by position, as in MeshSurface.
    [[nodiscard]] bool allows(const dvec3& p, const dvec3& outward, double tolerance) const;

    /// @return the nearest point of the surface, if it is within `reach` [m]. Sign: that of the plane farthest from p among the triangles
    /// at that point (Baerentzen, Aanaes 2005, sec. 3). Beside an open edge a point is in front, whatever its height.
    [[nodiscard]] std::optional<SurfacePoint> measure(const dvec3& p, double reach) const;
    /// The same where the nearest point is known.
    [[nodiscard]] std::optional<SurfacePoint> measure_at(const dvec3& p, const dvec3& nearest) const;

    /// Replaces `faces` by those that p lies straight behind, by at most `reach` [m]; on their outline to `tolerance` [m].
    void faces_over(const dvec3& p, double reach, double tolerance, std::vector<SurfaceFace>& faces) const;

    /// Calls `visit` for the triangles with p on them, to `tolerance` [m].
    template <class Visit>
    void for_each_at(const dvec3& p, double tolerance, const Visit& visit) const {
        const dvec3 at = (p - translation_) * rotation_, reach{tolerance};
        mesh_->overlap({at - reach, at + reach}, [&](std::uint32_t triangle) {
            const Corners t = corners(triangle);
            const dvec3 gap = closest_on_triangle(t, p).point - p;
            if (glm::dot(gap, gap) <= tolerance * tolerance) visit(triangle, t);
            return true;
        });
    }

private:
    [[nodiscard]] bool is_turned(std::uint32_t triangle) const noexcept;

    const TriangleMesh* mesh_ = nullptr;
    dmat3 rotation_{1.0};
    dvec3 translation_{0.0};
    dvec3 toward_{0.0};      // the other's centre, in the mesh's frame
    bool turned_ = false;    // all triangles push to their back
    bool each_ = false;      // each triangle pushes to the side of `toward_`
    double touching_ = 0.0;  // distances up to this are none [m]
};

}  // namespace carom::detail
