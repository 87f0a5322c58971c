#include <carom/narrowphase/detail/epa.hpp>

#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/gjk.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace carom::detail {
namespace {

constexpr std::size_t kMaxVertices = 128;
constexpr std::size_t kMaxFaces = 4 * kMaxVertices;  // a closed surface of V corners has 2 V - 4 triangles, before a step and after
constexpr double kMet = 1e-11;                       // of the size: the bounds are as near as they need be
constexpr double kProven = 1e-6;                     // of the size: as near as is promised
constexpr double kFlat = 1e-14;                      // of the size: what rounding makes of a point in a face's plane

dvec3 support(std::span<const dvec3> points, const dvec3& direction) noexcept { return points[farthest_along(points, direction)]; }
dvec3 support(const TruncatedCone& solid, const dvec3& direction) noexcept { return solid.support(direction); }

struct Vertex {
    dvec3 w{0.0};  // on_a - on_b
    dvec3 on_a{0.0};
    dvec3 on_b{0.0};
};

// Corner i + 1 follows corner i counter-clockwise seen from outside; beyond the edge between them lies face `next[i]`, in which that
// edge is number `edge[i]`.
struct Face {
    std::array<std::uint16_t, 3> corner{};
    std::array<std::uint16_t, 3> next{};
    std::array<std::uint8_t, 3> edge{};
    bool alive = false;
    dvec3 normal{0.0};
    double offset = 0.0;
};

// The growing polytope.
class Hull {
public:
    [[nodiscard]] const Vertex& vertex(std::size_t i) const noexcept { return vertices_[i]; }
    [[nodiscard]] const Face& face(std::size_t i) const noexcept { return faces_[i]; }
    [[nodiscard]] std::uint16_t face_count() const noexcept { return face_count_; }
    [[nodiscard]] bool full() const noexcept { return vertex_count_ == kMaxVertices; }

    // @return false where four points have no volume.
    bool start(const std::array<Vertex, 4>& points) noexcept {
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

    // The living face whose plane is nearest to the origin, or farthest behind it.
    [[nodiscard]] std::uint16_t nearest() const noexcept {
        std::uint16_t best = kNone;
        for (std::uint16_t f = 0; f < face_count_; ++f) {
            if (faces_[f].alive && (best == kNone || faces_[f].offset < faces_[best].offset)) best = f;
        }
        return best;
    }

    // Replaces what the point sees by the faces between it and the horizon. `seen` is a face that it sees.
    // @return false where rounding spoiled the horizon or a new face has no area; the hull is of no use then.
    bool grow(const Vertex& point, std::uint16_t seen) noexcept {
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
        if (glm::dot(faces_[f].normal, w) - faces_[f].offset > kFlat * extent_) {
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
        if (free_count_ == 0 && face_count_ == kMaxFaces) return kNone;
        const std::uint16_t f = free_count_ > 0 ? free_[--free_count_] : face_count_++;
        extent_ = std::max({extent_, std::abs(p.x), std::abs(p.y), std::abs(p.z), std::abs(r.x), std::abs(r.y), std::abs(r.z)});
        faces_[f] = {{a, b, c}, {}, {}, true, n / area, 0.0};
        faces_[f].offset = std::max({glm::dot(faces_[f].normal, p), glm::dot(faces_[f].normal, q), glm::dot(faces_[f].normal, r)});
        return f;
    }

    std::array<Vertex, kMaxVertices> vertices_;
    std::array<Face, kMaxFaces> faces_;
    std::size_t vertex_count_ = 0;
    std::array<std::uint16_t, kMaxFaces> free_, removed_;
    std::size_t free_count_ = 0, removed_count_ = 0;
    std::uint16_t face_count_ = 0;
    std::uint16_t first_new_ = kNone, last_new_ = kNone;
    double extent_ = 0.0;
};

template <class A, class B>
class Search {
public:
    Search(const A& a, const B& b, double size, const KnownDirection& known) noexcept : a_(a), b_(b), size_(size), known_(known) {}

    Penetration run() noexcept {
        std::array<Vertex, 4> points;
        if (!first_points(points) || !hull_.start(points)) return best_;
        while (!hull_.full()) {
            const std::uint16_t f = hull_.nearest();
            if (f == Hull::kNone) break;
            const Face face = hull_.face(f);
            const Vertex next = probe(face.normal);
            best_.proven = best_.depth - face.offset <= kProven * size_;
            if (is_known() && known_.depth - face.offset <= known_.excess) {
                best_.normal = known_.normal;
                best_.depth = known_.depth;
                best_.proven = true;
                break;
            }
            if (glm::dot(face.normal, next.w) - face.offset <= kFlat * size_ || best_.depth - face.offset <= kMet * size_) break;
            if (!hull_.grow(next, f)) break;
        }
        if (best_.proven) settle();
        return best_;
    }

private:
    [[nodiscard]] bool is_known() const noexcept { return known_.normal != dvec3{0.0}; }

    // The support point along a unit direction, which is also a bound of the depth.
    Vertex probe(const dvec3& u) noexcept {
        Vertex v;
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

    // Four support points with as much volume as a few directions give.
    bool first_points(std::array<Vertex, 4>& p) noexcept {
        const dvec3& axis = is_known() ? known_.normal : a_.axis();
        p[0] = probe(axis);
        p[1] = probe(-axis);
        const dvec3 line = p[1].w - p[0].w;
        const double line_sq = glm::dot(line, line);
        if (!(line_sq > 0.0)) return false;
        const dvec3 side = any_perpendicular(line / std::sqrt(line_sq));
        const dvec3 other = glm::cross(line / std::sqrt(line_sq), side);
        double most = 0.0;
        for (const dvec3& u : {side, -side, other, -other}) {
            const Vertex v = probe(u);
            const dvec3 n = glm::cross(line, v.w - p[0].w);
            if (glm::dot(n, n) > most) {
                most = glm::dot(n, n);
                p[2] = v;
            }
        }
        if (!(most > 0.0)) return false;
        const dvec3 n = glm::cross(line, p[2].w - p[0].w) / std::sqrt(most);
        const Vertex above = probe(n), below = probe(-n);
        const double up = glm::dot(n, above.w - p[0].w), down = glm::dot(n, p[0].w - below.w);
        p[3] = up > down ? above : below;
        return std::max(up, down) > 0.0;
    }

    // Where the two touch: the foot of the origin on the face that it lies in, by the weights of its corners. A flat part of the
    // difference is several faces, of which only one holds the foot. Where none does, the support points stand.
    void settle() noexcept {
        double most = -0.01;
        for (std::uint16_t f = 0; f < hull_.face_count(); ++f) {
            const Face& face = hull_.face(f);
            if (!face.alive || face.offset > best_.depth + kProven * size_ || !(glm::dot(face.normal, best_.normal) > 0.999)) continue;
            const Vertex &p = hull_.vertex(face.corner[0]), &q = hull_.vertex(face.corner[1]), &r = hull_.vertex(face.corner[2]);
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
    Hull hull_;
};

}  // namespace

Penetration penetration(const TruncatedCone& a, std::span<const dvec3> b, double size, const KnownDirection& known) noexcept {
    return Search<TruncatedCone, std::span<const dvec3>>(a, b, size, known).run();
}
Penetration penetration(const TruncatedCone& a, const TruncatedCone& b, double size, const KnownDirection& known) noexcept {
    return Search<TruncatedCone, TruncatedCone>(a, b, size, known).run();
}

}  // namespace carom::detail
