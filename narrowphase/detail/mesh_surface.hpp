// The triangles of a mesh near a convex shape, which normals they allow, and the patches that they make together.
//
//   surface.gather(pair, bounds_in_mesh);
//   for (const NearTriangle& t : surface.triangles) ... surface.patches.push_back({patch, t.index});
//   surface.emit(0.95, size, sink);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/reduce.hpp>
#include <carom/narrowphase/detail/triangle.hpp>

#include <optional>
#include <vector>

namespace carom::detail {

/// A triangle of the mesh in the frame of the convex shape.
struct NearTriangle {
    std::uint32_t index = 0;
    Corners corners{dvec3{0.0}, dvec3{0.0}, dvec3{0.0}};
    dvec3 lower{0.0}, upper{0.0};
};

/// What one triangle contributes.
struct TrianglePatch {
    Patch patch;
    std::uint32_t triangle = 0;
    bool replaced = false;       ///< the triangle's normal stands in for one that the surface does not allow
    bool holds_deepest = false;  ///< of a stand-in: the shape's deepest point under the triangle's plane lies over the surface
    bool used = false;
    dvec3 way{0.0};  ///< of a stand-in: the normal that is not allowed, and the separation along it [m]
    double along = 0.0;
};

class MeshSurface {
public:
    std::vector<NearTriangle> triangles;
    std::vector<TrianglePatch> patches;

    /// Collects the triangles whose boxes meet `bounds` (mesh frame), in the order of the mesh's hierarchy, and forgets all patches.
    /// `pair` must outlive what is asked after it.
    void gather(const PairFrame& pair, const Aabb& bounds);

    /// Whether the surface is locally highest along the unit vector `outward` at its point `p`: then a contact there may push along
    /// it. On an edge between two triangles that lie in one plane only the plane's normal may; in a valley nothing but the faces'.
    /// Triangles are found by position, so cracks of up to `tolerance` [m] count as joined, and T-junctions need no adjacency.
    [[nodiscard]] bool allows(const dvec3& p, const dvec3& outward, double tolerance) const;

    /// Whether `p` lies in front of the surface: in front of the triangle nearest to it, and where several are equally near (along an
    /// edge, at a corner), of the one whose plane is farthest (Baerentzen, Aanaes 2005, sec. 3, on why one plane alone may lie).
    /// Found once after each gather(): ask for one and the same point.
    [[nodiscard]] bool is_in_front(const dvec3& p) noexcept;

    enum class Foot : unsigned char { None, New, Known };

    /// Whether the surface passes through `p`, to `tolerance` [m]; Known where it was asked of that point last.
    [[nodiscard]] Foot foot_at(const dvec3& p, double tolerance);

    /// Drops stand-ins that are more than twice as deep as all contacts whose normals the surface allows or which hold the deepest point
    /// under their plane. On a flat stretch the deepest contact is one of those; a stand-in beyond it reaches through a ridge, and its depth
    /// is that of another part of the shape.
    /// And drops stand-ins deeper than the deepest contact whose normal the surface allows, where that leads the shape out of their triangle as
    /// well, to `tolerance` [m].
    void drop_runaways(double tolerance) noexcept;

    /// Drops what is deeper than a way out of all triangles that have a patch: the shallowest patch along whose normal the shape, moved by its
    /// depth, is free of them, and which is not as the deepest one. A stand-in asks for the way out of its own plane alone.
    /// @param frees  whether the shape is free of the triangle, to `tolerance` [m], where the triangle is moved by `motion`.
    void drop_spared(double tolerance, FunctionRef<bool(const Corners& triangle, const dvec3& motion)> frees);

    /// Puts one point in the place of all stand-ins, of what is deeper than it or than `deep` [m], and of what pushes against it.
    /// @param normal  unit, from the shape to the surface. @param middle  of the places where the two meet.
    void replace_deeper(const dvec3& normal, double depth, const dvec3& middle, double deep);

    /// @return whether a patch has a point that is not apart.
    [[nodiscard]] bool touches() const noexcept;

    /// Merges the patches: the deepest leads, and takes in all whose normals lie within acos(`same_normal`) of its own; then the
    /// deepest of the rest. Each group becomes one manifold of at most four points, its separations along the leader's normal.
    void emit(double same_normal, double tolerance, ManifoldSink& sink);

private:
    [[nodiscard]] bool leads_out(const TrianglePatch& way, const TrianglePatch& first,
                                 FunctionRef<bool(const Corners&, const dvec3&)> frees) const;
    [[nodiscard]] double height_of(const dvec3& p) const noexcept;
    /// Whether `test` holds for a triangle of the mesh with p on it, to `tolerance` [m].
    template <class Test>
    [[nodiscard]] bool any_at(const dvec3& p, double tolerance, const Test& test) const;

    const PairFrame* pair_ = nullptr;  ///< of the last gather()
    const TriangleMesh* mesh_ = nullptr;
    Aabb gathered_;
    std::vector<Candidate> candidates_;
    std::vector<std::uint32_t> ways_;  ///< patches that may lead out of all triangles
    std::optional<bool> in_front_;
    std::optional<dvec3> foot_;  ///< that was asked for last
    bool passes_foot_ = false;
};

}  // namespace carom::detail
