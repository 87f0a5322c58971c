#include <carom/collision/detail/bvh.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace carom {
namespace {

constexpr int kMostBins = 16;

/// Few bins for few triangles: most nodes are small, and summing up empty bins would take most of the build.
int bin_count(std::uint32_t triangles) noexcept { return std::min(kMostBins, 4 + static_cast<int>(triangles / 8)); }

/// The next float below `x`, finite.
float next_below(float x) noexcept {
    if (x == 0.0f) {
        return -std::numeric_limits<float>::denorm_min();
    }
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return std::bit_cast<float>(x > 0.0f ? bits - 1 : bits + 1);
}

/// The largest float that is not above `x`; -infinity where there is none.
float round_down(double x) noexcept {
    constexpr double kLargest = std::numeric_limits<float>::max();
    if (x >= kLargest) {
        return std::numeric_limits<float>::max();
    }
    if (x < -kLargest) {
        return -std::numeric_limits<float>::infinity();
    }
    const float rounded = static_cast<float>(x);
    return static_cast<double>(rounded) > x ? next_below(rounded) : rounded;
}

float round_up(double x) noexcept { return -round_down(-x); }

}  // namespace

/// The query's box in float, rounded inward: against float boxes it gives the same verdicts as the box in double.
struct Bvh::Query {
    explicit Query(const Aabb& box) noexcept
        : lower{round_up(box.lower.x), round_up(box.lower.y), round_up(box.lower.z)},
          upper{round_down(box.upper.x), round_down(box.upper.y), round_down(box.upper.z)} {}

    template <class Boxed>
    [[nodiscard]] bool overlaps(const Boxed& b) const noexcept {
        // Bitwise: six comparisons cost less than the branches they would save.
        return (b.lower.x <= upper.x) & (lower.x <= b.upper.x) & (b.lower.y <= upper.y) & (lower.y <= b.upper.y) &
               (b.lower.z <= upper.z) & (lower.z <= b.upper.z);
    }

    vec3 lower{0.0f};
    vec3 upper{0.0f};
};

/// Where to cut a node: bins 0..last go left. `axis` < 0 where no cut separates anything.
struct Bvh::Split {
    int axis = -1;
    int last = 0;
    double cost = std::numeric_limits<double>::infinity();
};

namespace {

/// Twice the centre would overflow for the largest floats, so the halves are added.
template <class Boxed>
vec3 center(const Boxed& b) noexcept {
    return 0.5f * b.lower + 0.5f * b.upper;
}

/// Maps centres on one axis to bins.
struct Binning {
    Binning(float lower, float upper, int count) noexcept
        : origin(static_cast<double>(lower)),
          scale(count / (static_cast<double>(upper) - static_cast<double>(lower))),
          last(count - 1) {}
    [[nodiscard]] int bin(float x) const noexcept {
        return std::min(static_cast<int>((static_cast<double>(x) - origin) * scale), last);
    }
    double origin;
    double scale;
    int last;
};

}  // namespace

void Bvh::Bounds::grow(const Bounds& b) noexcept {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
}

double Bvh::Bounds::half_area() const noexcept {
    const dvec3 e = dvec3(upper) - dvec3(lower);
    return e.x * e.y + e.y * e.z + e.z * e.x;
}

Bvh::Bvh(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    items_.reserve(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const vec3& a = vertices[triangles[i][0]];
        const vec3& b = vertices[triangles[i][1]];
        const vec3& c = vertices[triangles[i][2]];
        items_.push_back({glm::min(a, glm::min(b, c)), static_cast<std::uint32_t>(i), glm::max(a, glm::max(b, c))});
    }
    nodes_.reserve(triangles.size());
    build(0, static_cast<std::uint32_t>(items_.size()), 0);
    nodes_.shrink_to_fit();
}

