// Many pairs of boxes at once: how they lie side by side, and the kernels that work on them, sixteen at a time.
//
//   find_near_boxes(input, chosen, near);           // brings pairs together; which axis separates most; lists what is not apart
//   build_box_patch(near.faces, bundle, patch);     // the points of sixteen of those; build_edge_patch() of near.edges
//   write_box_manifolds(near.faces, bundle, patch, to, manifolds);
//
// Everything is float, in the frame of the first box about its centre. A box that is much larger than the other was cut to the
// neighbourhood of the other before it was rounded (box_box.cpp), so that lengths differ by little and a float's rounding is 6e-8 of
// the pair's own size.
#pragma once

#include <carom/core/bundle.hpp>
#include <carom/narrowphase/detail/kernel.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace carom::detail {

/// Which lanes of the bundles are worked on. A pair by itself, in the first lane, has the narrowest lanes for itself: fewer of them work
/// for nothing, and the bits are the same. What is in the lanes beyond means nothing then.
enum class BoxLanes { All, First };

/// Codes of axes: faces of A are 0..2, faces of B 3..5, edge i of A with edge j of B is 6 + 3 i + j.
inline constexpr std::int32_t kApart = -1;
inline constexpr std::int32_t kFirstFaceOfB = 3;
inline constexpr std::int32_t kFirstEdge = 6;

/// Up to kPairs pairs and what a bundle before left, number by number, each in the frame of its first box.
struct BoxPairBlock {
    static constexpr std::size_t kPairs = 128;
    static constexpr std::size_t kRoom = kPairs + 2 * kBundleWidth;  ///< what is appended comes sixteen at a time
    using Column = float[kRoom];
    using Numbers = std::int32_t[kRoom];

    alignas(kBundleAlignment) Column half_a[3] = {};
    Column half_b[3] = {};
    Column rotation[3][3] = {};  ///< [i][j]: component along axis i of A of axis j of B
    Column offset[3] = {};       ///< centre of B from A's, along A's axes
    Column margin = {};          ///< separations up to this count
    Column axis_a[3][3] = {};    ///< A's axes in the world
    Column separation = {};      ///< greatest of all axes
    Numbers code = {};           ///< of that axis; kApart: farther apart than the margin, which is certain
    Numbers pair = {};           ///< in the batch
    Numbers place = {};          ///< of the pair among all that are near
    Numbers unusual = {};        ///< 1: float cannot take it as it is, and the numbers above mean nothing yet
    Column centre[3] = {};       ///< of the part of A that is worked on, along A's axes [m]
    Column unit = {};            ///< metres of a unit of the above, a power of two
    std::size_t count = 0;       ///< beyond are lanes that hold anything finite or not
    bool any_unusual = false;    ///< otherwise `unusual` is not to be read
    bool steady = false;         ///< as in PlacedShapes

    /// Forgets the pairs before bundle `first`, after which there are fewer than a bundle's, or none.
    void drop_before(std::size_t first) noexcept;
};

/// The pairs that are not apart, in two lists.
struct BoxesNear {
    BoxPairBlock faces;
    BoxPairBlock edges;       ///< they meet by two edges alone, whose crossing is their one point
    std::int32_t listed = 0;  ///< in both: the next place
    bool all_finite = true;   ///< the poses of all pairs that were looked at, but of unusual ones, of which the caller finds out; false
                              ///< proves nothing
};

/// Codes of candidates: corner k of B's face is k, corner k of A's is 4 + k, edge k of B's face across side s of A's is 8 + 4 s + k, and
/// the two edges of an edge axis are 24. Corners of a face run (+,+), (-,+), (-,-), (+,-) in its axes p and q, the two after its own;
/// edge k goes from corner k to k + 1; sides are p+, p-, q+, q-.
inline constexpr std::int32_t kCornerOfA = 4;
inline constexpr std::int32_t kCrossing = 8;
inline constexpr std::int32_t kEdges = 24;

/// What sixteen pairs have in common.
struct BoxPatchBundle {
    struct Point {
        FloatBundle position[3];  ///< midway between the surfaces
        FloatBundle separation;
        IntBundle candidate;
        IntBundle corner_a;  ///< corner of A's face that the point lies at; -1: none
        IntBundle corner_b;
    };
    FloatBundle normal[3];    ///< unit, from A to B
    FloatBundle normal_b[3];  ///< the same along B's axes
    IntBundle face_a;         ///< axis of A's face that looks to B most
    IntBundle face_b;
    IntBundle count;  ///< of points, 0..4
    std::array<Point, 4> points;
};

inline constexpr std::int32_t kNoManifold = std::numeric_limits<std::int32_t>::max();

/// Brings pairs into the frames of their first boxes, finds the axis along which each is farthest apart, and lists those that are not
/// apart after those that `out` has, in their order. Positions are subtracted in double, so the distance from the world's origin does not
/// matter. Listed too are the `unusual` pairs, which float cannot take as they are: sizes that
/// differ by much, or are out of its range.
/// @param chosen  at most kPairs, boxes all.
/// Method: Gottschalk, Lin, Manocha, OBBTree (1996), sec. 5, with normalised edge axes. An edge axis wins over the faces only where it is
/// better by kWidePreference of the size.
/// Accuracy: rotations within 2e-7, offsets within 3e-7 of their length; separations within 1e-6 of the larger box's longest edge.
void find_near_boxes(const BatchInput& input, std::span<const std::uint32_t> chosen, BoxesNear& out, BoxLanes lanes = BoxLanes::All);

/// Finds the axes of sixteen pairs anew: of unusual ones, whose numbers have been put in their place.
void find_box_axes(BoxPairBlock& block, std::size_t bundle, BoxLanes lanes = BoxLanes::All);

/// The faces that look at each other most, cut against each other in the plane across the axis: both become parallelograms there, and
/// in the coordinates of A's, a square against a parallelogram. Up to four points are kept, as reduce_points() does.
/// A count of 0 means that the faces do not lie over each other within the margin, or not where they are nearest along the axis: corner to
/// corner, corner to edge, or a corner beside a face, which only the distance decides. Of pairs that are apart it means nothing.
void build_box_patch(const BoxPairBlock& block, std::size_t bundle, BoxPatchBundle& patch, BoxLanes lanes = BoxLanes::All);

/// The same of pairs that meet by edges alone: the first point of the patch, or none.
void build_edge_patch(const BoxPairBlock& block, std::size_t bundle, BoxPatchBundle& patch, BoxLanes lanes = BoxLanes::All);

/// Names the points of patches and writes them as manifolds, in world axes about A's centre.
/// @param to  which manifold each becomes; kNoManifold: none.
void write_box_manifolds(const BoxPairBlock& block, std::size_t bundle, const BoxPatchBundle& patch, const IntBundle& to,
                         Manifold* manifolds, BoxLanes lanes = BoxLanes::All);
/// The same of patches of build_edge_patch().
void write_edge_manifolds(const BoxPairBlock& block, std::size_t bundle, const BoxPatchBundle& patch, const IntBundle& to,
                          Manifold* manifolds, BoxLanes lanes = BoxLanes::All);

}  // namespace carom::detail
