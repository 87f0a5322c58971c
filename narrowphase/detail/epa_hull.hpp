// The polytope of the expanding-polytope algorithm: a closed surface of triangles between support points that grows outward.
//
//   EpaHull hull;
//   if (first_points(axis, probe, points) && hull.start(points)) hull.grow(probe(normal), hull.nearest());
#pragma once

#include <carom/core/math.hpp>
#include <carom/core/types.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace carom::detail {

inline constexpr std::size_t kEpaVertices = 128;
inline constexpr std::size_t kEpaFaces = 4 * kEpaVertices;  ///< a closed surface of V corners has 2 V - 4 triangles, before a step and after
inline constexpr double kEpaFlat = 1e-14;                   ///< of the size: what rounding makes of a point in a face's plane

/// A point of the difference of two sets.
struct EpaVertex {
    dvec3 w{0.0};  ///< on_a - on_b
    dvec3 on_a{0.0};
    dvec3 on_b{0.0};
};

/// Corner i + 1 follows corner i counter-clockwise seen from outside; beyond the edge between them lies face `next[i]`, in which that
/// edge is number `edge[i]`.
struct EpaFace {
    std::array<std::uint16_t, 3> corner{};
    std::array<std::uint16_t, 3> next{};
    std::array<std::uint8_t, 3> edge{};
    bool alive = false;
    dvec3 normal{0.0};
    double offset = 0.0;
};

/// The growing polytope.
class EpaHull {
public:
    [[nodiscard]] const EpaVertex& vertex(std::size_t i) const noexcept { return vertices_[i]; }
    [[nodiscard]] const EpaFace& face(std::size_t i) const noexcept { return faces_[i]; }
    [[nodiscard]] std::uint16_t face_count() const noexcept { return face_count_; }
    [[nodiscard]] double extent() const noexcept { return extent_; }
    [[nodiscard]] bool full() const noexcept { return vertex_count_ == kEpaVertices; }

