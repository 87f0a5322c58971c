#include <carom/collision/detail/triangles_meet.hpp>
#include <carom/collision/detail/wide_pairs.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/core/check.hpp>

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <array>
#include <utility>

namespace carom {
namespace {

/// The corners of the triangles of two leaves that are looked at, each placed once.
class PlacedLeaves {
public:
    PlacedLeaves(const LeafPair& pair, const WidePlacement& placement) : pair_(pair), placement_(placement) {}

    [[nodiscard]] bool meet(std::size_t i, std::size_t j) {
        const WideLeaf &a = *pair_.a, &b = *pair_.b;
        detail::TriangleCorners first, second;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = a.corner[k][i];
            first[k] = dvec3{a.vertex[0][v], a.vertex[1][v], a.vertex[2][v]};
            second[k] = placed(b, b.corner[k][j]);
        }
        return detail::triangles_meet(first, second);
    }

private:
    const dvec3& placed(const WideLeaf& b, std::size_t v) {
        if ((done_ >> v & 1u) == 0) {
            done_ |= 1u << v;
            points_[v] = placement_.place(b.vertex[0][v], b.vertex[1][v], b.vertex[2][v]);
        }
        return points_[v];
    }

    const LeafPair& pair_;
    const WidePlacement& placement_;
    std::uint32_t done_ = 0;
    std::array<dvec3, kWidth> points_;
};

/// Calls `met(a, b)` for each pair of triangles that meet, until it returns false.
/// @param deepest_first  for who wants one pair soon.
template <class Met>
void for_each_pair(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, bool deepest_first, Met met) {
    WidePlacement placement;
    if (!place(a.wide(), b.wide(), b_in_a, 0.0, placement)) return;
    visit_leaf_pairs(a.wide(), b.wide(), placement, [&](const LeafPair& pair) {
        PlacedLeaves leaves(pair, placement);
        for (std::size_t k = 0; k < pair.count; ++k) {
            if (!pair.is_certain(k) && !leaves.meet(pair.of_a(k), pair.of_b(k))) continue;
            if (!met(TrianglePair{pair.triangle_of_a(k), pair.triangle_of_b(k)})) return false;
        }
        return true;
    }, {.deepest_first = deepest_first});
}

/// Sorts without allocating once the calling thread's buffers have grown.
void sort_pairs(std::vector<TrianglePair>& pairs) {
    thread_local const hwy::Sorter sorter;
    thread_local std::vector<std::uint64_t> keys;
    if (pairs.size() < 2) return;
    keys.clear();
    for (const TrianglePair& pair : pairs) keys.push_back(std::uint64_t{pair.a} << 32 | pair.b);
    sorter(keys.data(), keys.size(), hwy::SortAscending());  // no two are equal
    for (std::size_t k = 0; k < keys.size(); ++k) {
        pairs[k] = {static_cast<std::uint32_t>(keys[k] >> 32), static_cast<std::uint32_t>(keys[k])};
    }
}

}  // namespace

std::optional<TrianglePair> find_overlap(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a) {
    std::optional<TrianglePair> found;
    for_each_pair(a, b, b_in_a, true, [&](const TrianglePair& pair) {
        found = pair;
        return false;
    });
    return found;
}

bool meshes_overlap(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a) { return find_overlap(a, b, b_in_a).has_value(); }

void overlapping_pairs(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, std::vector<TrianglePair>& pairs) {
    pairs.clear();
    for_each_pair(a, b, b_in_a, false, [&](const TrianglePair& pair) {
        pairs.push_back(pair);
        return true;
    });
    sort_pairs(pairs);
}

void near_pairs(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, double reach, std::vector<TrianglePair>& pairs) {
    CAROM_REQUIRE(is_finite(reach) && reach >= 0.0, ErrorCode::InvalidArgument, "near_pairs: the reach must be finite and not negative");
    pairs.clear();
    WidePlacement placement;
    if (!place(a.wide(), b.wide(), b_in_a, reach, placement)) return;
    visit_leaf_pairs(a.wide(), b.wide(), placement, [&](const LeafPair& pair) {
        for (std::size_t k = 0; k < pair.count; ++k) pairs.push_back({pair.triangle_of_a(k), pair.triangle_of_b(k)});
        return true;
    }, {});
    sort_pairs(pairs);
}

std::vector<NodePair> visited_nodes(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, double reach) {
    CAROM_REQUIRE(is_finite(reach) && reach >= 0.0, ErrorCode::InvalidArgument, "visited_nodes: the reach must be finite and not negative", {});
    std::vector<NodePair> out;
    WidePlacement placement;
    if (!place(a.wide(), b.wide(), b_in_a, reach, placement)) return out;
    std::vector<VisitedPair> visited;
    visit_leaf_pairs(a.wide(), b.wide(), placement, [](const LeafPair&) { return true; }, {.visited = &visited});
    const auto metres = [](const WideBvh& tree, WideRef ref, const float (&box)[2][3]) {
        const double unit = 1.0 / static_cast<double>(tree.scale);
        const auto corner = [&](int side) { return unit * dvec3{vec3{box[side][0], box[side][1], box[side][2]}}; };
        return VisitedNode{ref, is_leaf(ref), {corner(0), corner(1)}};
    };
    for (const VisitedPair& pair : visited) out.push_back({metres(a.wide(), pair.a, pair.box_a), metres(b.wide(), pair.b, pair.box_b)});
    return out;
}

}  // namespace carom
