#include <carom/collision/detail/triangles_meet.hpp>
#include <carom/collision/detail/wide_pairs.hpp>
#include <carom/collision/mesh_pairs.hpp>

#include <algorithm>
#include <array>
#include <bit>

namespace carom {
namespace {

/// The corners of the triangles of two leaves that are looked at, each placed once.
class PlacedLeaves {
public:
    PlacedLeaves(const LeafPair& pair, const WidePlacement& placement) : pair_(pair), placement_(placement) {}

    [[nodiscard]] bool meet(std::size_t i, std::size_t j) {
        const WideLeaf& a = pair_.a;
        detail::TriangleCorners first, second;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = a.corner[k][i];
            first[k] = dvec3{a.vertex[0][v], a.vertex[1][v], a.vertex[2][v]};
            second[k] = placed(pair_.b.corner[k][j]);
        }
        return detail::triangles_meet(first, second);
    }

private:
    const dvec3& placed(std::size_t v) {
        if ((done_ >> v & 1u) == 0) {
            done_ |= 1u << v;
            points_[v] = placement_.place(pair_.b.vertex[0][v], pair_.b.vertex[1][v], pair_.b.vertex[2][v]);
        }
        return points_[v];
    }

    const LeafPair& pair_;
    const WidePlacement& placement_;
    std::uint32_t done_ = 0;
    std::array<dvec3, kWidth> points_;
};

/// Calls `met(a, b)` for each pair of triangles that meet, until it returns false.
template <class Met>
void for_each_pair(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, Met met) {
    WidePlacement placement;
    if (!place(a.wide(), b.wide(), b_in_a, placement)) return;
    visit_leaf_pairs(a.wide(), b.wide(), placement, [&](const LeafPair& pair) {
        PlacedLeaves leaves(pair, placement);
        for (std::size_t j = 0; j < pair.b.triangle_count; ++j) {
            for (std::uint32_t rest = pair.partners[j]; rest != 0; rest &= rest - 1) {
                const auto i = static_cast<std::size_t>(std::countr_zero(rest));
                if (leaves.meet(i, j) && !met(TrianglePair{pair.a.triangle[i], pair.b.triangle[j]})) return false;
            }
        }
        return true;
    });
}

}  // namespace

std::optional<TrianglePair> find_overlap(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a) {
    std::optional<TrianglePair> found;
    for_each_pair(a, b, b_in_a, [&](const TrianglePair& pair) {
        found = pair;
        return false;
    });
    return found;
}

bool meshes_overlap(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a) { return find_overlap(a, b, b_in_a).has_value(); }

void overlapping_pairs(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, std::vector<TrianglePair>& pairs) {
    pairs.clear();
    for_each_pair(a, b, b_in_a, [&](const TrianglePair& pair) {
        pairs.push_back(pair);
        return true;
    });
    std::stable_sort(pairs.begin(), pairs.end());
}

}  // namespace carom
