#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/mesh_leaders.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

// Vertices that one mesh is followed to behind the surface of the other, at most.
constexpr std::size_t kMostVertices = 4096;

// A contact spares a crossing of edges another way out where it is within this many times the crossing's depth.
constexpr double kSparedReach = 4.0;

std::uint64_t vertex_feature(const MeshSide& side, std::uint32_t index, bool of_first) noexcept {
    const std::uint32_t vertex = vertex_name(side.mesh().vertices()[index]);
    return of_first ? feature_name(FeatureKind::VertexOfFirst, vertex, 0) : feature_name(FeatureKind::VertexOfSecond, 0, vertex);
}

}  // namespace

void LeaderFinder::find(const MeshSide& first, const MeshSide& second, const LeaderLimits& limits, const PlacedFaces& faces,
                        std::span<const TrianglePair> meeting) {
    limits_ = limits;
    overlapping_ = !meeting.empty();
    leaders.clear();
    blocked_.clear();
    behind_first.clear();
    behind_second.clear();
    normals_behind.clear();
    deepest = 0.0;
    incomplete = false;
    for (const bool is_first : {true, false}) {
        const MeshSide &mover = is_first ? first : second, &surface = is_first ? second : first;
        const std::size_t count = mover.mesh().vertices().size();
        rounds_.resize(std::max(rounds_.size(), count), 0u);
        places_.resize(rounds_.size(), 0u);
        queue_.clear();
        ++round_;
        queue_near(faces, is_first);
        for (const TrianglePair& pair : meeting) {
            for (const std::uint32_t v : mover.mesh().triangles()[is_first ? pair.a : pair.b]) note(v);
        }
        for (std::size_t k = 0; k < queue_.size() && !incomplete; ++k) {
            const Visit visit = queue_[k];
            look_at_vertex(mover, surface, visit, is_first);
            incomplete = k + 1 == kMostVertices;
        }
    }
    collect_crossings(faces);
    judge_crossings(first, second);
    drop_spared(first, second);
    if (!overlapping_ || std::ranges::any_of(leaders, [&](const Leader& l) { return l.separation <= limits.tolerance; })) return;
    incomplete = true;
    const auto shallowest = std::ranges::max_element(blocked_, {}, &Leader::separation);
    if (shallowest != blocked_.end()) leaders.push_back(*shallowest);
}

LeaderFinder::Visit& LeaderFinder::note(std::uint32_t vertex) {
    if (rounds_[vertex] != round_) {
        rounds_[vertex] = round_;
        places_[vertex] = static_cast<std::uint32_t>(queue_.size());
        queue_.push_back({vertex, std::numeric_limits<double>::infinity(), dvec3{0.0}});
    }
    return queue_[places_[vertex]];
}

// Queues the vertices within the margin of the other surface. The faces near any of a vertex's own hold all that are near the vertex.
void LeaderFinder::queue_near(const PlacedFaces& faces, bool mover_is_first) {
    const double reach_sq = limits_.margin * limits_.margin;
    for (const FacePair& pair : faces.pairs) {
        const PlacedFace &a = faces.first[pair.a], &b = faces.second[pair.b];
        const PlacedFace &own = mover_is_first ? a : b, &other = mover_is_first ? b : a;
        for (std::size_t k = 0; k < 3; ++k) {
            const dvec3& p = own.corners[k];
            if (!within({p, p}, other.box, limits_.margin)) continue;
            const dvec3 nearest = closest_on_triangle(other.corners, p).point, gap = p - nearest;
            const double sq = glm::dot(gap, gap);
            if (sq > reach_sq) continue;
            Visit& visit = note(own.vertices[k]);
            if (sq < visit.nearest_sq) visit.nearest_sq = sq, visit.nearest = nearest;
        }
    }
}

