// What must hold for any sweep in closed form and any two convex shapes that move and turn, of raw bits: a typed refusal, or times that are never
// late, judged by exact rationals (sweeps) and by overlaps that distance() proves or heights in long double (shapes that turn).
//
//   EXPECT_EQ(test::sweep_fault(bytes), "");
#pragma once

#include <fuzz/impact_check.hpp>
#include <fuzz/shapes_check.hpp>
#include <support/exact_distance.hpp>

#include <carom/collision/closest_points.hpp>
#include <carom/narrowphase/sweep.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <array>
#include <type_traits>

namespace carom::test {

// ---- sweeps --------------------------------------------------------------------------------------------------------------------------

[[nodiscard]] inline bool is_swept(double x) { return std::abs(x) <= 1e70; }
[[nodiscard]] inline bool is_swept(const dvec3& v) { return is_swept(v.x) && is_swept(v.y) && is_swept(v.z); }
/// Of any bits where the style says so; else of either sign, since a bad one must be told.
[[nodiscard]] inline double draw_radius(RawBytes& bytes, RawBytes::Style style) {
    const double r = style == RawBytes::Style::Raw ? bytes.coordinate() : std::abs(bytes.coordinate());
    return bytes.byte() % 8 == 0 ? 0.0 : bytes.byte() % 64 == 63 ? -r : r;
}

inline void draw(RawBytes& bytes, RawBytes::Style style, geo::Sphere<double>& s) { s = {draw_point(bytes), draw_radius(bytes, style)}; }
inline void draw(RawBytes& bytes, RawBytes::Style style, geo::Capsule<double>& c) {
    const dvec3 a = draw_point(bytes);
    c = {{a, bytes.byte() % 8 == 0 ? a : draw_point(bytes)}, draw_radius(bytes, style)};
}
inline void draw(RawBytes& bytes, RawBytes::Style style, geo::Cylinder<double>& c) {
    const dvec3 a = draw_point(bytes);
    c = {{a, draw_point(bytes)}, draw_radius(bytes, style)};
}
inline void draw(RawBytes& bytes, RawBytes::Style style, geo::Aabb<double>& b) {
    const dvec3 p = draw_point(bytes), q = bytes.byte() % 8 == 0 ? p : draw_point(bytes);
    b = style == RawBytes::Style::Raw ? geo::Aabb<double>{p, q} : geo::Aabb<double>{glm::min(p, q), glm::max(p, q)};
}
inline void draw(RawBytes& bytes, RawBytes::Style, geo::Triangle<double>& t) {
    t.a = draw_point(bytes), t.b = draw_point(bytes);
    t.c = bytes.byte() % 8 == 0 ? t.a : draw_point(bytes);
}
inline void draw(RawBytes& bytes, RawBytes::Style, geo::Plane<double>& p) { p = {draw_point(bytes), bytes.coordinate()}; }

[[nodiscard]] inline bool is_good(const geo::Sphere<double>& s) { return is_swept(s.center) && is_swept(s.radius) && s.radius >= 0.0; }
template <class Round>
requires requires(const Round& c) { c.axis; }
[[nodiscard]] bool is_good(const Round& c) { return is_swept(c.axis.a) && is_swept(c.axis.b) && is_swept(c.radius) && c.radius >= 0.0; }
[[nodiscard]] inline bool is_good(const geo::Aabb<double>& b) {
    return is_swept(b.lower) && is_swept(b.upper) && glm::all(glm::lessThanEqual(b.lower, b.upper));
}
[[nodiscard]] inline bool is_good(const geo::Triangle<double>& t) { return is_swept(t.a) && is_swept(t.b) && is_swept(t.c); }
[[nodiscard]] inline bool is_good(const geo::Plane<double>& p) {
    return is_swept(p.normal) && is_swept(p.offset) && glm::length(p.normal) >= 1e-140;
}

/// A and B at any time.
template <class A, class B>
class SweepTruth {
public:
    static constexpr bool kExact = !std::is_same_v<B, geo::Plane<double>> && !std::is_same_v<B, geo::Cylinder<double>>;

