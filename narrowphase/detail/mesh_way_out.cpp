#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/mesh_way_out.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace carom::detail {
namespace {

// Motions that are tried, shortest first, and directions that are looked at.
constexpr std::size_t kMostTries = 12;
constexpr std::size_t kMostDirections = 128;

// Steps by which a direction is turned towards less depth, and how long they are [rad].
constexpr int kRefinements = 64;
constexpr double kFirstStep = 0.1;
constexpr double kShorter = 0.7;

// Rounds in which the leaders' motions are put together.
constexpr int kRounds = 8;

// Where the segment passes through the triangle.
std::optional<dvec3> crossing(const dvec3& from, const dvec3& to, const Corners& t) {
    const dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double above = glm::dot(n, from - t[0]), below = glm::dot(n, to - t[0]);
    if (!((above > 0.0) != (below > 0.0))) return std::nullopt;
    const dvec3 p = from + (above / (above - below)) * (to - from);
    for (std::size_t k = 0; k < 3; ++k) {
        if (glm::dot(n, glm::cross(t[(k + 1) % 3] - t[k], p - t[k])) < 0.0) return std::nullopt;
    }
    return p;
}

// The motion of the first mesh by which all leaders are led out, each along its own normal and by `tolerance` more.
dvec3 motion_of(std::span<const Leader> leaders, double tolerance) {
    dvec3 motion{0.0};
    for (int round = 0; round < kRounds; ++round) {
        for (const Leader& l : leaders) {
            const double left = l.separation - tolerance - glm::dot(motion, l.normal);
            if (left < 0.0) motion += left * l.normal;
        }
    }
    return motion;
}

double deepest_of(std::span<const Leader> leaders) {
    double deepest = 0.0;
    for (const Leader& l : leaders) deepest = std::max(deepest, -l.separation);
    return deepest;
}

}  // namespace

void WayOutFinder::collect_points(const LeaderFinder& finder, const PlacedFaces& faces) {
    first_ = finder.behind_second;
    second_ = finder.behind_first;
    for (const FacePair& pair : faces.pairs) {
        if (!pair.meet) continue;
        const Corners &a = faces.first[pair.a].corners, &b = faces.second[pair.b].corners;
        for (std::size_t k = 0; k < 3; ++k) {
            for (const std::optional<dvec3>& p : {crossing(a[k], a[(k + 1) % 3], b), crossing(b[k], b[(k + 1) % 3], a)}) {
                if (!p) continue;
                first_.push_back(*p);
                second_.push_back(*p);
            }
        }
    }
}

void WayOutFinder::offer(const dvec3& normal) {
    if (ways_.size() >= kMostDirections || !(glm::dot(normal, normal) > 0.5)) return;
    if (std::ranges::any_of(ways_, [&](const Way& w) { return glm::dot(w.normal, normal) > kFaceCosine; })) return;
    ways_.push_back(way_along(normal));
}

WayOutFinder::Way WayOutFinder::way_along(const dvec3& normal) const {
    Way way{normal, 0.0, dvec3{0.0}, dvec3{0.0}};
    double highest = -std::numeric_limits<double>::infinity(), lowest = std::numeric_limits<double>::infinity();
    for (const dvec3& p : first_) {
        const double along = glm::dot(p, normal);
        if (along > highest) highest = along, way.deepest = p;
    }
    for (const dvec3& p : second_) {
        const double along = glm::dot(p, normal);
        if (along < lowest) lowest = along, way.highest = p;
    }
    way.depth = highest - lowest;
    return way;
}

// Towards less depth, by the slope of the depth over directions, in steps that become shorter where it does not grow less.
WayOutFinder::Way WayOutFinder::refined(Way way) const {
    double step = kFirstStep;
    for (int k = 0; k < kRefinements; ++k) {
        const dvec3 between = way.deepest - way.highest, slope = between - glm::dot(between, way.normal) * way.normal;
        const double steepness = glm::length(slope);
        if (!(steepness > 0.0)) break;
        const Way next = way_along(glm::normalize(way.normal - (step / steepness) * slope));
        if (next.depth < way.depth) {
            way = next;
        } else {
            step *= kShorter;
        }
    }
    return way;
}

void WayOutFinder::collect_directions(const LeaderFinder& finder, const PlacedFaces& faces) {
    ways_.clear();
    for (const Leader& l : finder.leaders) offer(l.normal);
    for (const FacePair& pair : faces.pairs) {
        if (!pair.meet) continue;
        offer(faces.first[pair.a].normal);
        offer(-faces.second[pair.b].normal);
    }
    for (const dvec3& n : finder.normals_behind) offer(n);
    for (const FacePair& pair : faces.pairs) {
        if (!pair.meet) continue;
        const Corners &a = faces.first[pair.a].corners, &b = faces.second[pair.b].corners;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                const dvec3 n = glm::cross(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j]);
                const double length = glm::length(n);
                if (!(length > 0.0)) continue;
                // Out of the first and into the second.
                const double turn = glm::dot(n, faces.first[pair.a].normal - faces.second[pair.b].normal) < 0.0 ? -1.0 : 1.0;
                offer((turn / length) * n);
            }
        }
    }
}

// Along the deepest leader the line on which the surfaces cross is no longer than what lies behind a surface is deep, unless there is more than
// one patch, or that leader is not of the deepest part.
bool WayOutFinder::crosses_at_length(const LeaderFinder& finder, double deep) const {
    const auto leader = std::ranges::min_element(finder.leaders, {}, &Leader::separation);
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const dvec3& p : first_) {
        const double along = glm::dot(p, leader->normal);
        lowest = std::min(lowest, along);
        highest = std::max(highest, along);
    }
    return highest - lowest >= deep;
}

std::optional<Leader> WayOutFinder::find(const LeaderFinder& finder, const PlacedFaces& faces, const WayOutLimits& limits,
                                         FunctionRef<bool(const dvec3& motion)> meets) {
    const double tolerance = limits.tolerance;
    unfreed_ = false;
    collect_points(finder, faces);
    if (first_.empty() || second_.empty() || finder.leaders.empty()) return std::nullopt;
    const double deepest = deepest_of(finder.leaders);
    if (std::max(finder.deepest, deepest) < limits.deep) {
        if (!crosses_at_length(finder, limits.deep) || !meets(motion_of(finder.leaders, tolerance))) return std::nullopt;
    }
    collect_directions(finder, faces);
    order_.resize(ways_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::erase_if(order_, [&](std::uint32_t k) { return !(ways_[k].depth > tolerance); });
    for (std::size_t tries = 0; tries < kMostTries && !order_.empty(); ++tries) {
        const auto shortest = std::ranges::min_element(order_, {}, [&](std::uint32_t k) { return ways_[k].depth; });
        const Way& found = ways_[*shortest];
        order_.erase(shortest);
        if (meets(-(found.depth + tolerance) * found.normal)) continue;
        const Way less = refined(found);
        const Way& way = less.depth > tolerance && !meets(-(less.depth + tolerance) * less.normal) ? less : found;
        // Several leaders may lead out where each alone does not, as in a corner of a room.
        if (way.depth > deepest + tolerance && !meets(motion_of(finder.leaders, tolerance))) return std::nullopt;
        return Leader{way.normal, -way.depth, way.deepest - (0.5 * way.depth) * way.normal, feature_name(FeatureKind::Edges, 0, 0), false, false, true};
    }
    unfreed_ = meets(motion_of(finder.leaders, tolerance));
    return std::nullopt;
}

}  // namespace carom::detail
