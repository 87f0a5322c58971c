#include <carom/collision/convex_hull.hpp>
#include <carom/collision/detail/hull_faces.hpp>
#include <carom/collision/detail/triangle_hull.hpp>
#include <carom/core/check.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

namespace carom {
namespace {

/// Triangles whose vertices are coplanar to this part of the largest extent become one face: coordinates of 24 bits leave planes
/// bumpy by about 1e-7 of it.
constexpr double kMergeTolerance = 1e-6;
constexpr double kMinThickness = 1e-6;
struct Polyhedron {
    std::vector<dvec3> vertices;
    detail::HullFaces surface;
};

std::vector<dvec3> select(std::span<const dvec3> points, std::span<const std::uint32_t> indices) {
    std::vector<dvec3> selected;
    selected.reserve(indices.size());
    for (const std::uint32_t i : indices) selected.push_back(points[i]);
    return selected;
}

/// The points that are vertices of a triangle, in their order, with the triangles renumbered to match.
std::vector<dvec3> drop_unused(std::span<const dvec3> points, std::vector<detail::HullTriangle>& triangles) {
    std::vector<std::uint32_t> renumbered(points.size(), 0);
    for (const detail::HullTriangle& t : triangles) {
        for (const std::uint32_t v : t.vertex) renumbered[v] = 1;
    }
    std::vector<dvec3> used;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (renumbered[i] == 0) continue;
        renumbered[i] = static_cast<std::uint32_t>(used.size());
        used.push_back(points[i]);
    }
    for (detail::HullTriangle& t : triangles) {
        for (std::uint32_t& v : t.vertex) v = renumbered[v];
    }
    return used;
}

/// What merging may cost in total, in units of the tolerance: a face's plane passes over all vertices, and vertices that
/// belong to fewer than three faces are dropped.
constexpr double kMergeLoss = 4.0;

/// Thins out crowds: of points closer together than `distance` the one with the least x stays. @return indices, ascending.
std::vector<std::uint32_t> thin_out(std::span<const dvec3> points, double distance) {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return points[a].x < points[b].x; });
    std::vector<std::uint32_t> kept;
    for (const std::uint32_t i : order) {
        bool alone = true;
        for (std::size_t k = kept.size(); alone && k-- > 0 && points[i].x - points[kept[k]].x < distance;) {
            alone = glm::distance(points[i], points[kept[k]]) >= distance;
        }
        if (alone) kept.push_back(i);
    }
    std::stable_sort(kept.begin(), kept.end());
    return kept;
}

/// What `all` has and `some` has not; both are in the same order, without duplicates.
std::vector<dvec3> missing(std::span<const dvec3> all, std::span<const dvec3> some) {
    std::vector<dvec3> rest;
    std::size_t next = 0;
    for (const dvec3& p : all) {
        if (next < some.size() && some[next] == p) {
            ++next;
        } else {
            rest.push_back(p);
        }
    }
    return rest;
}

/// Merges the triangles of an exact hull into faces, after thinning out crowds of vertices. Points at which fewer than three faces meet are dropped and the hull is
/// built anew from the others, until all points are corners.
/// @return nothing if the faces are not convex polygons within the tolerance, which cannot happen with tolerance 0.
std::optional<Polyhedron> merge(std::span<const dvec3> exact_points, std::vector<detail::HullTriangle> triangles,
                                double tolerance) {
    std::vector<dvec3> points(exact_points.begin(), exact_points.end());
    const auto keep = [&](std::span<const std::uint32_t> kept) {
        if (kept.size() < 4) return false;
        points = select(points, kept);
        triangles = detail::triangle_hull(points, 0.0);
        if (triangles.empty()) return false;
        points = drop_unused(points, triangles);
        return true;
    };
    if (const auto kept = thin_out(points, tolerance); kept.size() < points.size() && !keep(kept)) return std::nullopt;
    for (;;) {
        const detail::FaceLabels labels = detail::merge_coplanar(points, triangles, tolerance);
        const std::vector<std::uint32_t> kept = detail::corners(triangles, labels);
        if (kept.size() < points.size()) {
            if (!keep(kept)) return std::nullopt;
            continue;
        }
        detail::HullFaces surface = detail::link_faces(points, triangles, labels);
        if (tolerance > 0.0) {
            const double loss = kMergeLoss * tolerance;
            if (!detail::is_convex_polyhedron(points, surface, loss)) return std::nullopt;
            if (!detail::is_near_hull(missing(exact_points, points), points, surface, loss)) return std::nullopt;
        }
        return Polyhedron{std::move(points), std::move(surface)};
    }
}