    SweepTruth(const A& a, const dvec3& motion, const B& b) : b_given_(b), motion_(exact::vec(motion)), a_(exact::solid(a)) {
        if constexpr (kExact) b_ = exact::solid(b);
    }
    /// Whether the two are farther apart than the most that sweep.hpp allows a contact to be made up.
    [[nodiscard]] bool plainly_apart(double t) const {
        if constexpr (!kExact) return false;
        exact::Rational size = a_.radius + b_.radius;
        for (const exact::Vec& p : b_.corners) {
            for (const exact::Vec& q : a_.corners)
                size = std::max(size, exact::Rational(2 * exact::largest(p - q) + a_.radius + b_.radius));
        }
        exact::Solid moved = a_;
        for (exact::Vec& p : moved.corners) p = p + exact::number(t) * motion_;
        return exact::core_distance_sq(moved, b_) >
               exact::square(moved.radius + b_.radius + exact::number(4e-7) * size + exact::number(1e-68));
    }
    [[nodiscard]] bool touch(double t) const {
        exact::Solid moved = a_;
        for (exact::Vec& p : moved.corners) p = p + exact::number(t) * motion_;
        if constexpr (std::is_same_v<B, geo::Plane<double>>) {
            const exact::Vec n = exact::vec(b_given_.normal);
            exact::Rational least = exact::dot(n, moved.corners[0]) - exact::number(b_given_.offset);
            for (const exact::Vec& p : moved.corners)
                least = std::min(least, exact::Rational(exact::dot(n, p) - exact::number(b_given_.offset)));
            return least.sign() <= 0 || exact::square(least) <= exact::square(moved.radius) * exact::length_sq(n);
        } else if constexpr (std::is_same_v<B, geo::Cylinder<double>>) {
            return false;  // its tests have an oracle in long double; here the form is looked at
        } else {
            return exact::core_distance_sq(moved, b_) <= exact::square(moved.radius + b_.radius);
        }
    }

private:
    B b_given_;
    exact::Vec motion_;
    exact::Solid a_, b_;
};

/// When they are nearest, roughly: the distance is convex in t.
template <class A, class B>
[[nodiscard]] double rough_nearest(const A& a, const dvec3& motion, const B& b) {
    double low = 0.0, high = 1.0;
    const auto at = [&](double t) {
        A moved = a;
        if constexpr (requires { moved.center; }) {
            moved.center += t * motion;
        } else {
            moved.axis.a += t * motion, moved.axis.b += t * motion;
        }
        return geo::closest_points(moved, b).distance_sq;
    };
    for (int i = 0; i < 60; ++i) {
        const double p = low + (high - low) / 3.0, q = high - (high - low) / 3.0;
        if (at(p) <= at(q)) {
            high = q;
        } else {
            low = p;
        }
    }
    return 0.5 * (low + high);
}

template <class A, class B>
[[nodiscard]] std::string swept_fault(RawBytes& bytes, RawBytes::Style style) {
    A a;
    B b;
    draw(bytes, style, a);
    draw(bytes, style, b);
    const dvec3 motion = bytes.byte() % 16 == 0 ? dvec3{0.0} : (bytes.byte() % 2 == 0 ? 1.0 : 4.0) * draw_point(bytes);
    const Impact impact = geo::sweep(a, motion, b);
    const bool good = is_good(a) && is_good(b) && is_swept(motion);
    if (std::string fault = form_fault(impact, good); !fault.empty()) return fault;
    if (!good || style == RawBytes::Style::Raw) return "";
    if (impact.status == ImpactStatus::Clamped) return "a sweep that came to its cap";
    if ((impact.status == ImpactStatus::Overlapping) != (may_touch(impact.status) && impact.t == 0.0)) return "overlap is not at the start";
    const SweepTruth<A, B> truth(a, motion, b);
    const double end = may_touch(impact.status) ? impact.t : 1.0;
    if (impact.status != ImpactStatus::Overlapping) {
        for (const double share : {0.0, 0.3, 0.7, 1.0}) {
            if (truth.touch(share * end)) return may_touch(impact.status) ? "a contact is met late" : "a contact is missed";
        }
    }
    if (may_touch(impact.status) && truth.plainly_apart(impact.t)) return "a contact is made up";
    if constexpr (SweepTruth<A, B>::kExact) {
        if (!may_touch(impact.status) && truth.touch(rough_nearest(a, motion, b))) return "a contact is missed where they are nearest";
    }
    return "";
}

template <class A>
[[nodiscard]] std::string swept_fault_of(RawBytes& bytes, RawBytes::Style style) {
    switch (bytes.byte() % 6) {
        case 0:
            return swept_fault<A, geo::Sphere<double>>(bytes, style);
        case 1:
            return swept_fault<A, geo::Capsule<double>>(bytes, style);
        case 2:
            return swept_fault<A, geo::Aabb<double>>(bytes, style);
        case 3:
            return swept_fault<A, geo::Triangle<double>>(bytes, style);
        case 4:
            return swept_fault<A, geo::Cylinder<double>>(bytes, style);
        default:
            return swept_fault<A, geo::Plane<double>>(bytes, style);
    }
}

// ---- shapes that turn ----------------------------------------------------------------------------------------------------------------

[[nodiscard]] inline RigidMotion draw_motion(RawBytes& bytes) {
    const auto turn = [&] { return static_cast<double>(static_cast<std::int8_t>(bytes.byte())) / 32.0; };
    RigidMotion m;
    m.start = bytes.pose();
    m.translation = 2.0 * draw_point(bytes);
    if (bytes.byte() % 4 != 0) {
        const double x = turn(), y = turn();
        m.rotation = {x, y, turn()};
    }
    if (bytes.byte() % 2 == 0) m.pivot = draw_point(bytes);
    return m;
}

/// @return whether the two are proved to overlap at t.
[[nodiscard]] inline bool overlap_at(const Shape& a, const RigidMotion& ma, const Shape& b, const RigidMotion& mb, double t) {
    const Pose pa = pose_at(ma, t), pb = pose_at(mb, t);
    const Plane* plane = std::get_if<Plane>(&b);
    if (plane == nullptr) return distance(a, pa, b, pb).status == DistanceStatus::Overlap;
    const dvec3 n(plane->normal), up = rotate(pb.orientation, n / glm::length(n));
    const double foot = static_cast<double>(plane->offset) / glm::length(n);
    const double size = bounding_radius(a) + std::abs(foot) + glm::length(pa.position - pb.position) + glm::length(ma.pivot) +
                        glm::length(mb.pivot) + glm::length(ma.translation) + glm::length(mb.translation);
    const long double lowest = -reach_along(a, pa, pb.position, -up);
    return lowest - static_cast<long double>(foot) < -1e-12L * static_cast<long double>(size);
}

[[nodiscard]] inline std::string turning_fault(RawBytes& bytes, RawBytes::Style style) {
    const Shape a = draw_convex(bytes);
    const bool plane = bytes.byte() % 3 == 0;
    const float x = bytes.size(), y = bytes.size(), z = bytes.size(), offset = bytes.size();
    const Shape b = plane ? Shape{Plane{{x, -y, z}, offset}} : draw_convex(bytes);
    const RigidMotion ma = draw_motion(bytes), mb = draw_motion(bytes);
    const Impact impact = time_of_impact(a, ma, b, mb);
    if (!(impact.t >= 0.0 && impact.t <= 1.0) || !is_finite(impact.point) || !is_finite(impact.normal))
        return "an answer that is not finite";
    if (plane) {
        const Impact swapped = time_of_impact(b, mb, a, ma);
        if (swapped.status != impact.status || swapped.t != impact.t) return "the answer depends on who is called A";
    }
    const double largest = bounding_radius(a) + (plane ? 0.0 : bounding_radius(b));
    const double least = plane ? smallest_extent(a) : std::min(smallest_extent(a), smallest_extent(b));
    if (style == RawBytes::Style::Raw || !(largest < 1e30 && least > 1e-30)) return "";
    if (impact.status == ImpactStatus::Invalid) return "good input is called Invalid";
    if (impact.status == ImpactStatus::Overlapping) return "";
    const double end = may_touch(impact.status) ? impact.t : 1.0;
    for (int k = 0; k <= 16; ++k) {
        if (overlap_at(a, ma, b, mb, end * k / 16.0))
            return may_touch(impact.status) ? "shapes overlap before they are met" : "an overlap is missed";
    }
    return "";
}

[[nodiscard]] inline std::string sweep_fault(std::span<const std::uint8_t> data) {
    RawBytes bytes(data);
    const RawBytes::Style style = RawBytes::style_of(data);
    switch (bytes.byte() % 4) {
        case 0:
            return swept_fault_of<geo::Sphere<double>>(bytes, style);
        case 1:
            return swept_fault_of<geo::Capsule<double>>(bytes, style);
        default:
            return turning_fault(bytes, style);
    }
}

}  // namespace carom::test
