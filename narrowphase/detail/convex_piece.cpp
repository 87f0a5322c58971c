#include <carom/narrowphase/detail/convex_piece.hpp>

#include <carom/narrowphase/detail/gjk.hpp>
#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>

namespace carom::detail {
namespace {

void measure(ConvexPiece& piece) {
    if (piece.polytope) {
        for (std::uint32_t k = 0; k < piece.polytope->vertex_count; ++k) piece.points.push_back(piece.polytope->vertex(k));
    }
    piece.box = {};
    for (const dvec3& p : piece.points) piece.box = merge(piece.box, {p, p});
    if (piece.turned) piece.box = box_of(*piece.turned);
    piece.box = inflate(piece.box, piece.radius);
}

// The edge that joins two corners; none where there is no such edge.
std::optional<std::uint32_t> edge_between(const Polytope& p, std::size_t i, std::size_t j) {
    for (std::uint32_t k = 0; k < p.edge_count(); ++k) {
        const std::uint32_t from = p.half_edges[2 * k].origin, to = p.half_edges[2 * k + 1].origin;
        if ((from == i && to == j) || (from == j && to == i)) return p.edge_name(k);
    }
    return std::nullopt;
}

}  // namespace

double ConvexPiece::size() const noexcept {
    const dvec3 extent = box.upper - box.lower;
    return std::max({extent.x, extent.y, extent.z});
}

dvec3 ConvexPiece::centre() const noexcept {
    if (turned) return turned->centre;
    return polytope ? polytope->centre : 0.5 * (points.front() + points.back());  // of a sphere its one point, of a capsule both ends
}

double ConvexPiece::reach(const dvec3& direction) const noexcept {
    if (turned) return turned->reach(direction) + radius;
    return glm::dot(points[farthest_along(points, direction)], direction) + radius;
}

PieceSupport ConvexPiece::support(const dvec3& direction) const noexcept {
    if (turned) return {{}, turned->support(direction) + radius * direction, {}};
    // Round shapes touch with a point, whatever their core does; flat ones with all corners that are as far.
    const std::size_t farthest = farthest_along(points, direction);
    const double least = glm::dot(points[farthest], direction) - kPointTolerance * size();
    dvec3 sum{0.0};
    std::array<std::size_t, 2> first{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (glm::dot(points[i], direction) < least) continue;
        sum += points[i];
        if (count < 2) first[count] = i;
        ++count;
    }
    const dvec3 middle = sum / static_cast<double>(count) + radius * direction;
    if (!polytope) return {{}, middle, {}};
    if (count >= 3) return {{SupportKind::Face, face_along(*polytope, direction).number}, middle, {}};
    if (count == 2) {
        if (const std::optional<std::uint32_t> edge = edge_between(*polytope, first[0], first[1])) {
            return {{SupportKind::Edge, *edge}, middle, {points[first[0]], points[first[1]]}};
        }
    }
    return {{SupportKind::Corner, static_cast<std::uint32_t>(farthest)}, points[farthest], {}};
}

std::vector<dvec3> ConvexPiece::corners_of(std::uint32_t face) const {
    const ConvexHull::Face& loop = polytope->loops[face];
    std::vector<dvec3> corners;
    std::uint32_t edge = loop.first_edge;
    for (std::uint32_t k = 0; k < loop.edge_count; ++k, edge = polytope->half_edges[edge].next) corners.push_back(polytope->origin_of(edge));
    return corners;
}

ConvexPiece make_piece(const Shape& shape, const dmat3& axes, const dvec3& origin) {
    ConvexPiece piece;
    switch (type_of(shape)) {
        case ShapeType::Sphere:
            piece.points = {origin};
            piece.radius = static_cast<double>(as<Sphere>(shape).radius);
            break;
        case ShapeType::Capsule: {
            const Capsule& capsule = as<Capsule>(shape);
            const dvec3 half = static_cast<double>(capsule.half_segment) * axes[1];
            piece.points = {origin - half, origin + half};
            piece.radius = static_cast<double>(capsule.radius);
            break;
        }
        case ShapeType::Box: {
            const auto polytope = std::make_shared<Polytope>();
            load_box(*polytope, dvec3(as<Box>(shape).half_extents), axes, origin);
            piece.polytope = polytope;
            break;
        }
        case ShapeType::ConvexHull: {
            const auto polytope = std::make_shared<Polytope>();
            load_hull(*polytope, *as<ConvexHullPtr>(shape), axes, origin);
            piece.polytope = polytope;
            break;
        }
        default: piece.turned = truncated_cone(shape, axes, origin); break;
    }
    measure(piece);
    return piece;
}

ConvexPiece make_triangle(const std::array<dvec3, 3>& corners) {
    ConvexPiece piece;
    const auto polytope = std::make_shared<Polytope>();
    if (load_triangle(*polytope, corners)) {
        piece.polytope = polytope;
    } else {
        piece.points.assign(corners.begin(), corners.end());
    }
    measure(piece);
    return piece;
}

}  // namespace carom::detail
