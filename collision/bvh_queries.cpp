#include <carom/collision/bvh_queries.hpp>

#include <carom/collision/closest_points.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_volume.hpp>
#include <carom/collision/overlap_tests.hpp>
#include <carom/core/check.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace carom {
namespace {

constexpr double kFloatUnit = 0x1p-24;
constexpr double kFarthest = 1e30;  // beyond every tree: scaled, still a float
constexpr float kInfinity = std::numeric_limits<float>::infinity();

float at_most(double x) noexcept {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) > x ? std::nextafter(f, -kInfinity) : f;
}
float at_least(double x) noexcept { return -at_most(-x); }

/// A triangle of a leaf in the mesh's own coordinates, which scaling by a power of two gives back to the bit.
geo::Triangle<double> triangle_of(const WideLeaf& leaf, std::uint32_t k, double unit) noexcept {
    const auto corner = [&](std::size_t c) {
        const std::size_t v = leaf.corner[c][k];
        return unit * dvec3(leaf.vertex[0][v], leaf.vertex[1][v], leaf.vertex[2][v]);
    };
    return {corner(0), corner(1), corner(2)};
}

double unit_of(const WideBvh& tree) noexcept { return 1.0 / static_cast<double>(tree.scale); }

WideVolume box_volume(const WideBvh& tree, const dvec3& lower, const dvec3& upper) noexcept {
    // Lanes without a child have infinite boxes, which no finite bound meets; NaN stays and meets nothing.
    constexpr float kLargest = std::numeric_limits<float>::max();
    WideVolume volume{};
    for (int k = 0; k < 3; ++k) {
        volume.lower[k] = std::max(at_most(static_cast<double>(tree.scale) * lower[k]), -kLargest);
        volume.upper[k] = std::min(at_least(static_cast<double>(tree.scale) * upper[k]), kLargest);
    }
    return volume;
}

/// How far from a volume geo::overlaps() may still see a triangle of the tree: 128 eps of the largest coordinate difference, which is at
/// most twice what is summed here. A box without that would make the answer depend on the shape of the tree.
double touching_distance(const WideBvh& tree, const dvec3& center, double half_size) noexcept {
    const dvec3 far = dvec3(glm::max(glm::abs(tree.lower), glm::abs(tree.upper))) / static_cast<double>(tree.scale);
    const dvec3 from = glm::abs(center);
    return 0x1p-44 * (std::max({far.x, far.y, far.z}) + std::max({from.x, from.y, from.z}) + half_size);
}

/// Cuts the volume by normal . x <= offset, in the mesh's coordinates; the normal of unit length.
void cut(WideVolume& volume, const WideBvh& tree, const dvec3& normal, double offset) noexcept {
    // The coordinates of a corner are exact. Its product with the rounded normal is wrong by less than 8 u of the sum of |normal| |x|,
    // which is at most sqrt(3) times the largest coordinate.
    const vec3 far = glm::max(glm::abs(tree.lower), glm::abs(tree.upper));
    const double largest = static_cast<double>(std::max({far.x, far.y, far.z}));
    const double scaled = static_cast<double>(tree.scale) * offset;
    WideVolume::Cut& c = volume.cuts[volume.cut_count++];
    for (int k = 0; k < 3; ++k) c.normal[k] = static_cast<float>(normal[k]);
    c.offset = at_least(scaled + 16.0 * kFloatUnit * largest + 1e-15 * std::abs(scaled));
}

/// The volume of a box with axes of its own.
WideVolume turned_volume(const WideBvh& tree, const geo::Obb<double>& box) noexcept {
    const double touch = 2.0 * touching_distance(tree, box.center, glm::length(box.half_extents));  // and the rounding of sums below
    dvec3 reach{touch};
    for (int k = 0; k < 3; ++k) reach += box.half_extents[k] * glm::abs(box.axes[k]);
    WideVolume volume = box_volume(tree, box.center - reach, box.center + reach);
    for (int k = 0; k < 3; ++k) {
        const double along = glm::dot(box.axes[k], box.center);
        const double half = box.half_extents[k] + touch;
        cut(volume, tree, box.axes[k], along + half);
        cut(volume, tree, -box.axes[k], half - along);
    }
    return volume;
}

