#include <carom/collision/detail/closest_features.hpp>

namespace carom::geo::detail {
namespace {

// Below this sine squared of the angle between two directions the interior solution is compared with the ends instead of trusted.
constexpr double kSlim = 0x1p-20;

double length_sq(const dvec3& v) noexcept { return glm::dot(v, v); }

double clamp_unit(double x) noexcept { return x > 0.0 ? (x < 1.0 ? x : 1.0) : 0.0; }

}  // namespace

dvec3 closest_on(const Segment<double>& s, const dvec3& p) noexcept {
    const dvec3 along = s.b - s.a;
    const double sq = length_sq(along);
    if (!(sq > 0.0)) return s.a;
    const double t = glm::dot(p - s.a, along) / sq;
    if (!(t > 0.0)) return s.a;
    return t < 1.0 ? s.a + t * along : s.b;
}

Nearest closest(const Segment<double>& a, const Segment<double>& b) noexcept {
    const dvec3 u = a.b - a.a, v = b.b - b.a;
    const double uu = length_sq(u), vv = length_sq(v);
    if (uu < vv) return swapped(closest(b, a));
    if (!(vv > 0.0)) return swapped(nearest(b.a, closest_on(a, b.a)));
    // Both as seen along the longer one, where it is a point.
    const dvec3 w = b.a - a.a;
    const dvec3 v_across = v - (glm::dot(v, u) / uu) * u;
    const dvec3 w_across = w - (glm::dot(w, u) / uu) * u;
    const double across_sq = length_sq(v_across);
    const double t = across_sq > 0.0 ? -glm::dot(w_across, v_across) / across_sq : 0.0;
    const dvec3 on_b = t < 1.0 ? b.a + clamp_unit(t) * v : b.b;
    const double s = glm::dot(on_b - a.a, u) / uu;
    Nearest best = nearest(a.a + clamp_unit(s) * u, on_b);
    if (across_sq > kSlim * vv && t > 0.0 && t < 1.0 && s > 0.0 && s < 1.0) return best;
    keep_nearer(best, swapped(nearest(b.a, closest_on(a, b.a))));
    keep_nearer(best, swapped(nearest(b.b, closest_on(a, b.b))));
    keep_nearer(best, nearest(a.a, closest_on(b, a.a)));
    keep_nearer(best, nearest(a.b, closest_on(b, a.b)));
    return best;
}

TriangleFrame::TriangleFrame(const Triangle<double>& t) noexcept {
    const double ab = length_sq(t.b - t.a), bc = length_sq(t.c - t.b), ca = length_sq(t.a - t.c);
    if (ab >= bc && ab >= ca) {
        corner_ = t.a, end_ = t.b, apex_ = t.c;
    } else if (bc >= ca) {
        corner_ = t.b, end_ = t.c, apex_ = t.a;
    } else {
        corner_ = t.c, end_ = t.a, apex_ = t.b;
    }
    base_ = end_ - corner_;
    side_ = apex_ - corner_;
    base_sq_ = length_sq(base_);
    if (!(base_sq_ > 0.0)) return;
    height_ = side_ - (glm::dot(side_, base_) / base_sq_) * base_;
    height_sq_ = length_sq(height_);
    normal_ = glm::cross(base_, height_);
}

Segment<double> TriangleFrame::edge(int k) const noexcept {
    return k == 0 ? Segment<double>{corner_, end_} : k == 1 ? Segment<double>{end_, apex_} : Segment<double>{apex_, corner_};
}

bool TriangleFrame::project(const dvec3& p, dvec3& foot) const noexcept {
    if (!(height_sq_ > 0.0)) return false;
    const dvec3 w = p - corner_;
    const dvec3 across = w - (glm::dot(w, base_) / base_sq_) * base_;
    const double s = glm::dot(across, height_) / height_sq_;
    if (!(s >= 0.0 && s <= 1.0)) return false;
    const double t = glm::dot(w - s * side_, base_) / base_sq_;
    if (!(t >= 0.0 && s + t <= 1.0)) return false;
    foot = corner_ + (s * side_ + t * base_);
    return true;
}

dvec3 TriangleFrame::closest(const dvec3& p) const noexcept {
    dvec3 best{0.0};
    const bool inside = project(p, best);
    if (inside && height_sq_ > kSlim * base_sq_) return best;
    double best_sq = length_sq(best - p);
    for (int k = 0; k < 3; ++k) {
        const dvec3 q = closest_on(edge(k), p);
        const double sq = length_sq(q - p);
        if ((k == 0 && !inside) || sq < best_sq) best = q, best_sq = sq;
    }
    return best;
}

void offer_crossing(const dvec3& p, const dvec3& q, double of_p, double of_q, const TriangleFrame& triangle, double slack,
                    Nearest& best) noexcept {
    if (!((of_p <= 0.0 && of_q >= 0.0) || (of_p >= 0.0 && of_q <= 0.0)) || of_p == of_q) return;
    const dvec3 x = p + (of_p / (of_p - of_q)) * (q - p);
    const Nearest n = nearest(x, triangle.closest(x));
    keep_nearer(best, n.sq <= slack * slack ? Nearest{n.b, n.b, 0.0} : n);
}

Nearest closest(const Segment<double>& a, const Triangle<double>& b, double slack) noexcept {
    const TriangleFrame frame(b);
    Nearest best = nearest(a.a, frame.closest(a.a));
    keep_nearer(best, nearest(a.b, frame.closest(a.b)));
    offer_crossing(a.a, a.b, glm::dot(a.a - frame.corner(), frame.normal()), glm::dot(a.b - frame.corner(), frame.normal()), frame, slack,
                   best);
    for (int k = 0; k < 3 && best.sq > 0.0; ++k) keep_nearer(best, closest(a, frame.edge(k)));
    return best;
}

namespace {

// The edges of `a` through `b`, and the corners of `a` against the face of `b`.
void offer_faces(const TriangleFrame& a, const TriangleFrame& b, double slack, Nearest& best) noexcept {
    for (int k = 0; k < 3 && best.sq > 0.0; ++k) {
        const Segment<double> e = a.edge(k);
        dvec3 foot{0.0};
        if (b.project(e.a, foot)) keep_nearer(best, nearest(e.a, foot));
        offer_crossing(e.a, e.b, glm::dot(e.a - b.corner(), b.normal()), glm::dot(e.b - b.corner(), b.normal()), b, slack, best);
    }
}

}  // namespace

Nearest closest(const Triangle<double>& a, const Triangle<double>& b, double slack) noexcept {
    const TriangleFrame fa(a), fb(b);
    Nearest best = closest(fa.edge(0), fb.edge(0));
    offer_faces(fa, fb, slack, best);
    Nearest other = swapped(best);
    offer_faces(fb, fa, slack, other);
    best = swapped(other);
    for (int k = 1; k < 9 && best.sq > 0.0; ++k) keep_nearer(best, closest(fa.edge(k / 3), fb.edge(k % 3)));
    return best;
}

}  // namespace carom::geo::detail
