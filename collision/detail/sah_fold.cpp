// The dynamic programme that picks wide nodes and wide leaves together, bottom up.
//
// Costs: a wide node twice its area, a wide leaf its area, whatever they hold, since all lanes are tested at once. Source: the
// recurrence of Ylitie, Karras, Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs (HPG 2017),
// section 3.2. Departure: a leaf is bounded by 16 triangles and 16 different vertices.
#include <carom/collision/detail/sah_tree.hpp>

#include <algorithm>
#include <limits>

namespace carom {
namespace {

constexpr float kNodeCost = 2.0f;
constexpr float kLeafCost = 1.0f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kWide = 16;

float half_area(const SahBox& box) {
    const float x = -box.minimum[4] - box.minimum[0];
    const float y = -box.minimum[5] - box.minimum[1];
    const float z = -box.minimum[6] - box.minimum[2];
    return x * y + y * z + z * x;
}

void add_vertex(SahFold& fold, std::uint32_t vertex) {
    if (fold.vertex_count > 16) return;
    for (std::uint32_t i = 0; i < fold.vertex_count; ++i) {
        if (fold.vertices[i] == vertex) return;
    }
    if (fold.vertex_count < 16) fold.vertices[fold.vertex_count] = vertex;
    ++fold.vertex_count;
}

}  // namespace

void fold_leaf(SahNode& node, std::span<const std::uint32_t> triangles, std::span<const Corners> corners, SahFold& fold) {
    fold.vertex_count = 0;
    for (const std::uint32_t triangle : triangles) {
        for (const std::uint32_t vertex : corners[triangle]) add_vertex(fold, vertex);
    }
    fold.limit = 1;
    fold.cost[1] = kLeafCost * half_area(node.box);
    node.whole_is_leaf = true;
}

void fold_inner(SahNode& node, const SahFold& left, const SahFold& right, SahFold& fold) {
    fold.vertex_count = 17;
    if (node.count <= 16 && left.vertex_count <= 16 && right.vertex_count <= 16) {
        fold.vertex_count = left.vertex_count;
        std::copy_n(left.vertices.begin(), left.vertex_count, fold.vertices.begin());
        for (std::uint32_t i = 0; i < right.vertex_count; ++i) add_vertex(fold, right.vertices[i]);
    }
    fold.limit = std::min(kWide, left.limit + right.limit);
    float best = kInfinity;
    for (int i = 2; i <= fold.limit; ++i) {
        int share = 0;
        for (int k = std::max(1, i - right.limit); k <= std::min(i - 1, left.limit); ++k) {
            const float cost = left.cost[static_cast<std::size_t>(k)] + right.cost[static_cast<std::size_t>(i - k)];
            if (cost < best) {
                best = cost;
                share = k;
            }
        }
        node.choice[i] = static_cast<std::uint8_t>(share);
        fold.cost[static_cast<std::size_t>(i)] = best;
    }
    const float area = half_area(node.box);
    const bool fits = fold.vertex_count <= 16;
    const float as_node = kNodeCost * area + best;
    node.whole_is_leaf = fits && kLeafCost * area <= as_node;
    const float whole = node.whole_is_leaf ? kLeafCost * area : as_node;
    fold.cost[1] = whole;
    for (int i = 2; i <= fold.limit; ++i) {
        float& cost = fold.cost[static_cast<std::size_t>(i)];
        if (whole <= cost) {
            cost = whole;
            node.choice[i] |= kWhole;
        }
    }
}

}  // namespace carom
