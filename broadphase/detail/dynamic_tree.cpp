// How the tree of boxes is built, and how it stays good as leaves come and go.
#include <carom/broadphase/detail/dynamic_tree.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

namespace carom::detail {
namespace {

constexpr int kBins = 8;
constexpr std::uint32_t kFewLeaves = 4;  // split in the middle

FloatAabb merge(const FloatAabb& a, const FloatAabb& b) noexcept { return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)}; }

// Half the surface; in double, where no two floats overflow.
double area(const FloatAabb& box) noexcept {
    const dvec3 edge = dvec3(box.upper) - dvec3(box.lower);
    return edge.x * edge.y + edge.y * edge.z + edge.z * edge.x;
}

}  // namespace

void DynamicTree::fit(std::uint32_t node) noexcept {
    nodes_[node].box = merge(nodes_[nodes_[node].child[0]].box, nodes_[nodes_[node].child[1]].box);
}

std::uint32_t DynamicTree::make_node() {
    if (free_.empty()) {
        nodes_.emplace_back();
        return static_cast<std::uint32_t>(nodes_.size() - 1);
    }
    const std::uint32_t node = free_.back();
    free_.pop_back();
    nodes_[node] = {};
    return node;
}

// Where the range is cut in two; its slots are then in the order of the halves.
std::uint32_t DynamicTree::split(const ProxyTable& table, const Range& range) {
    const std::uint32_t middle = range.first + (range.last - range.first) / 2;
    if (range.last - range.first <= kFewLeaves) return middle;
    dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
    const auto centre = [&](std::uint32_t slot) { return dvec3(table.boxes[slot].lower) + dvec3(table.boxes[slot].upper); };
    for (std::uint32_t i = range.first; i < range.last; ++i) {
        low = glm::min(low, centre(order_[i]));
        high = glm::max(high, centre(order_[i]));
    }
    const dvec3 extent = high - low;
    const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    if (!(extent[axis] > 0.0)) return middle;
    const double per_metre = kBins / extent[axis];
    const auto bin_of = [&](std::uint32_t slot) {
        return std::min(static_cast<int>((centre(slot)[axis] - low[axis]) * per_metre), kBins - 1);
    };
    std::array<FloatAabb, kBins> box;
    box.fill(kNowhere);
    std::array<std::uint32_t, kBins> count{};
    for (std::uint32_t i = range.first; i < range.last; ++i) {
        const auto bin = static_cast<std::size_t>(bin_of(order_[i]));
        box[bin] = merge(box[bin], table.boxes[order_[i]]);
        ++count[bin];
    }
    std::array<double, kBins> below{};  // cost of the bins before a cut
    FloatAabb sum = kNowhere;
    std::uint32_t counted = 0;
    for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
        sum = merge(sum, box[bin]);
        counted += count[bin];
        below[bin + 1] = counted == 0 ? 0.0 : counted * area(sum);
    }
    sum = kNowhere;
    counted = 0;
    int best = kBins / 2;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t cut = kBins - 1; cut > 0; --cut) {
        sum = merge(sum, box[cut]);
        counted += count[cut];
        if (counted == 0 || counted == range.last - range.first) continue;
        const double cost = below[cut] + counted * area(sum);
        if (cost < least) {
            least = cost;
            best = static_cast<int>(cut);
        }
    }
    std::uint32_t left = range.first, right = range.last;
    while (left < right) {
        if (bin_of(order_[left]) < best)
            ++left;
        else
            std::swap(order_[left], order_[--right]);
    }
    return left == range.first || left == range.last ? middle : left;
}

void DynamicTree::build(const ProxyTable& table) {
    const std::size_t slots = table.boxes.size();
    leaf_.assign(slots, kNone);
    moved_.assign(slots, 0);
    nodes_.clear();
    free_.clear();
    order_.clear();
    for (std::size_t slot = 0; slot < slots; ++slot) {
        if (table.alive[slot] != 0) order_.push_back(static_cast<std::uint32_t>(slot));
    }
    root_ = kNone;
    if (order_.empty()) return;
    nodes_.reserve(2 * order_.size());
    root_ = make_node();
    ranges_.assign(1, {root_, 0, static_cast<std::uint32_t>(order_.size())});
    while (!ranges_.empty()) {
        const Range range = ranges_.back();
        ranges_.pop_back();
        if (range.last - range.first == 1) {
            const std::uint32_t slot = order_[range.first];
            nodes_[range.node].box = table.boxes[slot];
            nodes_[range.node].child[1] = slot;
            leaf_[slot] = range.node;
            continue;
        }
        const std::uint32_t cut = split(table, range);
        for (int side = 0; side < 2; ++side) {
            const std::uint32_t child = make_node();
            nodes_[child].parent = range.node;
            nodes_[range.node].child[side] = child;
        }
        ranges_.push_back({nodes_[range.node].child[1], cut, range.last});
        ranges_.push_back({nodes_[range.node].child[0], range.first, cut});
    }
    for (std::size_t node = nodes_.size(); node-- > 0;) {  // children come after their parents
        if (!nodes_[node].is_leaf()) fit(static_cast<std::uint32_t>(node));
    }
}

