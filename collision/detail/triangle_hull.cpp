#include <carom/collision/detail/orientation.hpp>
#include <carom/collision/detail/triangle_hull.hpp>
#include <carom/core/check.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <utility>

namespace carom::detail {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

struct Facet {
    HullTriangle triangle;
    dvec3 normal{0.0};     ///< not of unit length
    dvec3 magnitude{0.0};  ///< what the normal would be if nothing cancelled, for the bound on rounding
    std::uint32_t outside = kNone;   ///< first of a list of points above this facet
    std::uint32_t farthest = kNone;  ///< the one of them that is farthest
    double farthest_height = 0.0;
    std::uint32_t seen_by = kNone;  ///< the point that last found this facet visible
    bool alive = true;
};

class Builder {
public:
    explicit Builder(std::span<const dvec3> points)
        : points_(points), next_(points.size(), kNone), fan_(points.size(), kNone) {}

    bool start(double min_thickness);
    void run();
    std::vector<HullTriangle> triangles() const;

private:
    double height(const Facet& facet, std::uint32_t point) const noexcept;
    int side(const Facet& facet, std::uint32_t point, double height) const noexcept;
    bool claim(std::uint32_t facet, std::uint32_t point);
    std::uint32_t add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    void find_visible(std::uint32_t facet, std::uint32_t eye);
    void cover(std::uint32_t eye);
    void hand_over(std::uint32_t eye);

    struct HorizonEdge {
        std::uint32_t from, to;  ///< as the visible facet runs
        std::uint32_t beyond;    ///< the facet that stays
    };