void LeaderFinder::look_at_vertex(const MeshSide& mover, const MeshSide& surface, const Visit& visit, bool mover_is_first) {
    const std::uint32_t vertex = visit.vertex;
    const dvec3 p = mover.to_pair(mover.mesh().vertices()[vertex]);
    const bool known = visit.nearest_sq <= limits_.margin * limits_.margin;
    const std::optional<SurfacePoint> nearest = known ? surface.measure_at(p, visit.nearest) : surface.measure(p, limits_.depth);
    if (!nearest || nearest->separation > limits_.margin) return;
    const double turn = mover_is_first ? -1.0 : 1.0;  // from the way out of the surface to the normal
    if (nearest->separation < 0.0) {
        (mover_is_first ? behind_second : behind_first).push_back(p);
        normals_behind.push_back(turn * nearest->outward);
    }
    deepest = std::max(deepest, -nearest->separation);
    const auto leader = [&](const dvec3& outward, double separation) {
        return Leader{turn * outward, separation, p - (0.5 * separation) * outward, vertex_feature(mover, vertex, mover_is_first), false, false};
    };
    if (nearest->separation < -limits_.margin) {
        // Further in than the pairs reach: its neighbours may be too.
        mover.for_each_at(p, limits_.tolerance, [&](std::uint32_t triangle, const Corners& t) {
            for (const std::uint32_t v : mover.mesh().triangles()[triangle]) note(v);
            const dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
            if (const double area = glm::length(n); area > 0.0) normals_behind.push_back((-turn / area) * n);
        });
    }
    // From behind, the nearest point may be in a valley of the surface, where no face's own way out leads to.
    const bool in_valley = nearest->separation < -limits_.tolerance && !surface.allows(nearest->point, nearest->outward, limits_.tolerance);
    if (!in_valley && mover.allows(p, -nearest->outward, limits_.tolerance)) {
        leaders.push_back(leader(nearest->outward, nearest->separation));
        return;
    }
    if (nearest->separation > 0.0) return;
    const double beside = in_valley ? -nearest->separation : limits_.tolerance;
    surface.faces_over(p, limits_.depth, beside, faces_);
    const SurfaceFace* best = nullptr;
    for (const SurfaceFace& face : faces_) {
        if ((best == nullptr || face.height > best->height) && mover.allows(p, -face.normal, limits_.tolerance)) best = &face;
    }
    if (best != nullptr) {
        leaders.push_back(leader(best->normal, best->height));
    } else {
        blocked_.push_back(leader(nearest->outward, nearest->separation));
    }
}

void LeaderFinder::add_parting(const MeshSide& first, const MeshSide& second, const TrianglePair& meeting) {
    Leader best;
    best.separation = -std::numeric_limits<double>::infinity();
    for (const bool plane_is_first : {true, false}) {
        const Corners plane = plane_is_first ? first.corners(meeting.a) : second.corners(meeting.b);
        const Corners corners = plane_is_first ? second.corners(meeting.b) : first.corners(meeting.a);
        const TriangleMesh::Triangle vertices = plane_is_first ? second.vertices(meeting.b) : first.vertices(meeting.a);
        const dvec3 cross = glm::cross(plane[1] - plane[0], plane[2] - plane[0]);
        const double area = std::sqrt(glm::dot(cross, cross));
        if (!(area > 0.0)) continue;
        const dvec3 outward = cross / area;
        std::size_t lowest = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (glm::dot(outward, corners[k]) < glm::dot(outward, corners[lowest])) lowest = k;
        }
        const double height = glm::dot(outward, corners[lowest] - plane[0]);
        if (height <= best.separation) continue;
        best = {plane_is_first ? outward : -outward, height, corners[lowest] - (0.5 * height) * outward,
                vertex_feature(plane_is_first ? second : first, vertices[lowest], !plane_is_first), false, false};
    }
    if (is_finite(best.separation)) leaders.push_back(best);
}

void LeaderFinder::add_way_out(const MeshSide& mover, std::uint32_t vertex, const SurfacePoint& nearest, bool mover_is_first) {
    leaders.clear();
    const dvec3 p = mover.to_pair(mover.mesh().vertices()[vertex]);
    leaders.push_back({(mover_is_first ? -1.0 : 1.0) * nearest.outward, nearest.separation, 0.5 * (p + nearest.point),
                       vertex_feature(mover, vertex, mover_is_first), false, false});
}

void LeaderFinder::collect_crossings(const PlacedFaces& faces) {
    crossings_.clear();
    for (const FacePair& pair : faces.pairs) {
        const PlacedFace &a = faces.first[pair.a], &b = faces.second[pair.b];
        // Edges that are far through each other belong to triangles that meet.
        const double reach = pair.meet ? limits_.depth : limits_.margin;
        std::array<bool, 3> near_a{};
        for (std::size_t j = 0; j < 3; ++j) near_a[j] = within(b.edge_boxes[j], a.box, reach);
        for (std::size_t i = 0; i < 3; ++i) {
            if (!within(a.edge_boxes[i], b.box, reach)) continue;
            for (std::size_t j = 0; j < 3; ++j) {
                if (near_a[j] && within(a.edge_boxes[i], b.edge_boxes[j], reach)) add_crossing(a, i, b, j, reach);
            }
        }
    }
}