template <class Shape>
void visit_overlaps(const StaticBvh& bvh, const WideVolume& volume, const Shape& shape, TriangleVisit visit) {
    const WideBvh& tree = bvh.wide();
    const double unit = unit_of(tree);
    visit_leaves(tree, volume, [&](const WideLeaf& leaf) {
        for (std::uint32_t k = 0; k < leaf.triangle_count; ++k) {
            if (geo::overlaps(shape, triangle_of(leaf, k, unit)) && !visit(leaf.triangle[k])) return false;
        }
        return true;
    });
}

/// A box round a capsule, along its axis.
geo::Obb<double> box_round(const geo::Capsule<double>& c) noexcept {
    const dvec3 along = c.axis.b - c.axis.a;
    const double length = glm::length(along);
    geo::Obb<double> box{.center = 0.5 * (c.axis.a + c.axis.b), .half_extents = dvec3{c.radius}};
    box.half_extents.x += 0.5 * length;
    if (!(length > 0.0)) return box;
    const dvec3 x = along / length;
    // The coordinate axis that leans on it least.
    const dvec3 s = glm::abs(x);
    const dvec3 other = s.x <= s.y && s.x <= s.z ? dvec3{1, 0, 0} : (s.y <= s.z ? dvec3{0, 1, 0} : dvec3{0, 0, 1});
    const dvec3 y = glm::normalize(glm::cross(x, other));
    box.axes = dmat3{x, y, glm::cross(x, y)};
    return box;
}

/// The distance also where its square is out of range.
double distance_of(const geo::ClosestPoints<double>& c) noexcept {
    if (c.distance_sq > 0x1p-960 && c.distance_sq < 0x1p960) return std::sqrt(c.distance_sq);
    const dvec3 d = glm::abs(c.on_b - c.on_a);
    const double largest = std::max({d.x, d.y, d.z});
    return largest > 0.0 ? largest * glm::length(d / largest) : std::sqrt(c.distance_sq);
}

/// By how much the computed distance may be too large: see geo::closest_points(); no two corners are farther apart than twice the farthest
/// from the point.
double distance_error(const dvec3& point, const geo::Triangle<double>& t) noexcept {
    const dvec3 far = glm::max(glm::abs(t.a - point), glm::max(glm::abs(t.b - point), glm::abs(t.c - point)));
    return 32.0 * 0x1p-52 * std::max({far.x, far.y, far.z});
}

/// Cuts polygons by half-spaces normal . x <= offset, which keep what rounding might have put beyond them.
class Cutter {
public:
    void start(const std::array<dvec3, 3>& corners) { polygon_.assign(corners.begin(), corners.end()); }
    /// @return whether anything is left.
    bool cut(const dvec3& normal, double offset) {
        next_.clear();
        const auto height = [&](const dvec3& p) {
            const dvec3 products = normal * p;
            const double doubt = 0x1p-50 * (std::abs(products.x) + std::abs(products.y) + std::abs(products.z) + std::abs(offset));
            return (products.x + products.y + products.z - offset) - doubt;
        };
        for (std::size_t i = 0; i < polygon_.size(); ++i) {
            const dvec3& here = polygon_[i];
            const dvec3& there = polygon_[i + 1 < polygon_.size() ? i + 1 : 0];
            const double h = height(here), g = height(there);
            if (h <= 0.0) next_.push_back(here);
            if ((h <= 0.0) != (g <= 0.0)) next_.push_back(here + (h / (h - g)) * (there - here));
        }
        std::swap(polygon_, next_);
        return !polygon_.empty();
    }

private:
    std::vector<dvec3> polygon_, next_;
};

}  // namespace

void overlapping_triangles(const StaticBvh& bvh, const geo::Frustum<double>& volume, TriangleVisit visit) {
    const WideBvh& tree = bvh.wide();
    const double unit = unit_of(tree);
    WideVolume around = box_volume(tree, dvec3{-kFarthest}, dvec3{kFarthest});
    for (const geo::Plane<double>& plane : volume.planes) {
        if (!is_finite(plane.normal) || !is_finite(plane.offset)) return;
        cut(around, tree, -plane.normal, -plane.offset);
    }
    Cutter cutter;
    visit_leaves(tree, around, [&](const WideLeaf& leaf) {
        for (std::uint32_t k = 0; k < leaf.triangle_count; ++k) {
            const geo::Triangle<double> t = triangle_of(leaf, k, unit);
            cutter.start({t.a, t.b, t.c});
            bool met = true;
            for (const geo::Plane<double>& plane : volume.planes) met = met && cutter.cut(-plane.normal, -plane.offset);
            if (met && !visit(leaf.triangle[k])) return false;
        }
        return true;
    });
}