    /// @return false where four points have no volume.
    bool start(const std::array<EpaVertex, 4>& points) noexcept {
        const dvec3 n = glm::cross(points[1].w - points[0].w, points[2].w - points[0].w);
        const bool turned = glm::dot(n, points[3].w - points[0].w) > 0.0;
        for (std::size_t i = 0; i < 4; ++i) vertices_[i] = points[i];
        vertex_count_ = 4;
        constexpr std::uint16_t kCorners[2][4][3] = {{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}},
                                                     {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
        for (const auto& c : kCorners[turned ? 1 : 0]) {
            if (add_face(c[0], c[1], c[2]) == kNone) return false;
        }
        for (std::uint16_t f = 0; f < 4; ++f) {
            for (std::uint8_t e = 0; e < 3; ++e) {
                for (std::uint16_t g = 0; g < 4; ++g) {
                    for (std::uint8_t k = 0; k < 3; ++k) {
                        if (faces_[g].corner[k] == faces_[f].corner[(e + 1) % 3] && faces_[g].corner[(k + 1) % 3] == faces_[f].corner[e]) {
                            join(f, e, g, k);
                        }
                    }
                }
            }
        }
        return true;
    }

    /// The living face whose plane is nearest to the origin, or farthest behind it.
    [[nodiscard]] std::uint16_t nearest() const noexcept {
        std::uint16_t best = kNone;
        for (std::uint16_t f = 0; f < face_count_; ++f) {
            if (faces_[f].alive && (best == kNone || faces_[f].offset < faces_[best].offset)) best = f;
        }
        return best;
    }

    /// Replaces what the point sees by the faces between it and the horizon. `seen` is a face that it sees.
    /// @return false where rounding spoiled the horizon or a new face has no area; the hull is of no use then.
    bool grow(const EpaVertex& point, std::uint16_t seen) noexcept {
        const auto apex = static_cast<std::uint16_t>(vertex_count_);
        vertices_[vertex_count_++] = point;
        first_new_ = last_new_ = kNone;
        removed_count_ = 0;
        remove(seen);
        for (std::uint8_t e = 0; e < 3; ++e) {
            if (!walk(apex, faces_[seen].next[e], faces_[seen].edge[e])) return false;
        }
        // Only now, because the walk still read what it had removed.
        for (std::size_t i = 0; i < removed_count_; ++i) free_[free_count_++] = removed_[i];
        if (first_new_ == kNone) return false;
        join(last_new_, 1, first_new_, 2);
        return faces_[last_new_].corner[1] == faces_[first_new_].corner[0];
    }

    /// @return how far the origin surely is from the outside: the least offset of a face, less what rounding may do to it. Where it is
    /// above the error of the points, each face makes a tetrahedron of positive volume with the origin; a closed surface of such
    /// winds round the origin, so that the points' hull holds it, and a ball of that radius about it.
    [[nodiscard]] double proven_offset() const noexcept {
        double least = extent_;
        for (std::uint16_t f = 0; f < face_count_; ++f) {
            if (!faces_[f].alive) continue;
            const dvec3 &p = vertices_[faces_[f].corner[0]].w, &q = vertices_[faces_[f].corner[1]].w, &r = vertices_[faces_[f].corner[2]].w;
            const dvec3 u = q - p, v = r - p, n = glm::cross(u, v);
            const double area = std::sqrt(glm::dot(n, n)), sides = std::sqrt(glm::dot(u, u) * glm::dot(v, v));
            // The cross product errs by 8 roundings of `sides`, the dot product by 4 of the corner's length.
            const double reach = std::sqrt(glm::dot(p, p));
            least = std::min(least, (glm::dot(n, p) - 0x1p-50 * sides * reach) / area - 0x1p-50 * reach);
        }
        return least;
    }

    static constexpr std::uint16_t kNone = 0xffff;

private:
    void remove(std::uint16_t f) noexcept {
        faces_[f].alive = false;
        removed_[removed_count_++] = f;
    }

    void join(std::uint16_t f, std::uint8_t e, std::uint16_t g, std::uint8_t k) noexcept {
        faces_[f].next[e] = g;
        faces_[f].edge[e] = k;
        faces_[g].next[k] = f;
        faces_[g].edge[k] = e;
    }

    // Walks round what the point sees, from face `f` across its edge `e`, and builds the new faces in the order of the horizon.
    // Recursion is no deeper than the hull has faces.
    bool walk(std::uint16_t apex, std::uint16_t f, std::uint8_t e) noexcept {
        if (!faces_[f].alive) return true;
        const dvec3& w = vertices_[apex].w;
        if (glm::dot(faces_[f].normal, w) - faces_[f].offset > kEpaFlat * extent_) {
            remove(f);
            const auto e1 = static_cast<std::uint8_t>((e + 1) % 3), e2 = static_cast<std::uint8_t>((e + 2) % 3);
            return walk(apex, faces_[f].next[e1], faces_[f].edge[e1]) && walk(apex, faces_[f].next[e2], faces_[f].edge[e2]);
        }
        const std::uint16_t a = faces_[f].corner[(e + 1) % 3], b = faces_[f].corner[e];
        const std::uint16_t made = add_face(a, b, apex);
        if (made == kNone) return false;
        join(made, 0, f, e);
        if (first_new_ == kNone) {
            first_new_ = made;
        } else {
            // The horizon is a loop: each face begins where the one before ends.
            if (faces_[last_new_].corner[1] != a) return false;
            join(last_new_, 1, made, 2);
        }
        last_new_ = made;
        return true;
    }

    std::uint16_t add_face(std::uint16_t a, std::uint16_t b, std::uint16_t c) noexcept {
        const dvec3 &p = vertices_[a].w, &q = vertices_[b].w, &r = vertices_[c].w;
        const dvec3 u = q - p, v = r - p, n = glm::cross(u, v);
        const double area = std::sqrt(glm::dot(n, n));
        if (!(area > 1e-15 * std::sqrt(glm::dot(u, u) * glm::dot(v, v)))) return kNone;
        if (free_count_ == 0 && face_count_ == kEpaFaces) return kNone;
        const std::uint16_t f = free_count_ > 0 ? free_[--free_count_] : face_count_++;
        extent_ = std::max({extent_, std::abs(p.x), std::abs(p.y), std::abs(p.z), std::abs(r.x), std::abs(r.y), std::abs(r.z)});
        faces_[f] = {{a, b, c}, {}, {}, true, n / area, 0.0};
        faces_[f].offset = std::max({glm::dot(faces_[f].normal, p), glm::dot(faces_[f].normal, q), glm::dot(faces_[f].normal, r)});
        return f;
    }

    std::array<EpaVertex, kEpaVertices> vertices_;
    std::array<EpaFace, kEpaFaces> faces_;
    std::size_t vertex_count_ = 0;
    std::array<std::uint16_t, kEpaFaces> free_, removed_;
    std::size_t free_count_ = 0, removed_count_ = 0;
    std::uint16_t face_count_ = 0;
    std::uint16_t first_new_ = kNone, last_new_ = kNone;
    double extent_ = 0.0;
};

/// Four support points with as much volume as a few directions give.
template <class Probe>
bool first_points(const dvec3& axis, const Probe& probe, std::array<EpaVertex, 4>& p) noexcept {
    p[0] = probe(axis);
    p[1] = probe(-axis);
    const dvec3 line = p[1].w - p[0].w;
    const double line_sq = glm::dot(line, line);
    if (!(line_sq > 0.0)) return false;
    const dvec3 side = any_perpendicular(line / std::sqrt(line_sq));
    const dvec3 other = glm::cross(line / std::sqrt(line_sq), side);
    double most = 0.0;
    for (const dvec3& u : {side, -side, other, -other}) {
        const EpaVertex v = probe(u);
        const dvec3 n = glm::cross(line, v.w - p[0].w);
        if (glm::dot(n, n) > most) {
            most = glm::dot(n, n);
            p[2] = v;
        }
    }
    if (!(most > 0.0)) return false;
    const dvec3 n = glm::cross(line, p[2].w - p[0].w) / std::sqrt(most);
    const EpaVertex above = probe(n), below = probe(-n);
    const double up = glm::dot(n, above.w - p[0].w), down = glm::dot(n, p[0].w - below.w);
    p[3] = up > down ? above : below;
    return std::max(up, down) > 0.0;
}

}  // namespace carom::detail