    std::span<const dvec3> points_;
    std::vector<std::uint32_t> next_;  ///< links of the lists of outside points
    std::vector<std::uint32_t> fan_;   ///< of a horizon vertex: the new facet that starts there
    std::vector<Facet> facets_;
    std::vector<std::uint32_t> pending_;
    std::vector<std::uint32_t> visible_;
    std::vector<HorizonEdge> horizon_;
    std::uint32_t first_new_ = 0;
};

double Builder::height(const Facet& facet, std::uint32_t point) const noexcept {
    return glm::dot(facet.normal, points_[point] - points_[facet.triangle.vertex[0]]);
}

/// The filter: differences, products and sums make at most eight roundings one after the other, so the computed height is wrong
/// by less than 8 · 2^-53 (1 + small) of the sum of magnitudes.
int Builder::side(const Facet& facet, std::uint32_t point, double height) const noexcept {
    const auto& v = facet.triangle.vertex;
    const double bound = 1e-15 * glm::dot(facet.magnitude, glm::abs(points_[point] - points_[v[0]]));
    if (std::abs(height) > bound) return height > 0.0 ? 1 : -1;
    if (bound == 0.0) return 0;
    return orientation(points_[v[0]], points_[v[1]], points_[v[2]], points_[point]);
}

/// Puts `point` on the facet's list if it lies above it.
bool Builder::claim(std::uint32_t index, std::uint32_t point) {
    Facet& facet = facets_[index];
    const double h = height(facet, point);
    if (side(facet, point, h) <= 0) return false;
    if (facet.outside == kNone) pending_.push_back(index);
    next_[point] = facet.outside;
    facet.outside = point;
    if (facet.farthest == kNone || h > facet.farthest_height || (h == facet.farthest_height && point < facet.farthest)) {
        facet.farthest = point;
        facet.farthest_height = h;
    }
    return true;
}

std::uint32_t Builder::add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Facet facet;
    facet.triangle.vertex = {a, b, c};
    const dvec3 u = points_[b] - points_[a];
    const dvec3 v = points_[c] - points_[a];
    facet.normal = glm::cross(u, v);
    const dvec3 p = glm::abs(u);
    const dvec3 q = glm::abs(v);
    facet.magnitude = {p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
    facets_.push_back(facet);
    return static_cast<std::uint32_t>(facets_.size() - 1);
}

/// The first tetrahedron: two points farthest apart along an axis, the one farthest from their line, and the one farthest from
/// the plane of these.
bool Builder::start(double min_thickness) {
    const auto count = static_cast<std::uint32_t>(points_.size());
    std::uint32_t p[4] = {0, 0, 0, 0};
    double extent = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        std::uint32_t low = 0;
        std::uint32_t high = 0;
        for (std::uint32_t i = 1; i < count; ++i) {
            if (points_[i][axis] < points_[low][axis]) low = i;
            if (points_[i][axis] > points_[high][axis]) high = i;
        }
        if (points_[high][axis] - points_[low][axis] > extent) {
            extent = points_[high][axis] - points_[low][axis];
            p[0] = low;
            p[1] = high;
        }
    }
    const dvec3 origin = points_[p[0]];
    const dvec3 along = points_[p[1]] - origin;
    double widest = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const dvec3 across = glm::cross(along, points_[i] - origin);
        if (const double square = glm::dot(across, across); square > widest) widest = square, p[2] = i;
    }
    if (!(std::sqrt(widest) > min_thickness * glm::length(along))) return false;
    const dvec3 normal = glm::cross(along, points_[p[2]] - origin);
    double highest = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (const double h = std::abs(glm::dot(normal, points_[i] - origin)); h > highest) highest = h, p[3] = i;
    }
    if (!(highest > min_thickness * glm::length(normal))) return false;
    const int sign = orientation(points_[p[0]], points_[p[1]], points_[p[2]], points_[p[3]]);
    if (sign == 0) return false;
    if (sign > 0) std::swap(p[0], p[1]);

    constexpr std::uint32_t kCorners[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    constexpr std::uint32_t kNeighbors[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
    for (int f = 0; f < 4; ++f) {
        const std::uint32_t facet = add_facet(p[kCorners[f][0]], p[kCorners[f][1]], p[kCorners[f][2]]);
        facets_[facet].triangle.neighbor = {kNeighbors[f][0], kNeighbors[f][1], kNeighbors[f][2]};
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        if (i == p[0] || i == p[1] || i == p[2] || i == p[3]) continue;
        for (std::uint32_t f = 0; f < 4 && !claim(f, i); ++f) {
        }
    }
    return true;
}

/// Collects the facets below `eye`, which are connected, and the edges around them.
void Builder::find_visible(std::uint32_t facet, std::uint32_t eye) {
    visible_.assign(1, facet);
    horizon_.clear();
    facets_[facet].seen_by = eye;
    for (std::size_t k = 0; k < visible_.size(); ++k) {
        const HullTriangle triangle = facets_[visible_[k]].triangle;
        for (std::uint32_t i = 0; i < 3; ++i) {
            Facet& other = facets_[triangle.neighbor[i]];
            if (other.seen_by == eye) continue;
            if (side(other, eye, height(other, eye)) > 0) {
                other.seen_by = eye;
                visible_.push_back(triangle.neighbor[i]);
            } else {
                horizon_.push_back({triangle.vertex[i], triangle.vertex[(i + 1) % 3], triangle.neighbor[i]});
            }
        }
    }
}

/// Replaces the visible facets by a fan from `eye` to the horizon. The horizon is one simple cycle, because visibility was
/// decided exactly, so each of its vertices starts one facet of the fan.
void Builder::cover(std::uint32_t eye) {
    first_new_ = static_cast<std::uint32_t>(facets_.size());
    for (const HorizonEdge& edge : horizon_) {
        const std::uint32_t facet = add_facet(edge.from, edge.to, eye);
        fan_[edge.from] = facet;
        facets_[facet].triangle.neighbor[0] = edge.beyond;
        HullTriangle& beyond = facets_[edge.beyond].triangle;
        beyond.neighbor[edge_from(beyond, edge.to)] = facet;
    }
    for (std::uint32_t facet = first_new_; facet < facets_.size(); ++facet) {
        const std::uint32_t after = fan_[facets_[facet].triangle.vertex[1]];
        facets_[facet].triangle.neighbor[1] = after;
        facets_[after].triangle.neighbor[2] = facet;
    }
}

/// Gives the points of the visible facets to the new ones. A point above none of these is inside the hull: above two facets that
/// share a horizon edge it would be above the new facet of that edge too.
void Builder::hand_over(std::uint32_t eye) {
    const auto end = static_cast<std::uint32_t>(facets_.size());
    for (const std::uint32_t index : visible_) {
        facets_[index].alive = false;
        for (std::uint32_t point = facets_[index].outside; point != kNone;) {
            const std::uint32_t following = next_[point];
            if (point != eye) {
                for (std::uint32_t f = first_new_; f < end && !claim(f, point); ++f) {
                }
            }
            point = following;
        }
    }
}

void Builder::run() {
    while (!pending_.empty()) {
        const std::uint32_t facet = pending_.back();
        pending_.pop_back();
        if (!facets_[facet].alive) continue;
        const std::uint32_t eye = facets_[facet].farthest;
        find_visible(facet, eye);
        cover(eye);
        hand_over(eye);
    }
}

std::vector<HullTriangle> Builder::triangles() const {
    std::vector<std::uint32_t> renumbered(facets_.size(), kNone);
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < facets_.size(); ++i) {
        if (facets_[i].alive) renumbered[i] = count++;
    }
    std::vector<HullTriangle> result;
    result.reserve(count);
    for (const Facet& facet : facets_) {
        if (!facet.alive) continue;
        result.push_back(facet.triangle);
        for (std::uint32_t& neighbor : result.back().neighbor) neighbor = renumbered[neighbor];
    }
    return result;
}

}  // namespace

std::vector<HullTriangle> triangle_hull(std::span<const dvec3> points, double min_thickness) {
    CAROM_ASSERT(points.size() >= 4 && points.size() < kNone);
    Builder builder(points);
    if (!builder.start(min_thickness)) return {};
    builder.run();
    return builder.triangles();
}

}  // namespace carom::detail