// Down to where the leaf costs least: each step compares a new parent here with going on to either child.
std::uint32_t DynamicTree::best_sibling(std::uint32_t leaf) const noexcept {
    const FloatAabb& box = nodes_[leaf].box;
    std::uint32_t node = root_;
    std::uint32_t turns = nodes_[leaf].slot() * 0x9e3779b1u;  // decides between equals, so that coincident boxes make no chain
    while (!nodes_[node].is_leaf()) {
        const Node& n = nodes_[node];
        const double joined = area(merge(n.box, box));
        const double here = 2.0 * joined, inherited = 2.0 * (joined - area(n.box));
        double cost[2];
        for (int side = 0; side < 2; ++side) {
            const Node& child = nodes_[n.child[side]];
            cost[side] = area(merge(child.box, box)) - (child.is_leaf() ? 0.0 : area(child.box)) + inherited;
        }
        if (here < cost[0] && here < cost[1]) break;
        turns = std::rotl(turns, 1);
        const int side = cost[0] == cost[1] ? static_cast<int>(turns & 1u) : (cost[0] < cost[1] ? 0 : 1);
        node = n.child[side];
    }
    return node;
}

void DynamicTree::insert(std::uint32_t leaf) {
    nodes_[leaf].parent = kNone;
    if (root_ == kNone) {
        root_ = leaf;
        return;
    }
    const std::uint32_t sibling = best_sibling(leaf), above = nodes_[sibling].parent;
    const std::uint32_t joint = make_node();
    nodes_[joint].parent = above;
    nodes_[joint].child[0] = sibling;
    nodes_[joint].child[1] = leaf;
    nodes_[sibling].parent = nodes_[leaf].parent = joint;
    if (above == kNone)
        root_ = joint;
    else
        nodes_[above].child[nodes_[above].child[1] == sibling] = joint;
    refit_upward(joint);
}

void DynamicTree::remove(std::uint32_t leaf) {
    const std::uint32_t joint = nodes_[leaf].parent;
    if (joint == kNone) {
        root_ = kNone;
        return;
    }
    const std::uint32_t sibling = nodes_[joint].child[nodes_[joint].child[0] == leaf], above = nodes_[joint].parent;
    nodes_[sibling].parent = above;
    if (above == kNone)
        root_ = sibling;
    else
        nodes_[above].child[nodes_[above].child[1] == joint] = sibling;
    free_.push_back(joint);
    if (above != kNone) refit_upward(above);
}

void DynamicTree::refit_upward(std::uint32_t node) noexcept {
    for (; node != kNone; node = nodes_[node].parent) {
        fit(node);
        rotate(node);
    }
}

// A child of `node` and a grandchild on the other side change places.
void DynamicTree::exchange(std::uint32_t node, int side, std::uint32_t lower_node, int lower_side) noexcept {
    std::swap(nodes_[node].child[side], nodes_[lower_node].child[lower_side]);
    nodes_[nodes_[node].child[side]].parent = node;
    nodes_[nodes_[lower_node].child[lower_side]].parent = lower_node;
    fit(lower_node);
}

void DynamicTree::rotate(std::uint32_t node) noexcept {
    double best = 0.0;
    int best_side = -1, best_lower = 0;
    for (int side = 0; side < 2; ++side) {
        const std::uint32_t child = nodes_[node].child[side], other = nodes_[node].child[1 - side];
        if (nodes_[other].is_leaf()) continue;
        const double now = area(nodes_[other].box);
        for (int lower = 0; lower < 2; ++lower) {  // `child` for this grandchild: `other` is then around child and the one that stays
            const double then = area(merge(nodes_[child].box, nodes_[nodes_[other].child[1 - lower]].box));
            if (now - then > best) {
                best = now - then;
                best_side = side;
                best_lower = lower;
            }
        }
    }
    if (best_side >= 0) exchange(node, best_side, nodes_[node].child[1 - best_side], best_lower);
}

}  // namespace carom::detail