void overlapping_triangles(const StaticBvh& bvh, const ConvexHull& hull, const Pose& pose, TriangleVisit visit) {
    if (!is_finite(pose)) return;
    const WideBvh& tree = bvh.wide();
    const double unit = unit_of(tree);
    const Aabb box = bounds(ConvexHullPtr(ConvexHullPtr{}, &hull), pose);  // a pointer that owns nothing
    Cutter cutter;
    visit_leaves(tree, box_volume(tree, box.lower, box.upper), [&](const WideLeaf& leaf) {
        for (std::uint32_t k = 0; k < leaf.triangle_count; ++k) {
            const geo::Triangle<double> t = triangle_of(leaf, k, unit);
            if (!geo::overlaps(geo::Aabb<double>{box.lower, box.upper}, t)) continue;
            cutter.start({inverse_transform_point(pose, t.a), inverse_transform_point(pose, t.b), inverse_transform_point(pose, t.c)});
            const double doubt = 0x1p-48 * glm::length(pose.position);
            bool met = true;
            for (const ConvexHull::Face& face : hull.faces()) met = met && cutter.cut(face.normal, face.offset + doubt);
            if (met && !visit(leaf.triangle[k])) return false;
        }
        return true;
    });
}

void overlapping_triangles(const StaticBvh& bvh, const geo::Aabb<double>& volume, TriangleVisit visit) {
    visit_overlaps(bvh, box_volume(bvh.wide(), volume.lower, volume.upper), volume, visit);
}

void overlapping_triangles(const StaticBvh& bvh, const geo::Sphere<double>& volume, TriangleVisit visit) {
    const dvec3 reach{volume.radius + touching_distance(bvh.wide(), volume.center, volume.radius)};
    visit_overlaps(bvh, box_volume(bvh.wide(), volume.center - reach, volume.center + reach), volume, visit);
}

void overlapping_triangles(const StaticBvh& bvh, const geo::Obb<double>& volume, TriangleVisit visit) {
    visit_overlaps(bvh, turned_volume(bvh.wide(), volume), volume, visit);
}

void overlapping_triangles(const StaticBvh& bvh, const geo::Capsule<double>& volume, TriangleVisit visit) {
    visit_overlaps(bvh, turned_volume(bvh.wide(), box_round(volume)), volume, visit);
}

std::optional<ClosestOnMesh> closest_point(const StaticBvh& bvh, const dvec3& point, double radius) {
    if (!is_finite(point) || !(radius >= 0.0)) return std::nullopt;
    const WideBvh& tree = bvh.wide();
    const double unit = unit_of(tree), scale = static_cast<double>(tree.scale);
    const dvec3 scaled = scale * point;
    const WidePoint3 start{{static_cast<float>(scaled.x), static_cast<float>(scaled.y), static_cast<float>(scaled.z)},
                           at_least(2.0 * kFloatUnit * glm::length(scaled))};
    std::optional<ClosestOnMesh> best;
    double least_sq = std::numeric_limits<double>::infinity();
    visit_leaves_near(tree, start, at_least(scale * radius), [&](const WideLeaf& leaf) {
        for (std::uint32_t k = 0; k < leaf.triangle_count; ++k) {
            const geo::Triangle<double> t = triangle_of(leaf, k, unit);
            const geo::ClosestPoints<double> c = geo::closest_points(point, t);
            if (best && c.distance_sq > least_sq) continue;
            const ClosestOnMesh here{c.on_b, distance_of(c), leaf.triangle[k]};
            const bool ties = best && c.distance_sq == least_sq && here.distance >= best->distance;
            if (ties && (here.distance > best->distance || here.triangle > best->triangle)) continue;
            if (here.distance > radius && here.distance - radius > distance_error(point, t)) continue;
            least_sq = c.distance_sq;
            best = here;
        }
        return at_least(scale * (best ? best->distance : radius));
    });
    return best;
}

void closest_points(const StaticBvh& bvh, std::span<const dvec3> points, double radius, std::span<std::optional<ClosestOnMesh>> found,
                    Executor& executor) {
    CAROM_REQUIRE(points.size() == found.size(), ErrorCode::InvalidArgument, "points and found differ in size");
    executor.parallel_for(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) found[i] = closest_point(bvh, points[i], radius);
    });
}

}  // namespace carom
