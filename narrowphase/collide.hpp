// Two shapes in, manifolds out: the table of pair kernels, one pair or many.
//
//   std::vector<Manifold> manifolds;
//   collide(pairs, executor, scratch, manifolds);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/manifold.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace carom {

/// One pair of placed shapes. The pointers must outlive the call. At most one of the two is a plane.
struct ShapePair {
    const Shape* a = nullptr;
    const Shape* b = nullptr;
    Pose pose_a;
    Pose pose_b;
    float margin = 0.0f;  ///< points with a separation up to this are reported [m], >= 0
    bool steady = false;  ///< as in PlacedShapes
};

/// Shapes by number, each with its pose: (n,) and (n,). A null shape is no shape, and no pair may name it. The pose of a shape
/// that no pair names may be anything.
struct PlacedShapes {
    std::span<const Shape* const> shapes;
    std::span<const Pose> poses;
    /// Of more than four corners of a patch four are reported, and the deepest is one of them. Where `steady`, it may be left out if it is deeper
    /// than the four that span the patch by no more than 30 % of their depth and no more than 1e-3 of the larger shape's extent (where a mesh
    /// is met, the choice is made once for each triangle and once for all: up to 70 %). What rests on
    /// more than four corners then rests on the same four: otherwise the one that bears nothing sinks until it is the deepest, takes the
    /// place of one that bears, and that one sinks in turn.
    bool steady = false;
};

inline constexpr std::uint32_t kNewPair = std::numeric_limits<std::uint32_t>::max();

/// A pair of them. At most one of the two is a plane.
struct NumberedPair {
    std::uint32_t a = 0, b = 0;
    float margin = 0.0f;            ///< as in ShapePair
    float slack = 0.0f;             ///< how far the two may move against each other before they are looked at anew [m], >= 0
    std::uint32_t last = kNewPair;  ///< number of the same pair of the same two shapes in the batch before
};

/// How a pair was decided; anything but Ok is counted in StepReport.
enum class CollideStatus : unsigned char {
    Ok,         ///< decided within the documented bound
    Undecided,  ///< an iteration stopped at its cap, one mesh is inside of another, or no way out of a mesh was found: contact is reported, as deep
                ///< as it is along its normal; another direction may be shallower, and of the last the way may be barred
};

/// @return whether the table has a kernel for the two types in this or the other order. It has one for every two types but Plane and
/// Plane.
[[nodiscard]] bool can_collide(ShapeType a, ShapeType b) noexcept;

/// Appends the manifolds of one pair to `out`, with `pair` = `index`. No manifold means: farther apart than the margin.
/// Frame: world axes about A's origin; see Manifold. Swapping a and b flips the normal and keeps points and separations, but for two meshes
/// deep in each other, of which another way out may be found.
///
/// What is reported: where the shapes overlap, the least depth over all directions (for a mesh, over those its surface allows, and where
/// it allows none, over the normals of the triangles that are met; what overlaps is always reported); where they are apart, their
/// distance. A body on a flat or nearly flat stretch of a mesh has one manifold; a mesh has two sides, and pushes to the one on which the
/// shape's centre lies; of a one-sided mesh nothing is reported to what has its centre behind it. A mesh that bounds a convex solid
/// (TriangleMesh::solid) is met as that, but by what has its centre inside and room there, which is kept in. Flat ends of cylinders and
/// cones give up to four points of their rim or of what they lie on, sides a line of two; where a side or rim touches smoothly, the
/// normal is found to about 5e-6. Two meshes push to their fronts, and have a manifold for each patch; where they are apart by more than
/// 1/64 of the smaller one, only what is about as near as the nearest points is reported; where they overlap by more than that, a motion
/// along a normal by the depth frees the two where such a one was found, and it may be too long by some 1e-2 of the size
/// (docs/narrowphase.md).
/// Accuracy: 1e-6 of the larger shape's size (2e-6 for the depth and the distance of two boxes; 1e-5 of hulls with faces that
/// ConvexHull::build merged, whose planes lie that much outside), of a mesh the convex shape's, and of a box much larger than the other the
/// other's. Computed in double in the frame of one of the two, two boxes in float in the frame of A (sixteen pairs at a time), so the
/// distance from the world's origin does not matter; positions are rounded to float about A, so let A be the smaller.
/// Misuse (null shape, non-finite pose, negative or non-finite margin, a pair without a kernel) is reported and appends nothing.
/// Cost: O(1) for round shapes, cylinders, cones, boxes and planes; hulls O(F V + E E); meshes O(log m + triangles near); compounds
/// the sum over the parts near each other. Allocates only while buffers of the calling thread grow. Thread-safe.
CollideStatus collide(const ShapePair& pair, std::uint32_t index, std::vector<Manifold>& out);