// Where the shortest way between the two edges' lines begins and ends on the edges, and is at most `reach` long.
void LeaderFinder::add_crossing(const PlacedFace& a, std::size_t i, const PlacedFace& b, std::size_t j, double reach) {
    const std::size_t next_i = i == 2 ? 0 : i + 1, next_j = j == 2 ? 0 : j + 1;
    const dvec3 &p = a.corners[i], &q = b.corners[j], &p_end = a.corners[next_i], &q_end = b.corners[next_j];
    const dvec3 u = p_end - p, w = q_end - q, between = q - p;
    const dvec3 cross = glm::cross(u, w);
    const double sq = glm::dot(cross, cross), along = glm::dot(between, cross);
    if (along * along > reach * reach * sq || !(sq > kParallelSine * kParallelSine * glm::dot(u, u) * glm::dot(w, w))) return;
    const double s = glm::dot(glm::cross(between, w), cross), t = glm::dot(glm::cross(between, u), cross);
    if (!(s > 0.0 && s < sq && t > 0.0 && t < sq)) return;
    const double length = std::sqrt(sq);
    crossings_.push_back({feature_name(FeatureKind::Edges, a.edges[i], b.edges[j]), p + (s / sq) * u, q + (t / sq) * w, cross / length,
                          along / length});
}

// Each once: triangles beside an edge bring it both.
void LeaderFinder::judge_crossings(const MeshSide& first, const MeshSide& second) {
    names_.clear();
    order_.clear();
    for (const Crossing& c : crossings_) {
        order_.push_back(static_cast<std::uint32_t>(order_.size()));
        names_.push_back(c.name);
    }
    radix_sort(names_, order_, sort_scratch_);
    for (std::size_t k = 0; k < order_.size(); ++k) {
        if (k == 0 || names_[k] != names_[k - 1]) judge_crossing(first, second, crossings_[order_[k]]);
    }
}

void LeaderFinder::judge_crossing(const MeshSide& first, const MeshSide& second, const Crossing& c) {
    for (const double turn : {1.0, -1.0}) {
        const dvec3 normal = turn * c.normal;
        const double separation = turn * c.separation;
        if (separation > limits_.margin || (separation < -limits_.tolerance && !overlapping_)) continue;
        if (!first.allows(c.on_first, normal, limits_.tolerance) || !second.allows(c.on_second, -normal, limits_.tolerance)) continue;
        if (separation < -limits_.tolerance) {
            const auto inside = [&](const MeshSide& surface, const dvec3& p) {
                const std::optional<SurfacePoint> nearest = surface.measure(p, limits_.depth);
                return nearest && nearest->separation <= limits_.tolerance;
            };
            if (!inside(second, c.on_first) || !inside(first, c.on_second)) continue;
        }
        leaders.push_back({normal, separation, 0.5 * (c.on_first + c.on_second), c.name, true, false});
    }
}

// Whether the two edges of a crossing come apart where `other`, which is on a shorter way, is led out.
bool LeaderFinder::spares(const Leader& other, const Leader& leader, const MeshSide& first, const MeshSide& second) const {
    if (other.separation >= 0.0 || other.separation <= leader.separation || glm::dot(other.normal, leader.normal) > kSameNormal) return false;
    const dvec3 apart = glm::abs(other.position - leader.position);
    if (std::max({apart.x, apart.y, apart.z}) > kSparedReach * -leader.separation) return false;
    const dvec3 way = -other.separation * other.normal, half = (0.5 * leader.separation) * leader.normal;
    const std::optional<SurfacePoint> a = second.measure(leader.position - half - way, limits_.depth);
    if (a && a->separation < -limits_.tolerance) return false;
    const std::optional<SurfacePoint> b = first.measure(leader.position + half + way, limits_.depth);
    return !b || b->separation >= -limits_.tolerance;
}

void LeaderFinder::drop_spared(const MeshSide& first, const MeshSide& second) {
    for (Leader& leader : leaders) {
        if (!leader.is_crossing || leader.separation >= -limits_.tolerance) continue;
        leader.used = std::ranges::any_of(leaders, [&](const Leader& other) { return spares(other, leader, first, second); });
    }
    std::erase_if(leaders, [](const Leader& leader) { return leader.used; });
}

}  // namespace carom::detail
