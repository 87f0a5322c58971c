#include <carom/collision/detail/wide_refit.hpp>

#include <carom/collision/detail/weld.hpp>
#include <carom/collision/detail/wide_check.hpp>
#include <carom/collision/detail/wide_crowding.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace carom {
namespace {

using Corners = std::array<std::uint32_t, 3>;

double weight_of(const WideBox& box) noexcept {
    const dvec3 d = dvec3(box.upper) - dvec3(box.lower);
    const double area = d.x * d.y + d.y * d.z + d.z * d.x;
    return area > 0.0 ? area : 1.0;
}

/// Gives each vertex of a leaf its new position. @return false where two positions are asked of one.
bool move_vertices(WideLeaf& leaf, float scale, std::span<const vec3> vertices, std::span<const Corners> triangles) {
    std::array<bool, kWidth> placed{};
    for (std::uint32_t k = 0; k < leaf.triangle_count; ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t slot = leaf.corner[c][k];
            const vec3 v = scale * vertices[triangles[leaf.triangle[k]][c]];
            for (int axis = 0; axis < 3; ++axis) {
                float& to = leaf.vertex[axis][slot];
                if (placed[slot] && to != v[axis]) return false;
                to = v[axis];
            }
            placed[slot] = true;
        }
    }
    for (std::size_t k = leaf.vertex_count; k < kWidth; ++k) {
        for (auto& axis : leaf.vertex) axis[k] = axis[0];
    }
    return true;
}

/// The positions of all leaves' vertices.
std::vector<vec3> positions_of(const WideBvh& tree, std::span<const WideRef> refs) {
    std::vector<vec3> positions;
    for (const WideRef ref : refs) {
        if (!is_leaf(ref)) continue;
        const WideLeaf& leaf = tree.leaf(ref);
        for (std::uint32_t k = 0; k < leaf.vertex_count; ++k) positions.push_back({leaf.vertex[0][k], leaf.vertex[1][k], leaf.vertex[2][k]});
    }
    return positions;
}

/// @return whether vertices that were at one position still are.
bool stay_together(const WideBvh& before, const WideBvh& after, std::span<const WideRef> refs) {
    const std::vector<std::uint32_t> first = first_at_position(positions_of(before, refs));
    const std::vector<vec3> moved = positions_of(after, refs);
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (moved[i] != moved[first[i]]) return false;
    }
    return true;
}

}  // namespace

float wide_scale_for(float largest) noexcept {
    if (largest == 0.0f || (largest >= 0x1p-20f && largest <= 0x1p20f)) return 1.0f;
    int exponent = 0;
    static_cast<void>(std::frexp(largest, &exponent));
    return std::ldexp(1.0f, std::clamp(-exponent, -120, 120));
}

bool scales_without_loss(std::span<const vec3> vertices, float scale) noexcept {
    if (scale >= 1.0f) return true;
    const float back = 1.0f / scale;
    return std::all_of(vertices.begin(), vertices.end(), [&](const vec3& v) { return back * (scale * v) == v; });
}

Status refit_wide_bvh(WideBvh& tree, std::span<const vec3> vertices, std::span<const Corners> triangles) {
    constexpr const char* kWhere = "StaticBvh::refit";
    const Error apart{ErrorCode::WrongType, "vertices that were at one position have moved apart: build the hierarchy anew", kWhere};
    float largest = 0.0f;
    for (const vec3& v : vertices) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (wide_scale_for(largest) != tree.scale) {
        return Error{ErrorCode::WrongType, "the mesh left the range of sizes that the hierarchy was built for: build it anew", kWhere};
    }
    WideBvh moved = tree;
    std::vector<WideBox> boxes(moved.lines.size());
    const std::vector<WideRef> refs = all_refs(moved);
    double cost = 0.0;
    for (std::size_t i = refs.size(); i-- > 0;) {
        const WideRef ref = refs[i];
        WideBox& box = boxes[start_of(ref)];
        if (is_leaf(ref)) {
            WideLeaf& leaf = moved.leaf(ref);
            if (!move_vertices(leaf, moved.scale, vertices, triangles)) return apart;
            box = box_of(leaf);
        } else {
            WideNode& node = moved.node(ref);
            for (int k = 0; k < child_count(node); ++k) {
                const WideBox& child = boxes[start_of(node.child[k])];
                for (int axis = 0; axis < 3; ++axis) {
                    node.bound[0][axis][k] = child.lower[axis];
                    node.bound[1][axis][k] = child.upper[axis];
                }
                box.add(child);
            }
        }
        if (i > 0) cost += weight_of(box) * (is_leaf(ref) ? 1.0 : 2.0);
    }
    if (tree.welded && !stay_together(tree, moved, refs)) return apart;
    moved.lower = boxes[0].lower;
    moved.upper = boxes[0].upper;
    moved.lossless = scales_without_loss(vertices, moved.scale);
    moved.update_far_reach();
    moved.sah_cost = cost / weight_of(boxes[0]);
    moved.crowding = crowding_of(moved, refs);
    tree = std::move(moved);
    return {};
}

}  // namespace carom