/// Buffers of the batch, kept between calls so that nothing is allocated once warm.
class CollideScratch {
public:
    CollideScratch();
    ~CollideScratch();
    CollideScratch(CollideScratch&&) noexcept;
    CollideScratch& operator=(CollideScratch&&) noexcept;

private:
    friend struct CollideBatch;
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Counts of one batch.
struct CollideCounts {
    std::size_t undecided = 0;
    std::size_t reused = 0;  ///< pairs that were not looked at
};

/// Collides all `pairs`, (n,), sorted into batches by kernel, and replaces `out` by their manifolds in the order of `pairs`.
/// The same bits as the single call, on every number of threads and at every SIMD width.
/// What depends on one shape alone is looked at once for each, however many pairs it is in; of up to 1,024 pairs of boxes on one thread the
/// other shapes are not looked at. On one thread, `out` may get other memory than it had.
/// Misuse as in the single call, and sizes of `placed` that differ, a number beyond them, a pair that names its `last`: reported, nothing
/// changes.
CollideCounts collide(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, CollideScratch& scratch,
                      std::vector<Manifold>& out);

/// The same, but for each pair, by number and in their order, its manifolds (maybe none) go to `take`, on the calling thread and while the
/// call lasts. The span is valid until `take` returns.
/// @return counts of all pairs; none is reused.
/// Misuse as above: `take` is not called, and nothing changes. What `take` throws leaves the call; pairs after that one are not given, and
/// `scratch` can be used again. It must not be used within `take`. The batch is not remembered, and the one before is forgotten.
/// Cost: as above. Memory: manifolds are held by blocks, of 1,024 pairs for each kind of pair on one thread and 4,096 a kind and thread on
/// several, and never those of all pairs at once.
using TakeManifolds = FunctionRef<void(std::size_t pair, std::span<const Manifold> manifolds)>;
CollideCounts collide(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, CollideScratch& scratch,
                      TakeManifolds take);

/// The same, looking only at pairs that have moved.
///
/// Where a pair has a slack and was in the batch before, and the two shapes have since moved against each other by no more than that, its
/// manifolds of then are carried along with them: separations are right to second order in the motion, and where another feature would
/// decide by now, a depth is too large by at most twice the slack. Points up to margin + slack may be reported. A pair is looked at anew at
/// least every 64 batches. So results depend on the batches before, but on nothing else.
/// @param last  the manifolds of the last call with this `scratch`, in their order (`pair` there may have been renumbered); not `out`.
/// Misuse besides: a negative or non-finite slack, a `last` that was not the pair of these two numbers, manifolds that are not as many.
/// Cost of a pair that is not looked at: some 50 ns and 20 ns a point.
CollideCounts collide(const PlacedShapes& placed, std::span<const NumberedPair> pairs, std::span<const Manifold> last,
                      Executor& executor, CollideScratch& scratch, std::vector<Manifold>& out);

/// The same of pairs that each bring their own shapes and poses.
/// Misuse besides: pairs of which some are `steady` and some are not.
CollideCounts collide(std::span<const ShapePair> pairs, Executor& executor, CollideScratch& scratch,
                      std::vector<Manifold>& out);

}  // namespace carom