void Bvh::build(std::uint32_t first, std::uint32_t count, int depth) {
    Bounds box;
    Bounds centers;
    for (std::uint32_t i = first; i < first + count; ++i) {
        box.grow({items_[i].lower, items_[i].upper});
        const vec3 c = center(items_[i]);
        centers.grow({c, c});
    }
    const std::size_t self = nodes_.size();
    nodes_.push_back({box.lower, static_cast<std::uint32_t>(self + 1), box.upper, first * 8 + count});
    if (count <= kLeafSize) {
        return;
    }
    const Split split = depth < kSahDepth ? best_split(first, count, centers) : Split{};
    const std::uint32_t left = split.axis < 0 ? count / 2 : partition(first, count, centers, split);
    nodes_[self].leaf = 0;
    build(first, left, depth + 1);
    build(first + left, count - left, depth + 1);
    nodes_[self].skip = static_cast<std::uint32_t>(nodes_.size());
}

Bvh::Split Bvh::best_split(std::uint32_t first, std::uint32_t count, const Bounds& centers) const {
    struct Bin {
        Bounds box;
        std::uint32_t count = 0;
    };
    const auto bin_total = static_cast<std::size_t>(bin_count(count));
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(centers.lower[axis] < centers.upper[axis])) {
            continue;
        }
        const Binning binning(centers.lower[axis], centers.upper[axis], static_cast<int>(bin_total));
        std::array<Bin, kMostBins> bins;
        for (std::uint32_t i = first; i < first + count; ++i) {
            Bin& bin = bins[static_cast<std::size_t>(binning.bin(center(items_[i])[axis]))];
            bin.box.grow({items_[i].lower, items_[i].upper});
            ++bin.count;
        }
        std::array<double, kMostBins> right_cost{};  // of bins i.. up to the last
        Bin right;
        for (std::size_t i = bin_total; i-- > 1;) {
            right.box.grow(bins[i].box);
            right.count += bins[i].count;
            right_cost[i] = right.count == 0 ? 0.0 : right.count * right.box.half_area();
        }
        Bin left;
        for (std::size_t i = 0; i + 1 < bin_total; ++i) {
            left.box.grow(bins[i].box);
            left.count += bins[i].count;
            if (left.count == 0 || left.count == count) {
                continue;
            }
            const double cost = left.count * left.box.half_area() + right_cost[i + 1];
            if (cost < best.cost) {
                best = {axis, static_cast<int>(i), cost};
            }
        }
    }
    return best;
}

std::uint32_t Bvh::partition(std::uint32_t first, std::uint32_t count, const Bounds& centers, const Split& split) {
    const Binning binning(centers.lower[split.axis], centers.upper[split.axis], bin_count(count));
    std::uint32_t begin = first;
    std::uint32_t end = first + count;
    while (begin < end) {
        if (binning.bin(center(items_[begin])[split.axis]) <= split.last) {
            ++begin;
        } else {
            std::swap(items_[begin], items_[--end]);
        }
    }
    return begin - first;
}

void Bvh::overlap(const Aabb& box, FunctionRef<bool(std::uint32_t)> visit) const {
    if (is_empty(box)) {  // NaN too
        return;
    }
    const Query query(box);
    const Node* const nodes = nodes_.data();
    const auto end = static_cast<std::uint32_t>(nodes_.size());
    for (std::uint32_t i = 0; i < end;) {
        const Node& node = nodes[i];
        if (!query.overlaps(node)) {
            i = node.skip;
            continue;
        }
        for (std::uint32_t k = node.first(); k < node.first() + node.count(); ++k) {
            if (query.overlaps(items_[k]) && !visit(items_[k].triangle)) {
                return;
            }
        }
        ++i;
    }
}

void Bvh::visit_nodes(FunctionRef<void(const Aabb&, int)> visit) const {
    std::array<std::uint32_t, kMaxDepth + 1> ends{};  // of the subtrees that hold the current node
    int depth = 0;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        while (depth > 0 && ends[static_cast<std::size_t>(depth - 1)] <= i) {
            --depth;
        }
        visit({dvec3(nodes_[i].lower), dvec3(nodes_[i].upper)}, depth);
        if (nodes_[i].count() == 0) {
            ends[static_cast<std::size_t>(depth++)] = nodes_[i].skip;
        }
    }
}

}  // namespace carom
