#include <carom/narrowphase/detail/epa.hpp>
#include <carom/narrowphase/detail/epa_hull.hpp>

#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/gjk.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

constexpr double kMet = 1e-11;    // of the size: the bounds are as near as they need be
constexpr double kProven = 1e-6;  // of the size: as near as is promised

dvec3 support(std::span<const dvec3> points, const dvec3& direction) noexcept { return points[farthest_along(points, direction)]; }
dvec3 support(const TruncatedCone& solid, const dvec3& direction) noexcept { return solid.support(direction); }
dvec3 support(const ConvexCore& core, const dvec3& direction) noexcept { return core.support(direction).point; }

// Where the search begins.
dvec3 first_axis(const TruncatedCone& solid) noexcept { return solid.axis(); }
dvec3 first_axis(const ConvexCore&) noexcept { return {0.0, 1.0, 0.0}; }

template <class A, class B>
class Search {
public:
    Search(const A& a, const B& b, double size, const KnownDirection& known) noexcept : a_(a), b_(b), size_(size), known_(known) {}

    Penetration run() noexcept {
        std::array<EpaVertex, 4> points;
        const dvec3 axis = is_known() ? known_.normal : first_axis(a_);
        if (!first_points(axis, [this](const dvec3& u) { return probe(u); }, points) || !hull_.start(points)) return best_;
        whole_ = true;
        while (!hull_.full()) {
            const std::uint16_t f = hull_.nearest();
            if (f == EpaHull::kNone) break;
            const EpaFace face = hull_.face(f);
            const EpaVertex next = probe(face.normal);
            best_.proven = best_.depth - face.offset <= kProven * size_;
            if (is_known() && known_.depth - face.offset <= known_.excess) {
                best_.normal = known_.normal;
                best_.depth = known_.depth;
                best_.proven = true;
                break;
            }
            if (glm::dot(face.normal, next.w) - face.offset <= kEpaFlat * size_ || best_.depth - face.offset <= kMet * size_) break;
            if (whole_ = hull_.grow(next, f); !whole_) break;
        }
        if (best_.proven) settle();
        return best_;
    }

    [[nodiscard]] double floor() const noexcept { return whole_ ? hull_.proven_offset() : -std::numeric_limits<double>::infinity(); }

private:
    [[nodiscard]] bool is_known() const noexcept { return known_.normal != dvec3{0.0}; }

    // The support point along a unit direction, which is also a bound of the depth.
    EpaVertex probe(const dvec3& u) noexcept {
        EpaVertex v;
        v.on_a = support(a_, u);
        v.on_b = support(b_, -u);
        v.w = v.on_a - v.on_b;
        const double depth = glm::dot(u, v.w);
        if (depth < best_.depth || best_.normal == dvec3{0.0}) {
            best_.normal = u;
            best_.depth = depth;
            best_.on_a = v.on_a;
            best_.on_b = v.on_b;
        }
        return v;
    }

    // Where the two touch: the foot of the origin on the face that it lies in, by the weights of its corners. A flat part of the
    // difference is several faces, of which only one holds the foot. Where none does, the support points stand.
    void settle() noexcept {
        double most = -0.01;
        for (std::uint16_t f = 0; f < hull_.face_count(); ++f) {
            const EpaFace& face = hull_.face(f);
            if (!face.alive || face.offset > best_.depth + kProven * size_ || !(glm::dot(face.normal, best_.normal) > 0.999)) continue;
            const EpaVertex &p = hull_.vertex(face.corner[0]), &q = hull_.vertex(face.corner[1]), &r = hull_.vertex(face.corner[2]);
            const dvec3 foot = face.offset * face.normal, u = q.w - p.w, v = r.w - p.w, n = glm::cross(u, v);
            const double area = glm::dot(n, n);
            const double wq = glm::dot(glm::cross(foot - p.w, v), n) / area, wr = glm::dot(glm::cross(u, foot - p.w), n) / area;
            const double least = std::min({wq, wr, 1.0 - wq - wr});
            if (!(least > most)) continue;
            most = least;
            best_.on_a = p.on_a + wq * (q.on_a - p.on_a) + wr * (r.on_a - p.on_a);
            best_.on_b = p.on_b + wq * (q.on_b - p.on_b) + wr * (r.on_b - p.on_b);
        }
    }

    const A& a_;
    const B& b_;
    double size_;
    KnownDirection known_;
    Penetration best_;
    EpaHull hull_;
    bool whole_ = false;  // the hull is a closed surface
};

}  // namespace

Penetration penetration(const TruncatedCone& a, std::span<const dvec3> b, double size, const KnownDirection& known) noexcept {
    return Search<TruncatedCone, std::span<const dvec3>>(a, b, size, known).run();
}
Penetration penetration(const TruncatedCone& a, const TruncatedCone& b, double size, const KnownDirection& known) noexcept {
    return Search<TruncatedCone, TruncatedCone>(a, b, size, known).run();
}
Penetration penetration(const ConvexCore& a, const ConvexCore& b, double size) noexcept {
    Search<ConvexCore, ConvexCore> search(a, b, size, {});
    Penetration p = search.run();
    p.floor = search.floor();
    return p;
}

}  // namespace carom::detail
