#include <carom/collision/detail/separating_axes.hpp>

#include <algorithm>

namespace carom::geo::detail {
namespace {

double sum_of_sizes(const dvec3& v) noexcept { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

// Beyond this sine an edge axis has all but two of its digits, and is as good as a face's.
constexpr double kSteep = 0.25;
// In parts of the axes' error: below this sine two edges are parallel.
constexpr double kParallel = 4.0;

// Box b in the frame of box a: centre t, axes the columns of r.
Verdict separate_boxes(const dvec3& ha, const dvec3& hb, const dvec3& t, const dmat3& r, double error) noexcept {
    const double tolerance = error * (sum_of_sizes(t) + sum_of_sizes(ha) + sum_of_sizes(hb));
    double s[3][3];
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) s[j][i] = std::fabs(r[j][i]);
    }
    for (int i = 0; i < 3; ++i) {
        const double reach = ha[i] + (hb.x * s[0][i] + hb.y * s[1][i] + hb.z * s[2][i]);
        if (std::fabs(t[i]) - reach > tolerance) return Verdict::Apart;
    }
    for (int j = 0; j < 3; ++j) {
        const double reach = hb[j] + (ha.x * s[j][0] + ha.y * s[j][1] + ha.z * s[j][2]);
        if (std::fabs(glm::dot(t, r[j])) - reach > tolerance) return Verdict::Apart;
    }
    bool unclear = false;
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            // Parallel to rounding: the boxes' faces decide, and turning b to exactly parallel moves it by a rounding.
            const double sine = std::max(s[j][i1], s[j][i2]);
            if (sine <= kParallel * error) continue;
            const double reach = (ha[i1] * s[j][i2] + ha[i2] * s[j][i1]) + (hb[j1] * s[j2][i] + hb[j2] * s[j1][i]);
            const double gap = std::fabs(t[i2] * r[j][i1] - t[i1] * r[j][i2]) - reach;
            if (gap > tolerance) return Verdict::Apart;
            unclear |= gap >= -tolerance && sine < kSteep;
        }
    }
    return unclear ? Verdict::Unclear : Verdict::Together;
}

// Gathers what the axes say.
class Axes {
public:
    /// @param gap   along the axis, below zero for an overlap
    /// @param sure  a larger gap separates; @param doubt  a smaller overlap proves nothing
    void add(double gap, double sure, double doubt) noexcept {
        apart_ |= gap > sure;
        unclear_ |= !(gap < -doubt);
    }
    [[nodiscard]] bool apart() const noexcept { return apart_; }
    [[nodiscard]] Verdict verdict() const noexcept { return apart_ ? Verdict::Apart : unclear_ ? Verdict::Unclear : Verdict::Together; }

private:
    bool apart_ = false;
    bool unclear_ = false;
};

struct Interval {
    double low, high;
};

Interval along(const dvec3& axis, const dvec3 (&p)[3]) noexcept {
    const double x = glm::dot(axis, p[0]), y = glm::dot(axis, p[1]), z = glm::dot(axis, p[2]);
    return {std::min({x, y, z}), std::max({x, y, z})};
}

double gap_between(const Interval& a, const Interval& b) noexcept { return std::max(b.low - a.high, a.low - b.high); }

double largest_size(const dvec3 (&p)[3]) noexcept { return std::max({sum_of_sizes(p[0]), sum_of_sizes(p[1]), sum_of_sizes(p[2])}); }

// The triangle in the box's frame.
Verdict separate_from_box(const Triangle<double>& t, const dvec3& h, double error) noexcept {
    const dvec3 p[3] = {t.a, t.b, t.c};
    const double reach = largest_size(p) + sum_of_sizes(h);
    Axes axes;
    for (int i = 0; i < 3; ++i) {
        const Interval extent{std::min({p[0][i], p[1][i], p[2][i]}), std::max({p[0][i], p[1][i], p[2][i]})};
        axes.add(gap_between(extent, {-h[i], h[i]}), error * reach, error * reach);
    }
    if (axes.apart()) return Verdict::Apart;
    const auto test = [&](const dvec3& axis, double doubt) {
        const double half = h.x * std::fabs(axis.x) + h.y * std::fabs(axis.y) + h.z * std::fabs(axis.z);
        axes.add(gap_between(along(axis, p), {-half, half}), error * reach * sum_of_sizes(axis), error * reach * doubt);
    };
    const dvec3 normal = TriangleFrame(t).normal();
    test(normal, sum_of_sizes(normal));
    const dvec3 edges[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
    for (const dvec3& e : edges) {
        const double size = sum_of_sizes(e);
        // An edge along an axis of the box has no axis with it, and needs none: those of the other edges and faces are all.
        if (std::max(std::fabs(e.y), std::fabs(e.z)) > error * size) test({0.0, -e.z, e.y}, size);
        if (std::max(std::fabs(e.z), std::fabs(e.x)) > error * size) test({e.z, 0.0, -e.x}, size);
        if (std::max(std::fabs(e.x), std::fabs(e.y)) > error * size) test({-e.y, e.x, 0.0}, size);
        if (axes.apart()) return Verdict::Apart;
    }
    return axes.verdict();
}

}  // namespace

Verdict separate(const Obb<double>& a, const Obb<double>& b, double error) noexcept {
    const auto in_a = [&](const dvec3& v) { return dvec3{glm::dot(a.axes[0], v), glm::dot(a.axes[1], v), glm::dot(a.axes[2], v)}; };
    return separate_boxes(a.half_extents, b.half_extents, in_a(b.center - a.center),
                          dmat3{in_a(b.axes[0]), in_a(b.axes[1]), in_a(b.axes[2])}, error);
}

Verdict separate(const AlignedBox& a, const Obb<double>& b, double error) noexcept {
    return separate_boxes(a.half, b.half_extents, b.center - a.center, b.axes, error);
}

Verdict separate(const Triangle<double>& a, const AlignedBox& b, double error) noexcept {
    return separate_from_box(to_local(b, a), b.half, error);
}
Verdict separate(const Triangle<double>& a, const Obb<double>& b, double error) noexcept {
    return separate_from_box(to_local(b, a), b.half_extents, error);
}

Verdict separate(const Triangle<double>& a, const Triangle<double>& b, double error) noexcept {
    const dvec3 p[3] = {a.a, a.b, a.c}, q[3] = {b.a, b.b, b.c};
    const double reach = largest_size(p) + largest_size(q);
    Axes axes;
    const auto test = [&](const dvec3& axis, double doubt) {
        axes.add(gap_between(along(axis, p), along(axis, q)), error * reach * sum_of_sizes(axis), error * reach * doubt);
        return axes.apart();
    };
    for (const Triangle<double>* t : {&a, &b}) {
        const dvec3 normal = TriangleFrame(*t).normal();
        if (test(normal, sum_of_sizes(normal))) return Verdict::Apart;
    }
    const dvec3 edges_a[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]}, edges_b[3] = {q[1] - q[0], q[2] - q[1], q[0] - q[2]};
    for (const dvec3& e : edges_a) {
        for (const dvec3& f : edges_b) {
            if (test(glm::cross(e, f), sum_of_sizes(e) * sum_of_sizes(f))) return Verdict::Apart;
        }
    }
    return axes.verdict();
}

}  // namespace carom::geo::detail
