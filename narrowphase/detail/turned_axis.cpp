#include <carom/narrowphase/detail/epa.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/turned_contact.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace carom::detail {
namespace {

// A direction that is exactly that of a feature.
struct Candidate {
    dvec3 normal{0.0};  // from a to b
    AxisKind kind = AxisKind::Edges;
    std::uint32_t feature_a = 0, feature_b = 0;
};

// Those worth trying for one pair.
class Candidates {
public:
    void add(const dvec3& normal, AxisKind kind = AxisKind::Edges, std::uint32_t feature_a = 0, std::uint32_t feature_b = 0) noexcept {
        items_[count_++] = {normal, kind, feature_a, feature_b};
    }
    // The flat ends of a solid; `turn` is -1 for those of b, whose outward normals point to a.
    void add_ends(const TruncatedCone& solid, double turn, AxisKind kind) noexcept {
        add(-turn * solid.axis(), kind, 0, 0);
        if (solid.upper_radius > 0.0) add(turn * solid.axis(), kind, 1, 1);
    }
    // The unit vectors n with dot(n, a) = along_a and dot(n, b) = along_b: normals to the sides of two solids, or to a side and a line.
    void add_common_normals(const dvec3& a, double along_a, const dvec3& b, double along_b) noexcept {
        const dvec3 c = glm::cross(a, b);
        const double cosine = glm::dot(a, b), sine_sq = glm::dot(c, c);
        if (!(sine_sq > kParallelSine * kParallelSine)) return;
        const double x = (along_a - cosine * along_b) / sine_sq, y = (along_b - cosine * along_a) / sine_sq;
        const double z_sq = (1.0 - x * along_a - y * along_b) / sine_sq;
        if (!(z_sq >= 0.0)) return;
        for (const double z : {std::sqrt(z_sq), -std::sqrt(z_sq)}) {
            const dvec3 n = x * a + y * b + z * c;
            add(n / std::sqrt(glm::dot(n, n)));
        }
    }
    [[nodiscard]] std::span<const Candidate> items() const noexcept { return {items_.data(), count_}; }

private:
    std::array<Candidate, 12> items_;
    std::size_t count_ = 0;
};

double reach_of(std::span<const dvec3> points, const dvec3& direction) noexcept {
    double reach = glm::dot(points[0], direction);
    for (const dvec3& p : points) reach = std::max(reach, glm::dot(p, direction));
    return reach;
}
double reach_of(const TruncatedCone& solid, const dvec3& direction) noexcept { return solid.reach(direction); }

double slope_of_side(const TruncatedCone& solid) noexcept { return glm::dot(solid.side_normal(solid.axes[0]), solid.axis()); }

// @param suggest  adds candidates near the direction that EPA found.
template <class B, class Suggest>
bool axis_of(const TruncatedCone& a, const B& b, double size, double margin, const Suggest& suggest, ContactAxis& axis,
             CollideStatus& status) {
    const GjkResult apart = gjk(a, b, margin);
    if (apart.beyond) return false;
    if (apart.converged) {
        if (apart.distance > margin) return false;
        if (apart.distance > kTouching * size) {
            axis = {AxisKind::Distance, (apart.on_b - apart.on_a) / apart.distance, apart.distance, apart.on_a, apart.on_b, 0, 0};
            return true;
        }
    }
    const Penetration p = penetration(a, b, size);
    axis = {AxisKind::Edges, p.normal, -p.depth, p.on_a, p.on_b, 0, 0};
    Candidates candidates;
    suggest(p.normal, candidates);
    const Candidate* best = nullptr;
    double least = 0.0;
    for (const Candidate& c : candidates.items()) {
        const double depth = a.reach(c.normal) + reach_of(b, -c.normal);
        if (best == nullptr || depth < least) {
            best = &c;
            least = depth;
        }
    }
    const bool found = p.normal != dvec3{0.0};
    if (!found || least <= p.depth + kFacePreference * size) {
        axis.kind = best->kind;
        axis.normal = best->normal;
        axis.separation = -least;
        axis.feature_a = best->feature_a;
        axis.feature_b = best->feature_b;
    }
    if (!p.proven) status = CollideStatus::Undecided;
    return axis.separation <= margin;
}

}  // namespace

bool find_axis(const TruncatedCone& a, const Polytope& b, double margin, ContactAxis& axis, CollideStatus& status) {
    const auto suggest = [&](const dvec3& normal, Candidates& candidates) {
        candidates.add_ends(a, 1.0, AxisKind::FaceOfA);
        const std::uint32_t face = face_along(b, -normal);
        candidates.add(-b.planes[face].normal, AxisKind::FaceOfB, 0, face);
    };
    return axis_of(a, std::span<const dvec3>(b.vertices), std::max(a.size(), b.size), margin, suggest, axis, status);
}

bool find_axis(const TruncatedCone& a, const RoundSegment& b, double margin, ContactAxis& axis, CollideStatus& status) {
    const std::array<dvec3, 2> ends{b.segment.from, b.segment.to};
    const dvec3 d = b.segment.to - b.segment.from;
    const double length = std::sqrt(glm::dot(d, d));
    const auto suggest = [&](const dvec3& normal, Candidates& candidates) {
        candidates.add_ends(a, 1.0, AxisKind::FaceOfA);
        candidates.add(a.side_normal(a.outward(normal)));
        candidates.add(a.side_normal(a.outward(b.segment.at(0.5) - a.centre)));
        if (length > 0.0) candidates.add_common_normals(a.axis(), slope_of_side(a), d / length, 0.0);
    };
    const std::span<const dvec3> points(ends.data(), length > 0.0 ? 2 : 1);
    return axis_of(a, points, std::max(a.size(), length), margin + b.radius, suggest, axis, status);
}

bool find_axis(const TruncatedCone& a, const TruncatedCone& b, double margin, ContactAxis& axis, CollideStatus& status) {
    const auto suggest = [&](const dvec3& normal, Candidates& candidates) {
        candidates.add_ends(a, 1.0, AxisKind::FaceOfA);
        candidates.add_ends(b, -1.0, AxisKind::FaceOfB);
        candidates.add(a.side_normal(a.outward(normal)));
        candidates.add(-b.side_normal(b.outward(-normal)));
        candidates.add(a.side_normal(a.outward(b.centre - a.centre)));
        candidates.add_common_normals(a.axis(), slope_of_side(a), b.axis(), -slope_of_side(b));
    };
    return axis_of(a, b, std::max(a.size(), b.size()), margin, suggest, axis, status);
}

}  // namespace carom::detail
