// Two wide hierarchies descended together.
//
//   WidePlacement placement;
//   if (place(a, b, b_in_a, placement)) visit_leaf_pairs(a, b, placement, [&](const LeafPair& pair) { ...; return true; }, {});
//
// Write u = 2^-24, X for the largest coordinate of either tree and T for the largest coordinate of the translation, all in the
// coordinates that are worked in. Coordinates of the other mesh are mapped by three products and three sums in float; with the
// rounding of the map itself a coordinate is wrong by 6 u (sqrt(3) X + T) at most. The margin m = 16 u (X + T) is more than that, and
// than what two more sums with a coordinate add.
//
// Local coordinates. Boxes lie in the frame of a, but corners are judged about an origin near both leaves, so that what rounding does to them
// is a share of their own size. It is the place of the first vertex of b's leaf: found in double, rounded to float; its rest is added to b's
// corners, which are mapped as differences from that vertex. Where M is more than the length of any corner, they are wrong by less than
// 7 u M: of b, one rounding for the difference, one for the map, one for the product and three for sums, of lengths that a turn leaves as
// they are; of a, one for the difference. So differences of two corners are wrong by δ = 15 u M at most.
//
// Sizes. Each lane takes those of its own pair. L is the sum of the edges of a triangle's box in the frame of a, grown by m and, of b, by r:
// no edge of the triangle is longer. W = L_a + L_b: as the boxes overlap, no difference between their corners is longer. M = W + N, where no
// vertex of b's leaf is farther from the origin than N, the sum of the edges of the leaf's box. (m keeps the bounds below from underflowing.)
//
// Determinants. The determinant e × f · g of three differences of corners, as large as E, F, G and wrong by δ in each component, is
// wrong by less than √3 δ (F G + E G + E F) + 3 δ² (E + F + G) + 6 δ³, which is less than (E + d) (F + d) (G + d) - E F G with
// d = 30 u M > 1.82 δ; and what rounding does to its products and sums is less than 16 u E F G: of six products of three factors, at most
// 1.16 E F G together (the permanent of three unit vectors is at most 2 / √3), each suffers seven roundings. Both are taken 1.01 times, for
// the rounding of the bounds themselves. Let P = L + d and w = W + d.
//
// Planes. The height of a corner over a plane is such a determinant, of two edges and a difference between the two. It is wrong by less than
// P² w - L² W + 16 u L² W < P (2 d w + (d + 16 u w) P). Only what is farther off a plane than its bound is parted by it.
//
// Crossings. Two triangles each with a lone corner on one side of the other's plane, p, q, r and u, v, w turned so that p and u lie above, meet
// if and only if the determinants (q - p) × (u - p) · (v - p) and (r - p) × (w - p) · (u - p) are not above zero (triangles_meet.cpp). These are
// wrong by less than w² (L_a + d) - W² L_a + 16 u W² L_a < w (d w + (2 d + 16 u w) L_a). Where all six heights and both determinants are
// farther from zero than their bounds the verdict is certain.
//
// Reach. Asked for what is within a reach r > 0, boxes of b's tree grow by r, and a plane parts what is farther off it than r |n|, n = e × f.
// |n| is bounded by the sum of its components' sizes, whose error is at most 3 (2 δ L + δ² + 4 u L²); as W > r, r times that is less
// than three times the bound above, which is taken four times.
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/pose.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom {

/// Where mesh b lies in the tree coordinates of mesh a, and the other way round.
struct WidePlacement {
    double exact_to_a[3][4];  ///< to_a before it is rounded
    float to_a[3][4];  ///< [row][x, y, z, translation]
    float to_b[3][4];
    float margin_a;    ///< m of the header, in the frame of a, and of b
    float margin_b;
    float stretch;     ///< of a length of b in the frame of a, rounded up
    float reach_a;     ///< r of the header, in the frame of a, rounded up
    float reach_b;
    bool too_unlike;   ///< in size, for float, or stretched by the pose: visit_leaf_pairs then works in double, box by box
    double reach;      ///< [m]
    double metres;     ///< of a unit of b's tree
    double units;      ///< of a's tree, of a metre
    Pose pose;

    /// Sets the reach [m]; finite, >= 0. A visit may lower it: what is descended to afterwards is judged by the new one.
    void set_reach(double metres_away) noexcept;

    /// @return the place of a corner of b's tree in a's tree coordinates: transform_point(pose, corner), but zero for what is below
    /// 2^-300.
    [[nodiscard]] dvec3 place(float x, float y, float z) const noexcept;
};

/// @param reach  [m]; finite, >= 0.
/// @return false where no points of the two are within `reach` of each other, and where the pose is not finite.
[[nodiscard]] bool place(const WideBvh& a, const WideBvh& b, const Pose& b_in_a, double reach, WidePlacement& out) noexcept;

/// Triangles of two leaves that neither their boxes nor their planes keep farther apart than the reach.
struct LeafPair {
    static constexpr std::int32_t kCertain = 256;

    const WideLeaf* a = nullptr;
    const WideLeaf* b = nullptr;
    std::size_t count = 0;
    alignas(64) std::int32_t candidate[kWidth * kWidth + kWidth];  ///< i + 16 j for triangle i of a and j of b, + kCertain where they meet for certain

    [[nodiscard]] std::size_t of_a(std::size_t k) const noexcept { return static_cast<std::size_t>(candidate[k] & 15); }
    [[nodiscard]] std::size_t of_b(std::size_t k) const noexcept { return static_cast<std::size_t>(candidate[k] >> 4 & 15); }
    [[nodiscard]] bool is_certain(std::size_t k) const noexcept { return (candidate[k] & kCertain) != 0; }
    [[nodiscard]] std::uint32_t triangle_of_a(std::size_t k) const noexcept { return a->triangle[of_a(k)]; }
    [[nodiscard]] std::uint32_t triangle_of_b(std::size_t k) const noexcept { return b->triangle[of_b(k)]; }
};
using LeafPairVisit = FunctionRef<bool(const LeafPair&)>;

/// A pair of nodes or leaves that was looked at, with the box of each in its own tree's coordinates.
struct VisitedPair {
    WideRef a, b;
    float box_a[2][3], box_b[2][3];  ///< [lower, upper][x, y, z]
};

struct PairWalk {
    bool deepest_first = false;                  ///< of the pairs that a step finds, for who stops at the first
    std::vector<VisitedPair>* visited = nullptr;  ///< where to write what is looked at, in its order
};

/// Calls `visit` for every pair of leaves with a pair of triangles that may be within the reach, until it returns false. Allocates only
/// while a buffer of the calling thread grows.
void visit_leaf_pairs(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit, const PairWalk& walk);

/// The same box by box in double, leaving only boxes to part what does not meet: for sizes that float cannot hold together, and to
/// compare with.
void visit_leaf_pairs_in_double(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit, const PairWalk& walk);

}  // namespace carom
