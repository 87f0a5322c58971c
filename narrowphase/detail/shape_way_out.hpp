// Of a convex shape that is deep in the surface of a mesh, a way that leads it out of all triangles.
//
//   ShapeWayOut::Way way;
//   if (ways.find(pair, bounds, surface, shape, way) == ShapeWayOut::Verdict::Other) { way.normal; way.depth; }
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/narrowphase/detail/mesh_surface.hpp>
#include <carom/narrowphase/detail/polytope_axis.hpp>

#include <optional>
#include <vector>

namespace carom::detail {

/// What is asked of the shape, in its own frame.
struct DeepShape {
    Aabb own;                                           ///< its box
    dvec3 centre;                                       ///< tells on which side of the surface it is
    double thin;                                        ///< the least extent of the box [m]
    double deep;                                        ///< what is not as deep is left to the triangles [m]
    double tolerance;                                   ///< touching is no overlap up to this [m]
    FunctionRef<double(const dvec3& direction)> reach;  ///< the largest dot product with a point of it
    /// Whether it meets the triangle: then the normal towards that of the least overlap, and the overlap, negative.
    FunctionRef<bool(const Corners& corners, ContactAxis& axis)> meets;
};

/// Triangles speak for themselves: of a shape that reaches through a thin part each is left on its own side, and of several walls each asks for the
/// way out of itself. Here the ways are those of the whole: motions along normals of triangles near by, and across edges of triangles and of the
/// shape's box, each as long as it takes until the shape meets no triangle of the mesh. The centre stays on its side of the surface, since a closed
/// mesh may be a room, and goes through no wall unless the shape is long; but where it lies in a thin part it goes to the outside.
///
/// Cost: of what meets a few triangles some 50 us, of any no more than a millisecond or so beyond making the triangles' own patches: a search whose work is
/// used up ends with what it has found, and where it had no time to begin the patches stand.
class ShapeWayOut {
public:
    struct Way {
        dvec3 normal{0.0};  ///< unit, from the shape to the surface: the motion is against it
        double depth = 0.0;
        dvec3 middle{0.0};  ///< of the places where the two meet
    };
    enum class Verdict : unsigned char {
        Right,  ///< what the patches say leads out
        Other,  ///< there is a way that they do not say, or a much shorter one
        None,   ///< they do not lead out, and no way that does is known
    };

    /// @param pair     the shape and the mesh. @param bounds  of the shape, in the mesh's frame.
    /// @param surface  what the shape meets, with its patches.
    /// Looks for a way where the patches together do not lead out, or the shape meets faces that look away from each other, as those of a thin part do.
    Verdict find(const PairFrame& pair, const Aabb& bounds, const MeshSurface& surface, const DeepShape& shape, Way& way);

private:
    struct Met {
        Corners corners;
        dvec3 face{0.0};  // unit normal of the triangle
        ContactAxis axis;
    };
    struct Try {
        dvec3 along{0.0};  // unit: the motion
        double length = 0.0;
    };

    /// @return whether there is any left
    bool spend(std::size_t work) noexcept;
    /// Replaces `met_` by the triangles that the shape meets, moved so. @return false where the work ended before it was done
    bool meet(const PairFrame& pair, const Aabb& bounds, const DeepShape& shape, const dvec3& motion);
    [[nodiscard]] bool looks_both_ways() noexcept;
    void offer(const dvec3& along, double most, const DeepShape& shape);
    void collect_ways(const PairFrame& pair, const Aabb& bounds, double most, const DeepShape& shape);
    [[nodiscard]] double leaving(const Met& met, const dvec3& along, const DeepShape& shape) const;
    [[nodiscard]] std::optional<double> length_of(const PairFrame& pair, const Aabb& bounds, const DeepShape& shape, const Try& way,
                                                  double most);
    [[nodiscard]] static bool belongs_outside(const PairFrame& pair, const DeepShape& shape);
    [[nodiscard]] static bool may_go(const PairFrame& pair, const DeepShape& shape, const dvec3& motion, bool outside);
    [[nodiscard]] dvec3 middle_of(const DeepShape& shape) const noexcept;

    std::vector<Met> met_, first_met_;
    std::vector<Try> tries_;
    std::size_t work_left_ = 0;
};

}  // namespace carom::detail
