#include <carom/collision/detail/wide_check.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace carom {
namespace {

constexpr std::size_t kNodeLines = sizeof(WideNode) / sizeof(WideBvh::Line);
constexpr std::size_t kLeafLines = sizeof(WideLeaf) / sizeof(WideBvh::Line);

class Check {
public:
    explicit Check(const WideBvh& tree) : tree_(tree), taken_(tree.lines.size()), seen_(tree.triangle_count) {}

    Status run() {
        if (Status status = header(); !status) return status;
        std::vector<Waiting> stack{{WideBvh::root(), 0}};
        while (!stack.empty()) {
            const Waiting next = stack.back();
            stack.pop_back();
            if (Status status = take(next); !status) return status;
            if (is_leaf(next.ref)) {
                if (const char* what = fault_of(tree_.leaf(next.ref))) return at(next.ref, what);
            } else {
                if (const char* what = fault_of(tree_.node(next.ref))) return at(next.ref, what);
                if (Status status = push_children(next, stack); !status) return status;
            }
        }
        if (nodes_ != tree_.node_count || leaves_ != tree_.leaf_count) return fault("the counts of nodes and leaves are wrong");
        if (lines_ != tree_.lines.size()) return fault("some lines belong to nothing");
        if (triangles_ != tree_.triangle_count) return fault("some triangles are in no leaf");
        return boxes();
    }

private:
    struct Waiting {
        WideRef ref;
        int depth;
    };

    static Error fault(const std::string& what) { return {ErrorCode::Parse, what, "StaticBvh::load"}; }
    static Error at(WideRef ref, const char* what) { return fault("line " + std::to_string(start_of(ref)) + ": " + what); }
    Status header() const {
        if (tree_.lines.size() < kNodeLines + kLeafLines) return fault("there is no root");
        int exponent = 0;
        const bool power_of_two = tree_.scale > 0.0f && is_finite(tree_.scale) && std::frexp(tree_.scale, &exponent) == 0.5f;
        if (!power_of_two || exponent < -120 || exponent > 122) return fault("the scale is no power of two that a tree has");
        if (tree_.triangle_count == 0 || tree_.triangle_count > WideBvh::kMaxTriangles) return fault("the count of triangles is out of range");
        return {};
    }

    // Claims the lines of a node or leaf, which nobody may have claimed.
    Status take(const Waiting& next) {
        const std::size_t start = start_of(next.ref), count = is_leaf(next.ref) ? kLeafLines : kNodeLines;
        if (next.depth > WideBvh::kMaxDepth) return at(next.ref, "deeper than a tree may be");
        for (std::size_t line = start; line < start + count; ++line) {
            if (taken_[line]) return at(next.ref, "used twice");
            taken_[line] = true;
        }
        lines_ += count;
        ++(is_leaf(next.ref) ? leaves_ : nodes_);
        return {};
    }

    Status push_children(const Waiting& parent, std::vector<Waiting>& stack) const {
        const WideNode& node = tree_.node(parent.ref);
        for (int k = 0; k < child_count(node); ++k) {
            const WideRef child = node.child[k];
            const std::size_t start = start_of(child), count = is_leaf(child) ? kLeafLines : kNodeLines;
            if (start <= start_of(parent.ref)) return at(parent.ref, "a child stands before its parent");
            if (start > tree_.lines.size() || tree_.lines.size() - start < count) return at(parent.ref, "a child lies beyond the end");
            stack.push_back({child, parent.depth + 1});
        }
        return {};
    }

    static const char* fault_of(const WideNode& node) noexcept {
        const int count = child_count(node);
        if (count == 0) return "a node without children";
        for (int k = 0; k < kWidth; ++k) {
            for (int axis = 0; axis < 3; ++axis) {
                const float lower = node.bound[0][axis][k], upper = node.bound[1][axis][k];
                const bool fits = k < count ? is_finite(lower) && is_finite(upper) && lower <= upper
                                            : lower == std::numeric_limits<float>::infinity() && upper == -lower;
                if (!fits) return "a box that is none";
            }
            if (k >= count && node.child[k] != 0) return "a child without a box";
        }
        return nullptr;
    }

    const char* fault_of(const WideLeaf& leaf) {
        const std::uint32_t count = leaf.triangle_count, vertices = leaf.vertex_count;
        if (count < 1 || count > kWidth || vertices < 1 || vertices > kWidth) return "a count that no leaf has";
        if (leaf.reserved[0] != 0 || leaf.reserved[1] != 0) return "something where nothing belongs";
        for (std::uint32_t k = 0; k < kWidth; ++k) {
            for (const auto& axis : leaf.vertex) {
                if (!is_finite(axis[k]) || (k >= vertices && axis[k] != axis[0])) return "a vertex that is none";
            }
            for (const auto& corner : leaf.corner) {
                if (corner[k] >= vertices || (k >= count && corner[k] != 0)) return "a corner without a vertex";
            }
            const std::uint32_t triangle = leaf.triangle[k];
            if (k >= count) {
                if (triangle != kNoTriangle) return "a triangle beyond the last";
                continue;
            }
            if (triangle >= tree_.triangle_count || seen_[triangle]) return "a triangle that is none, or twice";
            if (k > 0 && triangle <= leaf.triangle[k - 1]) return "triangles out of order";
            seen_[triangle] = true;
            ++triangles_;
        }
        return nullptr;
    }

    Status boxes() const {
        std::vector<WideBox> found(tree_.lines.size());
        const std::vector<WideRef> refs = all_refs(tree_);
        for (std::size_t i = refs.size(); i-- > 0;) {
            const WideRef ref = refs[i];
            if (is_leaf(ref)) {
                found[start_of(ref)] = box_of(tree_.leaf(ref));
                continue;
            }
            const WideNode& node = tree_.node(ref);
            for (int k = 0; k < child_count(node); ++k) {
                const WideBox& child = found[start_of(node.child[k])];
                const WideBox written{{node.bound[0][0][k], node.bound[0][1][k], node.bound[0][2][k]},
                                      {node.bound[1][0][k], node.bound[1][1][k], node.bound[1][2][k]}};
                if (written != child) return at(ref, "a box that is not the box of what it holds");
                found[start_of(ref)].add(child);
            }
        }
        if (found[0] != WideBox{tree_.lower, tree_.upper}) return fault("the whole box is not the root's");
        return {};
    }

    const WideBvh& tree_;
    std::vector<bool> taken_, seen_;
    std::size_t lines_ = 0, nodes_ = 0, leaves_ = 0, triangles_ = 0;
};

}  // namespace

WideBox box_of(const WideLeaf& leaf) noexcept {
    WideBox box;
    for (std::uint32_t k = 0; k < leaf.triangle_count; ++k) {
        for (const auto& corner : leaf.corner) {
            const vec3 v{leaf.vertex[0][corner[k]], leaf.vertex[1][corner[k]], leaf.vertex[2][corner[k]]};
            box.add({v, v});
        }
    }
    return box;
}

std::vector<WideRef> all_refs(const WideBvh& tree) {
    std::vector<WideRef> refs{WideBvh::root()};
    refs.reserve(tree.node_count + tree.leaf_count);
    for (std::size_t i = 0; i < refs.size(); ++i) {
        if (is_leaf(refs[i])) continue;
        const WideNode& node = tree.node(refs[i]);
        refs.insert(refs.end(), node.child, node.child + child_count(node));
    }
    return refs;
}

Status check_wide_bvh(const WideBvh& tree) { return Check(tree).run(); }

}  // namespace carom
