#include <carom/narrowphase/detail/proximity.hpp>

#include <carom/narrowphase/detail/epa_hull.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};  // of a tetrahedron, with the corner opposite

// Whether the origin lies in the tetrahedron, deeper than `rounding` behind each face: then it is in that of the exact corners too.
bool holds_origin(const Simplex& t, double rounding) noexcept {
    for (const auto& f : kFaces) {
        const dvec3 &a = t[f[0]].w, u = t[f[1]].w - a, v = t[f[2]].w - a, n = glm::cross(u, v);
        const double slack = rounding * std::sqrt(glm::dot(n, n)) +
                             0x1p-49 * std::sqrt(glm::dot(u, u) * glm::dot(v, v)) * (std::sqrt(glm::dot(a, a)) + rounding);
        const double inside = glm::dot(n, t[f[3]].w - a), origin = -glm::dot(n, a);
        if (!(std::abs(origin) > slack) || !(std::abs(inside) > slack) || (origin > 0.0) != (inside > 0.0)) return false;
    }
    return true;
}

class Search {
public:
    Search(const CorePair& pair, const ProximityGoal& goal) noexcept
        : pair_(pair), goal_(goal), curved_(pair.a.curved() || pair.b.curved()) {
        result_.upper = std::numeric_limits<double>::infinity();
    }

    Proximity run(DistanceCache* cache) noexcept {
        if (cache == nullptr || !resume(*cache)) begin();  // from a tetrahedron there would be no upper bound, if it proves nothing
        result_.status = search();
        if (result_.status == DistanceStatus::Rounding) result_.status = square_to_feature();
        if (cache != nullptr) keep(*cache);
        if (result_.status == DistanceStatus::Overlap) result_.lower = result_.upper = 0.0;
        return result_;
    }

private:
    // The support plane across `v` counts as a bound; its point is returned. `v` points from b to a.
    Corner probe(const dvec3& v, double length) noexcept {
        const CoreSupport of_a = pair_.a.support(-v), of_b = pair_.b.support(v);
        const Corner next{of_a.point - of_b.point, of_a.point, of_b.point, of_a.index, of_b.index, 1.0};
        const double bound = glm::dot(v, next.w) / length - pair_.rounding;
        if (bound > result_.lower) {
            result_.lower = bound;
            result_.normal = v * (-1.0 / length);
        }
        ++result_.iterations;
        return next;
    }

    void begin() noexcept {
        simplex_ = {};
        dvec3 v = pair_.a.centre - pair_.b.centre;
        double length = std::sqrt(glm::dot(v, v));
        if (!(length > 0.0)) {
            v = {0.0, 1.0, 0.0};
            length = 1.0;
        }
        simplex_.add(probe(v, length), 1.0);
    }

    bool resume(const DistanceCache& cache) noexcept {
        if (curved_ || cache.count == 0 || cache.count > 4) return false;
        Simplex kept;
        for (std::uint32_t i = 0; i < cache.count; ++i) {
            if (cache.a[i] >= pair_.a.count() || cache.b[i] >= pair_.b.count()) return false;
            const dvec3 on_a = pair_.a.place(cache.a[i]), on_b = pair_.b.place(cache.b[i]);
            kept.add({on_a - on_b, on_a, on_b, cache.a[i], cache.b[i], 1.0}, 1.0);
        }
        simplex_ = nearest(kept, false);
        return simplex_.count < 4 || holds_origin(simplex_, pair_.rounding);
    }

    void keep(DistanceCache& cache) const noexcept {
        cache = {};
        if (curved_) return;
        for (int i = 0; i < simplex_.count; ++i) {
            cache.a[cache.count] = static_cast<std::uint32_t>(simplex_[i].index_a);
            cache.b[cache.count++] = static_cast<std::uint32_t>(simplex_[i].index_b);
        }
    }

    // The simplex's point is a point of the difference: an upper bound.
    void note_upper(double length) noexcept {
        if (length + pair_.rounding >= result_.upper) return;
        result_.upper = length + pair_.rounding;
        result_.on_a = result_.on_b = dvec3{0.0};
        for (int i = 0; i < simplex_.count; ++i) {
            result_.on_a += simplex_[i].weight * simplex_[i].on_a;
            result_.on_b += simplex_[i].weight * simplex_[i].on_b;
        }
    }

    [[nodiscard]] bool met() const noexcept { return result_.upper - result_.lower <= 3.0 * pair_.rounding + slack() * result_.upper; }
    [[nodiscard]] double slack() const noexcept { return std::max(goal_.tolerance, curved_ ? 1e-12 : 0.0); }

