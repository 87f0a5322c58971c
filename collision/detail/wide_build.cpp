#include <carom/collision/detail/wide_build.hpp>

#include <carom/collision/detail/sah_tree.hpp>
#include <carom/collision/detail/weld.hpp>
#include <carom/collision/detail/wide_check.hpp>
#include <carom/collision/detail/wide_crowding.hpp>
#include <carom/collision/detail/wide_refit.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

/// Writes nodes and leaves of the folded tree.
class Folding {
public:
    Folding(WideBvh& out, const SahTree& tree, std::span<const vec3> vertices, std::span<const Corners> corners)
        : out_(out), tree_(tree), vertices_(vertices), corners_(corners) {}

    void run() {
        const Children top = root_children();
        const std::size_t lines = lines_of(top);
        out_.lines.resize(lines);
        emit_node(top);
        out_.sah_cost = cost_ / double_half_area(tree_.nodes[0].box);
    }

private:
    static constexpr std::size_t kNodeLines = sizeof(WideNode) / sizeof(WideBvh::Line);
    static constexpr std::size_t kLeafLines = sizeof(WideLeaf) / sizeof(WideBvh::Line);

    struct Children {
        std::array<std::uint32_t, kWidth> node{};  // of the binary tree
        int count = 0;
    };

    static double double_half_area(const SahBox& box) {
        const double x = -static_cast<double>(box.minimum[4]) - static_cast<double>(box.minimum[0]);
        const double y = -static_cast<double>(box.minimum[5]) - static_cast<double>(box.minimum[1]);
        const double z = -static_cast<double>(box.minimum[6]) - static_cast<double>(box.minimum[2]);
        const double area = x * y + y * z + z * x;
        return area > 0.0 ? area : 1.0;
    }

    void expand(std::uint32_t index, int budget, bool whole_allowed, Children& children) const {
        const SahNode& node = tree_.nodes[index];
        if (node.skip == 0) budget = 1;
        while (budget > 1) {
            const std::uint8_t choice = node.choice[budget];
            if (whole_allowed && (choice & kWhole) != 0) break;
            if (const int share = choice & ~kWhole; share != 0) {
                expand(index + 1, share, true, children);
                expand(index + node.skip, budget - share, true, children);
                return;
            }
            --budget;
        }
        children.node[static_cast<std::size_t>(children.count++)] = index;
    }

    Children root_children() const {
        Children children;
        if (tree_.nodes[0].whole_is_leaf) {
            children.node[0] = 0;
            children.count = 1;
            return children;
        }
        return children_of(0);
    }

    Children children_of(std::uint32_t index) const {
        Children children;
        const SahNode& node = tree_.nodes[index];
        // Choices beyond the number of binary leaves below are not set; they read zero and lead down to those that are.
        expand(index, kWidth, false, children);
        static_cast<void>(node);
        return children;
    }

    std::size_t lines_of(const Children& children) {
        std::size_t lines = kNodeLines;
        for (int i = 0; i < children.count; ++i) {
            const std::uint32_t index = children.node[static_cast<std::size_t>(i)];
            lines += tree_.nodes[index].whole_is_leaf ? kLeafLines : lines_of(children_of(index));
        }
        return lines;
    }

