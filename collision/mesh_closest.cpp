#include <carom/collision/mesh_closest.hpp>

#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/closest_points.hpp>
#include <carom/collision/detail/wide_pairs.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace carom {
namespace {

using Triangle = geo::Triangle<double>;

/// A triangle with its box.
struct Boxed {
    Triangle triangle;
    dvec3 lower{0.0}, upper{0.0};

    explicit Boxed(const Triangle& t) noexcept
        : triangle(t), lower(glm::min(glm::min(t.a, t.b), t.c)), upper(glm::max(glm::max(t.a, t.b), t.c)) {}
};

/// Triangles of the leaves, in metres, in the frame of a.
class Corners {
public:
    Corners(const WidePlacement& placement, double metres_of_a) : placement_(placement), metres_(metres_of_a) {}

    [[nodiscard]] Boxed of_a(const WideLeaf& leaf, std::size_t i) const noexcept {
        return Boxed({of_a(leaf, leaf.corner[0][i]), of_a(leaf, leaf.corner[1][i]), of_a(leaf, leaf.corner[2][i])});
    }
    [[nodiscard]] Boxed of_b(const WideLeaf& leaf, std::size_t j) const noexcept {
        return Boxed({of_b(leaf, leaf.corner[0][j]), of_b(leaf, leaf.corner[1][j]), of_b(leaf, leaf.corner[2][j])});
    }

private:
    [[nodiscard]] dvec3 of_a(const WideLeaf& leaf, std::uint8_t v) const noexcept {
        return metres_ * dvec3(vec3{leaf.vertex[0][v], leaf.vertex[1][v], leaf.vertex[2][v]});
    }
    [[nodiscard]] dvec3 of_b(const WideLeaf& leaf, std::uint8_t v) const noexcept {
        return transform_point(placement_.pose, placement_.metres * dvec3(vec3{leaf.vertex[0][v], leaf.vertex[1][v], leaf.vertex[2][v]}));
    }

    const WidePlacement& placement_;
    double metres_;
};

double gap_of(const Boxed& a, const Boxed& b) noexcept {
    const dvec3 gap = glm::max(glm::max(a.lower - b.upper, b.lower - a.upper), dvec3{0.0});
    return std::sqrt(glm::dot(gap, gap));
}

double largest_of(const Aabb& box) noexcept {
    const dvec3 far = glm::max(glm::abs(box.lower), glm::abs(box.upper));
    return std::max({far.x, far.y, far.z});
}

/// The nearest pair so far.
class Nearest {
public:
    Nearest(WidePlacement& placement, double radius, double doubt) : placement_(placement), radius_(radius), doubt_(doubt) {}

    [[nodiscard]] bool may_count(double distance) const noexcept { return !(distance > best_ + doubt_) && !(distance > radius_ + doubt_); }
    void offer(const Triangle& a, const Triangle& b, const TrianglePair& pair) noexcept {
        const geo::ClosestPoints<double> c = geo::closest_points(a, b);
        const double distance = std::sqrt(c.distance_sq);
        if (!(distance <= radius_) || distance > best_ || (found_ && distance == best_ && found_->triangles < pair)) return;
        best_ = distance;
        found_ = {c.on_a, c.on_b, distance, std::max(0.0, distance - doubt_), pair};
        placement_.set_reach(std::min(placement_.reach, distance + doubt_));
    }
    [[nodiscard]] bool is_zero() const noexcept { return best_ == 0.0; }
    [[nodiscard]] const std::optional<ClosestOfMeshes>& found() const noexcept { return found_; }

private:
    WidePlacement& placement_;
    double radius_, doubt_;
    double best_ = std::numeric_limits<double>::infinity();
    std::optional<ClosestOfMeshes> found_;
};

}  // namespace

std::optional<ClosestOfMeshes> closest_pair(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, double radius) {
    if (!is_finite(b_in_a) || !(radius >= 0.0)) return std::nullopt;
    const double size = std::max(largest_of(a.bounds()), 2.0 * largest_of(b.bounds()) + glm::length(b_in_a.position));
    const double doubt = 48.0 * 0x1p-52 * size;
    // Some distance between the two, which bounds the least.
    const WideLeaf* leaf = nullptr;
    for (WideRef ref = WideBvh::root(); leaf == nullptr;) {
        ref = b.wide().node(ref).child[0];
        if (is_leaf(ref)) leaf = &b.wide().leaf(ref);
    }
    const double unit = 1.0 / static_cast<double>(b.wide().scale);
    const dvec3 corner = transform_point(b_in_a, unit * dvec3(vec3{leaf->vertex[0][0], leaf->vertex[1][0], leaf->vertex[2][0]}));
    const std::optional<ClosestOnMesh> first = closest_point(a, corner, radius);
    const double reach = (first ? first->distance : radius) + doubt;
    if (!is_finite(reach)) return std::nullopt;  // farther apart than doubles tell

    WidePlacement placement;
    if (!place(a.wide(), b.wide(), b_in_a, reach, placement)) return std::nullopt;
    Nearest nearest(placement, radius, doubt);
    const Corners corners(placement, 1.0 / static_cast<double>(a.wide().scale));
    visit_leaf_pairs(a.wide(), b.wide(), placement, [&](const LeafPair& pair) {
        std::optional<Boxed> y;
        for (std::size_t k = 0; k < pair.count; ++k) {
            if (k == 0 || pair.of_b(k) != pair.of_b(k - 1)) y = corners.of_b(*pair.b, pair.of_b(k));
            const Boxed x = corners.of_a(*pair.a, pair.of_a(k));
            if (!nearest.may_count(gap_of(x, *y))) continue;
            nearest.offer(x.triangle, y->triangle, {pair.triangle_of_a(k), pair.triangle_of_b(k)});
            if (nearest.is_zero()) return false;
        }
        return true;
    }, {.deepest_first = true});
    return nearest.found();
}

}  // namespace carom
