// Many pairs of boxes at once: how sixteen of them lie side by side, and the kernels that work on them.
//
//   write_box_lines(placed, numbers, places, lines);
//   place_boxes(lines, numbers, pairs, unusual);
//   find_box_axes(pairs, axes);             // which axis separates most, or that they are apart
//   build_box_patches(pairs, axes, patches);
//   write_box_manifolds(lines, numbers, ways, axes, patches, manifolds);
//
// Everything is float, in the frame of the first box about its centre. A box that is much larger than the other was cut to the
// neighbourhood of the other before it was rounded (box_box.cpp), so that lengths differ by little and a float's rounding is 6e-8 of
// the pair's own size.
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/bundle.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/collide.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace carom::detail {

/// One box, as lanes read it: six rows of four floats.
struct alignas(32) BoxLine {
    float axis[3][4];      ///< its axes in the world, and the half extent along each
    float position[3][4];  ///< three floats for each coordinate, which add up to it; then 1 where they cannot, in the first row
};
[[nodiscard]] BoxLine box_line(const Box& box, const Pose& pose) noexcept;
/// The same, to the bit, of many boxes.
/// @param numbers  of shapes that are boxes. @param places  where in `lines` each goes.
void write_box_lines(const PlacedShapes& placed, std::span<const std::uint32_t> numbers, std::span<const std::uint32_t> places, std::span<BoxLine> lines);

/// Which lanes of the bundles are worked on. A pair by itself, in the first lane, has the narrowest lanes for itself: fewer of them work for
/// nothing, and the bits are the same. What is in the lanes beyond means nothing then.
enum class BoxLanes { All, First };

/// Which boxes sixteen pairs are of. Lanes without a pair repeat another.
struct BoxNumberBundle {
    IntBundle a, b;  ///< lines
    FloatBundle margin;
};

/// Sixteen pairs.
struct BoxPairBundle {
    FloatBundle half_a[3];
    FloatBundle half_b[3];
    FloatBundle rotation[3][3];  ///< [i][j]: component along axis i of A of axis j of B
    FloatBundle offset[3];       ///< centre of B from A's, along A's axes
    FloatBundle margin;          ///< separations up to this count
};

/// Codes of axes: faces of A are 0..2, faces of B 3..5, edge i of A with edge j of B is 6 + 3 i + j.
inline constexpr std::int32_t kApart = -1;
inline constexpr std::int32_t kFirstFaceOfB = 3;
inline constexpr std::int32_t kFirstEdge = 6;

/// The axis of the greatest separation of sixteen pairs.
struct BoxAxisBundle {
    FloatBundle separation;
    IntBundle code;  ///< kApart: farther apart than the margin, which is certain
};

/// Codes of candidates: corner k of B's face is k, corner k of A's is 4 + k, edge k of B's face across side s of A's is 8 + 4 s + k, and the
/// two edges of an edge axis are 24. Corners of a face run (+,+), (-,+), (-,-), (+,-) in its axes p and q, the two after its own;
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

/// The way of sixteen patches back to the world.
struct BoxWayBundle {
    FloatBundle centre[3];  ///< of the part of A that was worked on, along A's axes [m]
    FloatBundle unit;       ///< metres of a unit of the bundles, a power of two
    IntBundle pair;         ///< in the batch
    IntBundle to;           ///< where the manifold goes; kNoManifold: nowhere
};
inline constexpr std::int32_t kNoManifold = std::numeric_limits<std::int32_t>::max();

/// Brings pairs into the frames of their first boxes. Positions are differences of three floats each, which holds all of a double, so the
/// distance from the world's origin does not matter. `unusual` has the bits of the lanes that float cannot take as they are: sizes that
/// differ by much, or are out of its range. What is written there means nothing.
/// Accuracy: rotations within 2e-7, offsets within 3e-7 of their length.
void place_boxes(std::span<const BoxLine> lines, std::span<const BoxNumberBundle> numbers, std::span<BoxPairBundle> pairs,
                 std::span<std::uint32_t> unusual, BoxLanes lanes = BoxLanes::All);

/// Names the points of patches and writes them as manifolds, in world axes about A's centre.
void write_box_manifolds(std::span<const BoxLine> lines, std::span<const BoxNumberBundle> numbers, std::span<const BoxWayBundle> ways,
                         std::span<const BoxAxisBundle> axes, std::span<const BoxPatchBundle> patches, Manifold* manifolds,
                         BoxLanes lanes = BoxLanes::All);

/// Method: Gottschalk, Lin, Manocha, OBBTree (1996), sec. 5, with normalised edge axes. An edge axis wins over the faces only where it is
/// better by kWidePreference of the size.
/// Accuracy: separations within 1e-6 of the larger box's longest edge.
void find_box_axes(std::span<const BoxPairBundle> pairs, std::span<BoxAxisBundle> axes, BoxLanes lanes = BoxLanes::All);

/// The faces that look at each other most, cut against each other in the plane across the axis: both become parallelograms there, and
/// in the coordinates of A's, a square against a parallelogram. Up to four points are kept, as reduce_points() does.
/// Pairs must not be apart. A count of 0 means that the faces do not lie over each other within the margin: corner to corner or
/// corner to edge, which only the distance decides.
void build_box_patches(std::span<const BoxPairBundle> pairs, std::span<const BoxAxisBundle> axes, std::span<BoxPatchBundle> patches,
                       BoxLanes lanes = BoxLanes::All);

}  // namespace carom::detail
