#include <carom/narrowphase/detail/epa.hpp>
#include <carom/narrowphase/detail/gjk.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/turned_contact.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace carom::detail {
namespace {

constexpr double kSideExcess = 1e-10;  // of the size: ten times what EPA's bounds leave open

// A direction that is exactly that of a feature.
struct Candidate {
    dvec3 normal{0.0};  // from a to b
    AxisKind kind = AxisKind::Edges;
    std::uint32_t feature_a = 0, feature_b = 0;
};

double reach_of(std::span<const dvec3> points, const dvec3& direction) noexcept {
    double reach = glm::dot(points[0], direction);
    for (const dvec3& p : points) reach = std::max(reach, glm::dot(p, direction));
    return reach;
}
double reach_of(const TruncatedCone& solid, const dvec3& direction) noexcept { return solid.reach(direction); }

double slope_of_side(const TruncatedCone& solid) noexcept { return glm::dot(solid.side_normal(solid.axes[0]), solid.axis()); }

// Of the directions of features that were offered the one of least overlap.
template <class B>
class Best {
public:
    Best(const TruncatedCone& a, const B& b) noexcept : a_(a), b_(b) {}

    void offer(const Candidate& c, double overlap) noexcept {
        if (found && !(overlap < depth)) return;
        candidate = c;
        depth = overlap;
        found = true;
    }
    void offer(const Candidate& c) noexcept { offer(c, a_.reach(c.normal) + reach_of(b_, -c.normal)); }
    void offer_ends_of_a() noexcept {
        offer({-a_.axis(), AxisKind::FaceOfA, 0, 0});
        if (a_.upper_radius > 0.0) offer({a_.axis(), AxisKind::FaceOfA, 1, 0});
    }
    // The unit vectors n with dot(n, u) = along_u and dot(n, v) = along_v: normals to the sides of two solids, or to a side and a line.
    void offer_common_normals(const dvec3& u, double along_u, const dvec3& v, double along_v) noexcept {
        const dvec3 c = glm::cross(u, v);
        const double cosine = glm::dot(u, v), sine_sq = glm::dot(c, c);
        if (!(sine_sq > kParallelSine * kParallelSine)) return;
        const double x = (along_u - cosine * along_v) / sine_sq, y = (along_v - cosine * along_u) / sine_sq;
        const double z_sq = (1.0 - x * along_u - y * along_v) / sine_sq;
        if (!(z_sq >= 0.0)) return;
        for (const double z : {std::sqrt(z_sq), -std::sqrt(z_sq)}) {
            const dvec3 n = x * u + y * v + z * c;
            offer({n / std::sqrt(glm::dot(n, n))});
        }
    }

    Candidate candidate;
    double depth = 0.0;
    bool found = false;

private:
    const TruncatedCone& a_;
    const B& b_;
};

// The largest size, which rounding goes with, and that which depths are to be right to shares of.
struct PairSize {
    double largest = 0.0, tolerated = 0.0;
};

// @param known   offers the directions that can be said beforehand.
// @param nearby  offers those next to the direction that EPA found.
template <class B, class Known, class Nearby>
bool axis_of(const TruncatedCone& a, const B& b, const PairSize& size, double margin, const Known& known, const Nearby& nearby,
             ContactAxis& axis, CollideStatus& status) {
    const GjkResult apart = gjk(a, b, margin);
    if (apart.beyond) return false;
    if (apart.converged) {
        if (apart.distance > margin) return false;
        if (apart.distance > kTouching * size.largest) {
            axis = {AxisKind::Distance, (apart.on_b - apart.on_a) / apart.distance, apart.distance, apart.on_a, apart.on_b, 0, 0};
            return true;
        }
    }
    Best<B> best(a, b);
    known(best);
    // A face is preferred to what is less deep by rounding; a line of a side is the answer or is not.
    const auto excess = [&] { return (best.candidate.kind == AxisKind::Edges ? kSideExcess : kFacePreference) * size.tolerated; };
    const Penetration p = penetration(a, b, size.largest, {best.candidate.normal, best.depth, excess()});
    axis = {AxisKind::Edges, p.normal, -p.depth, p.on_a, p.on_b, 0, 0};
    nearby(p.normal, best);
    if (p.normal == dvec3{0.0} || best.depth <= p.depth + excess()) {
        axis.kind = best.candidate.kind;
        axis.normal = best.candidate.normal;
        axis.separation = -best.depth;
        axis.feature_a = best.candidate.feature_a;
        axis.feature_b = best.candidate.feature_b;
    }
    if (!p.proven) status = CollideStatus::Undecided;
    return axis.separation <= margin;
}

}  // namespace

bool find_axis(const TruncatedCone& a, Polytope& b, double margin, ContactAxis& axis, CollideStatus& status) {
    const auto known = [&](auto& best) {
        best.offer_ends_of_a();
        for (std::uint32_t f = 0; f < b.face_count(); ++f) {
            const dvec3 outward = b.normal(f);
            best.offer({-outward, AxisKind::FaceOfB, 0, f}, a.reach(-outward) + b.offset(f));
        }
    };
    const auto nearby = [](const dvec3&, auto&) {};
    const double largest = std::max(a.size(), b.size);
    const PairSize size{largest, b.side_count > 0 ? a.size() : largest};  // a mesh's triangle may be as large as it likes
    return axis_of(a, list_vertices(b), size, margin, known, nearby, axis, status);
}

bool find_axis(const TruncatedCone& a, const RoundSegment& b, double margin, ContactAxis& axis, CollideStatus& status) {
    const std::array<dvec3, 2> ends{b.segment.from, b.segment.to};
    const dvec3 d = b.segment.to - b.segment.from;
    const double length = std::sqrt(glm::dot(d, d));
    const auto known = [&](auto& best) {
        best.offer_ends_of_a();
        best.offer({a.side_normal(a.outward(b.segment.at(0.5) - a.centre))});
        if (length > 0.0) best.offer_common_normals(a.axis(), slope_of_side(a), d / length, 0.0);
    };
    const auto nearby = [&](const dvec3& normal, auto& best) { best.offer({a.side_normal(a.outward(normal))}); };
    const std::span<const dvec3> points(ends.data(), length > 0.0 ? 2 : 1);
    const double size = std::max(a.size(), length);
    return axis_of(a, points, {size, size}, margin + b.radius, known, nearby, axis, status);
}

bool find_axis(const TruncatedCone& a, const TruncatedCone& b, double margin, ContactAxis& axis, CollideStatus& status) {
    const auto known = [&](auto& best) {
        best.offer_ends_of_a();
        best.offer({b.axis(), AxisKind::FaceOfB, 0, 0});
        if (b.upper_radius > 0.0) best.offer({-b.axis(), AxisKind::FaceOfB, 0, 1});
        best.offer({a.side_normal(a.outward(b.centre - a.centre))});
        best.offer_common_normals(a.axis(), slope_of_side(a), b.axis(), -slope_of_side(b));
    };
    const auto nearby = [&](const dvec3& normal, auto& best) {
        best.offer({a.side_normal(a.outward(normal))});
        best.offer({-b.side_normal(b.outward(-normal))});
    };
    const double size = std::max(a.size(), b.size());
    return axis_of(a, b, {size, size}, margin, known, nearby, axis, status);
}

}  // namespace carom::detail