    DistanceStatus search() noexcept {
        double last = std::numeric_limits<double>::infinity();
        while (true) {
            if (simplex_.count == 4) return holds_origin(simplex_, pair_.rounding) ? DistanceStatus::Overlap : enclose();
            const dvec3 v = simplex_.point();
            const double length = std::sqrt(glm::dot(v, v));
            note_upper(length);
            if (!(length > 4.0 * pair_.rounding)) return enclose();
            if (goal_.decide >= 0.0 && (result_.lower > goal_.decide || result_.upper < goal_.decide)) return DistanceStatus::Converged;
            if (met()) return DistanceStatus::Converged;
            if (!(length < last)) return DistanceStatus::Rounding;
            if (result_.iterations >= goal_.most_iterations) return DistanceStatus::Stopped;
            last = length;
            const Corner next = probe(v, length);
            if (met()) return DistanceStatus::Converged;
            for (int i = 0; i < simplex_.count; ++i) {
                if (simplex_[i].w == next.w) return DistanceStatus::Rounding;
            }
            Simplex grown = simplex_;
            grown.add(next, 1.0);
            Simplex smaller = nearest(grown, curved_);
            if (curved_ && smaller.count < 4 && !(length_sq(smaller) < length * length)) smaller = nearest_on_segment(merged(), next);
            if (smaller.count < 4 && !(length_sq(smaller) < length * length)) return DistanceStatus::Rounding;
            simplex_ = smaller;
        }
    }

    // Near contact the direction between the witnesses is lost to rounding; square to the features that they lie on it is not. The
    // simplex's triangle is of a face or of two edges, its line of an edge and a corner.
    DistanceStatus square_to_feature() noexcept {
        dvec3 n{0.0};
        if (simplex_.count == 3) {
            n = glm::cross(simplex_[1].w - simplex_[0].w, simplex_[2].w - simplex_[0].w);
            if (glm::dot(n, simplex_[0].w) < 0.0) n = -n;
        } else if (simplex_.count == 2) {
            const dvec3 edge = simplex_[1].w - simplex_[0].w, v = simplex_.point();
            n = v - (glm::dot(v, edge) / glm::dot(edge, edge)) * edge;
        }
        const double length = std::sqrt(glm::dot(n, n));
        if (length > 0.0) probe(n, length);
        return met() ? DistanceStatus::Converged : enclose();
    }

    // The simplex's point as one corner. Between it and a support point beyond there is always a nearer one, whatever rounding makes of the
    // simplex itself.
    [[nodiscard]] Corner merged() const noexcept {
        Corner c;
        for (int i = 0; i < simplex_.count; ++i) {
            c.on_a += simplex_[i].weight * simplex_[i].on_a;
            c.on_b += simplex_[i].weight * simplex_[i].on_b;
        }
        c.w = simplex_.point();
        return c;
    }

    // The origin is in or near the difference: a polytope grows until it holds the origin surely, or a plane passes it by.
    DistanceStatus enclose() noexcept {
        const Simplex last = simplex_;
        for (const auto& f : kFaces) {
            if (last.count == 4) note_triangle({last[f[0]], last[f[1]], last[f[2]]});
        }
        EpaHull hull;
        std::array<EpaVertex, 4> points;
        const auto look = [this](const dvec3& u) {
            const Corner c = probe(-u, 1.0);
            return EpaVertex{c.w, c.on_a, c.on_b};
        };
        if (!first_points(dvec3{0.0, 1.0, 0.0}, look, points) || !hull.start(points)) return DistanceStatus::Rounding;
        std::uint16_t f = hull.nearest();
        while (f != EpaHull::kNone) {
            const EpaFace face = hull.face(f);
            if (face.offset > 2.0 * pair_.rounding && hull.proven_offset() > pair_.rounding) return DistanceStatus::Overlap;
            const EpaVertex next = look(face.normal);
            const auto corner = [&](std::size_t k) {
                const EpaVertex& v = hull.vertex(face.corner[k]);
                return Corner{v.w, v.on_a, v.on_b, 0, 0, 1.0};
            };
            note_triangle({corner(0), corner(1), corner(2)});
            const bool is_last = glm::dot(face.normal, next.w) - face.offset <= kEpaFlat * hull.extent() || hull.full();
            if (is_last || (result_.lower > 0.0 && met()) || !hull.grow(next, f)) break;
            f = hull.nearest();
        }
        return met() ? DistanceStatus::Converged : DistanceStatus::Rounding;
    }

    // A triangle's points are of the difference.
    void note_triangle(const std::array<Corner, 3>& triangle) noexcept {
        const Simplex kept = simplex_;
        simplex_ = {};
        for (const Corner& c : triangle) simplex_.add(c, 1.0);
        simplex_ = nearest(simplex_, true);
        note_upper(std::sqrt(length_sq(simplex_)));
        simplex_ = kept;
    }

    const CorePair& pair_;
    const ProximityGoal& goal_;
    bool curved_;
    Simplex simplex_;
    Proximity result_;
};

}  // namespace

Proximity find_proximity(const CorePair& pair, const ProximityGoal& goal, DistanceCache* cache) noexcept {
    return Search(pair, goal).run(cache);
}

}  // namespace carom::detail
