#include <carom/narrowphase/detail/proximity.hpp>

#include <carom/narrowphase/detail/epa_hull.hpp>
#include <carom/narrowphase/detail/search_points.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

double length_sq(const dvec3& v) noexcept { return glm::dot(v, v); }

class Search {
public:
    // @param known  bounds of an earlier search, or nothing.
    Search(const CorePair& pair, const ProximityGoal& goal, const Proximity& known) noexcept
        : pair_(pair), goal_(goal), curved_(pair.a.curved() || pair.b.curved()), result_(known) {
        if (known.iterations == 0) result_.upper = std::numeric_limits<double>::infinity();
    }

    Proximity run(DistanceCache* cache) noexcept {
        const bool resumed = cache != nullptr && resume(*cache);  // from a tetrahedron there would be no upper bound, if it proves nothing
        if (!resumed) begin();
        look();
        if (resumed && result_.status == DistanceStatus::Rounding) {  // the corners may lie on a line, from which no search goes on
            begin();
            look();
        }
        if (cache != nullptr) keep(*cache);
        if (result_.status == DistanceStatus::Overlap) result_.lower = result_.upper = 0.0;
        return result_;
    }

private:
    void look() noexcept {
        result_.status = search();
        if (result_.status == DistanceStatus::Rounding) result_.status = square_to_feature();
    }

    // The support plane across `v` counts as a bound; its point is returned. `v` points from b to a.
    Corner probe(const dvec3& v, double length) noexcept {
        Corner next;
        probe(v, length, next);
        return next;
    }
    void probe(const dvec3& v, double length, Corner& next) noexcept {
        CoreSupport of_a, of_b;
        supports(pair_.a, pair_.b, -v, of_a, of_b);
        next = {of_a.point - of_b.point, of_a.point, of_b.point, of_a.index, of_b.index, 1.0};
        const double bound = glm::dot(v, next.w) / length - pair_.rounding;
        if (bound > result_.lower) {
            result_.lower = bound;
            result_.normal = v * (-1.0 / length);
        }
        ++result_.iterations;
    }

    void begin() noexcept {
        simplex_.count = 0;
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
        simplex_.count = 0;
        for (std::uint32_t i = 0; i < cache.count; ++i) {
            if (cache.a[i] >= pair_.a.count() || cache.b[i] >= pair_.b.count()) return false;
            const dvec3 on_a = pair_.a.place(cache.a[i]), on_b = pair_.b.place(cache.b[i]);
            simplex_.add({on_a - on_b, on_a, on_b, cache.a[i], cache.b[i], 1.0}, 1.0);
        }
        simplex_.keep(nearest_part(simplex_, false));
        return simplex_.count < 4 || is_finite(result_.upper) || holds_origin(simplex_, pair_.rounding);
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
        note_witness();
    }
    void note_witness() noexcept {
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
            Corner& next = simplex_.add();
            probe(v, length, next);
            const bool ends = met();
            if (ends || !grow(next, length * length)) {
                simplex_.drop_last();
                return ends ? DistanceStatus::Converged : DistanceStatus::Rounding;
            }
        }
    }

    // Keeps what is nearest of the simplex, whose last corner is new.
    // @return whether it is nearer than before; otherwise all corners are still there.
    bool grow(const Corner& next, double before_sq) noexcept {
        for (int i = 0; i + 1 < simplex_.count; ++i) {
            if (simplex_[i].w == next.w) return false;
        }
        const SimplexPart part = nearest_part(simplex_, curved_);
        if (part.count == 4 || length_sq(part_point(simplex_, part)) < before_sq) {
            simplex_.keep(part);
            return true;
        }
        if (!curved_) return false;
        const Simplex smaller = nearest_on_segment(merged(), next);
        if (!(length_sq(smaller.point()) < before_sq)) return false;
        simplex_ = smaller;
        return true;
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

    // The simplex's point without its last corner, as one corner. Between it and a support point beyond there is always a nearer one, whatever
    // rounding makes of the simplex itself.
    [[nodiscard]] Corner merged() const noexcept {
        Corner c;
        for (int i = 0; i + 1 < simplex_.count; ++i) {
            const Corner& corner = simplex_[i];
            c.w += corner.weight * corner.w;
            c.on_a += corner.weight * corner.on_a;
            c.on_b += corner.weight * corner.on_b;
        }
        return c;
    }

    // The origin is in or near the difference: a polytope grows until it holds the origin surely, or a plane passes it by.
    DistanceStatus enclose() noexcept {
        const Simplex last = simplex_;
        for (const auto& f : kTetrahedronFaces) {
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
        simplex_.count = 0;
        for (const Corner& c : triangle) simplex_.add(c, 1.0);
        simplex_.keep(nearest_part(simplex_, true));
        note_upper(std::sqrt(length_sq(simplex_.point())));
        simplex_ = kept;
    }

    const CorePair& pair_;
    const ProximityGoal& goal_;
    bool curved_;
    Simplex simplex_;
    Proximity result_;
};

// By itself, as what it returns stays where it is: what was just written number by number is slow to copy.
Proximity find_by_points(const CorePair& pair, const ProximityGoal& goal) noexcept {
    Proximity known;
    DistanceCache last;
    if (!search_points(pair, goal, known, last)) known = Search(pair, goal, known).run(&last);
    return known;
}

}  // namespace

Proximity find_proximity(const CorePair& pair, const ProximityGoal& goal, DistanceCache* cache) noexcept {
    return cache == nullptr && is_searched_by_points(pair) ? find_by_points(pair, goal) : Search(pair, goal, {}).run(cache);
}

}  // namespace carom::detail