    WideRef emit_node(const Children& children) {
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        const auto ref = static_cast<WideRef>(next_);
        next_ += kNodeLines;
        ++out_.node_count;
        for (std::size_t i = 0; i < kWidth; ++i) {
            const bool used = static_cast<int>(i) < children.count;
            WideNode& node = out_.node(ref);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const SahBox* box = used ? &tree_.nodes[children.node[i]].box : nullptr;
                node.bound[0][axis][i] = used ? box->minimum[axis] : kInfinity;
                node.bound[1][axis][i] = used ? -box->minimum[4 + axis] : -kInfinity;
            }
            node.child[i] = 0;
        }
        // Leaves first, next to their node.
        for (std::size_t i = 0; i < static_cast<std::size_t>(children.count); ++i) {
            const std::uint32_t index = children.node[i];
            cost_ += double_half_area(tree_.nodes[index].box) * (tree_.nodes[index].whole_is_leaf ? 1.0 : 2.0);
            if (tree_.nodes[index].whole_is_leaf) out_.node(ref).child[i] = emit_leaf(index);
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(children.count); ++i) {
            const std::uint32_t index = children.node[i];
            if (!tree_.nodes[index].whole_is_leaf) out_.node(ref).child[i] = emit_node(children_of(index));
        }
        return ref;
    }

    WideRef emit_leaf(std::uint32_t index) {
        const auto ref = ~static_cast<WideRef>(next_);
        next_ += kLeafLines;
        ++out_.leaf_count;
        WideLeaf& leaf = out_.leaf(ref);
        const SahNode& node = tree_.nodes[index];
        std::array<std::uint32_t, kWidth> sorted{};
        const std::uint32_t count = node.count;
        for (std::uint32_t k = 0; k < count; ++k) {  // insertion: at most 16
            const std::uint32_t triangle = tree_.order[node.first + k];
            std::uint32_t place = k;
            for (; place > 0 && sorted[place - 1] > triangle; --place) sorted[place] = sorted[place - 1];
            sorted[place] = triangle;
        }
        std::array<std::uint32_t, kWidth> used{};
        std::uint32_t used_count = 0;
        for (std::uint32_t k = 0; k < count; ++k) {
            leaf.triangle[k] = sorted[k];
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t vertex = corners_[sorted[k]][c];
                std::uint32_t place = 0;
                while (place < used_count && used[place] != vertex) ++place;
                if (place == used_count) used[used_count++] = vertex;
                leaf.corner[c][k] = static_cast<std::uint8_t>(place);
            }
        }
        for (std::size_t k = count; k < kWidth; ++k) {
            leaf.triangle[k] = kNoTriangle;
            for (std::size_t c = 0; c < 3; ++c) leaf.corner[c][k] = 0;
        }
        for (std::size_t k = 0; k < kWidth; ++k) {
            const vec3 v = out_.scale * vertices_[used[k < used_count ? k : 0]];
            for (int axis = 0; axis < 3; ++axis) leaf.vertex[axis][k] = v[axis];
        }
        leaf.triangle_count = count;
        leaf.vertex_count = used_count;
        leaf.reserved[0] = leaf.reserved[1] = 0;
        return ref;
    }

    WideBvh& out_;
    const SahTree& tree_;
    std::span<const vec3> vertices_;
    std::span<const Corners> corners_;
    std::size_t next_ = 0;
    double cost_ = 0.0;
};

}  // namespace

WideBvh build_wide_bvh(std::span<const vec3> vertices, std::span<const Corners> triangles, Executor& executor) {
    WideBvh out;
    out.triangle_count = triangles.size();
    const std::vector<std::uint32_t> welded = first_at_position(vertices);
    float largest = 0.0f;
    for (const vec3& v : vertices) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    out.scale = wide_scale_for(largest);

    out.lossless = scales_without_loss(vertices, out.scale);
    out.welded = std::any_of(triangles.begin(), triangles.end(), [&](const Corners& t) {
        return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return welded[v] != v; });
    });

    HugePageVector<SahItem> items(triangles.size());
    HugePageVector<Corners> corners(triangles.size());
    executor.parallel_for(triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Corners& t = triangles[i];
            const vec3 a = out.scale * vertices[t[0]];
            const vec3 b = out.scale * vertices[t[1]];
            const vec3 c = out.scale * vertices[t[2]];
            const vec3 lower = glm::min(a, glm::min(b, c));
            const vec3 upper = glm::max(a, glm::max(b, c));
            corners[i] = {welded[t[0]], welded[t[1]], welded[t[2]]};
            items[i] = {{lower.x, lower.y, lower.z}, static_cast<std::uint32_t>(i) | SahItem::kTag, {-upper.x, -upper.y, -upper.z}, 0.0f};
        }
    });
    const SahTree tree = build_sah_tree(std::move(items), corners, executor);
    const SahBox& box = tree.nodes[0].box;
    out.lower = {box.minimum[0], box.minimum[1], box.minimum[2]};
    out.upper = {-box.minimum[4], -box.minimum[5], -box.minimum[6]};
    out.update_far_reach();
    Folding(out, tree, vertices, corners).run();
    out.crowding = out.built_crowding = crowding_of(out, all_refs(out));
    return out;
}

}  // namespace carom