Error failure(ErrorCode code, std::string message) { return {code, std::move(message), "ConvexHull::build"}; }

std::vector<ConvexHull::VertexBundle> bundled(std::span<const vec3> vertices) {
    std::vector<ConvexHull::VertexBundle> bundles(bundle_count(vertices.size()));
    for (std::size_t i = 0; i < bundles.size() * kBundleWidth; ++i) {
        const vec3& v = vertices[i < vertices.size() ? i : 0];
        ConvexHull::VertexBundle& bundle = bundles[i / kBundleWidth];
        bundle.x.lane[i % kBundleWidth] = v.x;
        bundle.y.lane[i % kBundleWidth] = v.y;
        bundle.z.lane[i % kBundleWidth] = v.z;
    }
    return bundles;
}

}  // namespace

Result<ConvexHullPtr> ConvexHull::build(std::span<const vec3> points) {
    if (points.size() < 4) return failure(ErrorCode::Empty, "a hull needs at least 4 points");
    std::vector<dvec3> exact(points.size(), dvec3{0.0});
    dvec3 lower{points[0]};
    dvec3 upper{points[0]};
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_finite(points[i])) return failure(ErrorCode::NotFinite, "point " + std::to_string(i) + " is not finite");
        exact[i] = dvec3{points[i]};
        lower = glm::min(lower, exact[i]);
        upper = glm::max(upper, exact[i]);
    }
    const dvec3 size = upper - lower;
    const double extent = std::max({size.x, size.y, size.z});
    std::vector<detail::HullTriangle> triangles = detail::triangle_hull(exact, kMinThickness * extent);
    if (triangles.empty()) return failure(ErrorCode::Degenerate, "the points are coplanar");
    exact = drop_unused(exact, triangles);

    std::optional<Polyhedron> merged;
    for (const double tolerance : {kMergeTolerance * extent, 0.125 * kMergeTolerance * extent, 0.0}) {
        if ((merged = merge(exact, triangles, tolerance))) break;
    }
    CAROM_ASSERT(merged.has_value());

    std::shared_ptr<ConvexHull> hull(new ConvexHull);
    hull->vertices_.reserve(merged->vertices.size());
    for (const dvec3& v : merged->vertices) hull->vertices_.emplace_back(v);
    hull->vertex_bundles_ = bundled(hull->vertices_);
    double reach_sq = 0.0;
    for (const vec3& v : hull->vertices_) reach_sq = std::max(reach_sq, glm::dot(dvec3(v), dvec3(v)));
    hull->reach_ = std::sqrt(reach_sq) * (1.0 + 0x1p-50);
    hull->faces_ = std::move(merged->surface.faces);
    hull->edges_ = std::move(merged->surface.edges);
    hull->fill_bundles();
    return ConvexHullPtr(std::move(hull));
}

void ConvexHull::fill_bundles() {
    const std::size_t vertex_count = vertices_.size();
    point_bundles_.resize(double_bundle_count(vertex_count));
    for (std::size_t i = 0; i < point_bundles_.size() * kDoubleBundleWidth; ++i) {
        set_point(point_bundles_[i / kDoubleBundleWidth], i % kDoubleBundleWidth, dvec3(vertices_[std::min(i, vertex_count - 1)]));
    }
    plane_bundles_.resize(double_bundle_count(faces_.size()));
    end_planes(plane_bundles_.back(), 0);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        const Face& face = faces_[f];
        double offset = face.offset;
        std::uint32_t e = face.first_edge;
        for (std::uint32_t k = 0; k < face.edge_count; ++k, e = edges_[e].next) {
            offset = std::max(offset, glm::dot(face.normal, dvec3(vertices_[edges_[e].origin])));
        }
        set_plane(plane_bundles_[f / kDoubleBundleWidth], f % kDoubleBundleWidth, face.normal, offset);
    }
    dvec3 sum{0.0};
    for (const vec3& v : vertices_) {
        bounds_ = merge(bounds_, {dvec3(v), dvec3(v)});
        sum += dvec3(v);
    }
    centre_ = sum / static_cast<double>(vertex_count);
}

std::uint32_t ConvexHull::support(const dvec3& direction) const noexcept {
    std::uint32_t best = 0;
    double farthest = glm::dot(direction, dvec3{vertices_[0]});
    for (std::uint32_t i = 1; i < vertices_.size(); ++i) {
        const double along = glm::dot(direction, dvec3{vertices_[i]});
        if (along > farthest) {
            farthest = along;
            best = i;
        }
    }
    return best;
}

}  // namespace carom
