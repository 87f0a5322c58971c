// What must hold for any two convex shapes of raw bits: distance(), penetration() and overlaps() judged by exact rationals, for the fuzzers
// gjk, epa and sat and for tests.
//
//   EXPECT_EQ(test::gjk_fault(bytes), "");
#pragma once

#include <fuzz/shapes_check.hpp>
#include <narrowphase/near_pairs.hpp>
#include <support/exact_shape.hpp>

#include <carom/core/check.hpp>
#include <carom/narrowphase/overlap.hpp>

namespace carom::test {

/// E of distance.hpp, for sums of sizes instead of reaches.
[[nodiscard]] inline double query_rounding(const NearPair& p) {
    const dvec3 between = p.pose_b.position - p.pose_a.position;
    const double scale = std::max({std::abs(between.x), std::abs(between.y), std::abs(between.z), 1e-300});
    const double far = scale * glm::length(between / scale);
    return 0x1p-46 * (far + 2.0 * (bounding_radius(p.a) + bounding_radius(p.b)));
}

/// A pair with the exact squared distance of the cores, and the radii round them.
struct JudgedPair {
    exact::Solid a, b;
    exact::Rational core_sq, radii;
    explicit JudgedPair(const NearPair& p) : a(exact::solid(p.a, p.pose_a)), b(exact::solid(p.b, p.pose_b)), radii(a.radius + b.radius) {
        core_sq = exact::core_distance_sq(a, b);
    }
    [[nodiscard]] bool overlap() const { return core_sq <= exact::square(radii); }
};

/// What is wrong with bounds on the distance.
[[nodiscard]] inline std::string bounds_fault(const NearPair& p, const JudgedPair& truth, const DistanceResult& r) {
    if (r.status == DistanceStatus::Overlap) {
        const dvec3 none{0.0};
        if (r.lower != 0.0 || r.upper != 0.0 || r.on_a != none || r.on_b != none || r.normal != none) return "an overlap with bounds, points or a normal";
        return truth.overlap() ? "" : "an overlap that is none";
    }
    if (!is_finite(r.lower) || !is_finite(r.on_a) || !is_finite(r.on_b) || !is_finite(r.normal)) return "a result that is not finite";
    if (r.lower > 0.0 && exact::square(exact::number(r.lower) + truth.radii) > truth.core_sq) return "the lower bound is above the distance";
    if (is_finite(r.upper) && exact::square(exact::number(r.upper) + truth.radii) < truth.core_sq) return "the upper bound is below the distance";
    if (r.status == DistanceStatus::Converged && r.upper - r.lower > 4.0 * query_rounding(p)) return "converged bounds are far apart";
    return "";
}

/// What is wrong with a verdict.
[[nodiscard]] inline std::string verdict_fault(const JudgedPair& truth, Overlap verdict) {
    if (verdict == Overlap::Apart && truth.overlap()) return "an overlap is missed";
    return verdict == Overlap::Overlapping && !truth.overlap() ? "an overlap that is none" : "";
}

/// @return a shape that validate() passes; none where the bits make none.
[[nodiscard]] inline std::optional<Shape> draw_polyhedral(RawBytes& bytes, bool boxes) {
    Shape shape = Box{{bytes.size(), bytes.size(), bytes.size()}};
    switch (boxes ? 0 : bytes.byte() % 4) {
        case 1: shape = Sphere{bytes.size()}; break;
        case 2: shape = Capsule{bytes.size(), bytes.size()}; break;
        case 3: {
            std::vector<vec3> points;
            for (int i = 4 + bytes.byte() % 5; i > 0; --i) {
                const vec3 p{bytes.size(), bytes.size(), bytes.size()};
                points.push_back(bytes.byte() % 2 ? p : -p);
            }
            const ConvexHullPtr hull = hull_of(points);
            if (hull == nullptr) return {};
            shape = hull;
            break;
        }
        default: break;
    }
    return validate(shape) ? std::optional(shape) : std::nullopt;
}

/// The bytes as RawBytes reads them, then how near the shapes are brought: where they happen to be, touching, apart or overlapping by 2^-60 to
/// 2^3 of the first one's least extent.
/// @return a pair; none where a shape is refused, or where a pose is not finite, which every query must refuse: `fault` says if one does not.
[[nodiscard]] inline std::optional<NearPair> draw_pair(std::span<const std::uint8_t> data, bool boxes, std::string& fault) {
    RawBytes bytes(data);
    const int touch = bytes.byte() % 4;
    const std::optional<Shape> a = draw_polyhedral(bytes, boxes), b = draw_polyhedral(bytes, boxes);
    if (!a || !b) return {};
    NearPair p{*a, *b, bytes.pose(), bytes.pose(), 1.0};
    if (!is_finite(p.pose_a) || !is_finite(p.pose_b)) {
        try {
            static_cast<void>(overlaps(p.a, p.pose_a, p.b, p.pose_b));
            fault = "a pose that is not finite is taken";
        } catch (const MisuseError&) {
        }
        return {};
    }
    const dvec3 far = bytes.far();
    p.pose_a.position += far;
    p.pose_b.position += far;
    const double size = smallest_extent(p.a);
    if (touch != 0) bring_near(p, touch == 1 ? 0.0 : std::ldexp(touch == 2 ? size : -size, bytes.byte() % 64 - 60));
    if (!is_finite(p.pose_b)) return {};
    return p;
}

[[nodiscard]] inline std::string gjk_fault(std::span<const std::uint8_t> data) {
    std::string fault;
    const std::optional<NearPair> p = draw_pair(data, false, fault);
    if (!p) return fault;
    const JudgedPair truth(*p);
    DistanceCache cache;
    cache.count = data.empty() ? 0 : data[0] % 6u;
    for (std::size_t k = 0; k < 4; ++k) cache.a[k] = data.size() > k ? data[k] % 9u : 0, cache.b[k] = data.size() > 4 + k ? data[4 + k] % 9u : 0;
    for (int pass = 0; pass < 3; ++pass) {
        fault = bounds_fault(*p, truth, distance(p->a, p->pose_a, p->b, p->pose_b, {}, pass == 0 ? nullptr : &cache));
        if (!fault.empty()) return fault;
    }
    const Shape* const shapes[] = {&p->a, &p->b};
    const Pose poses[] = {p->pose_a, p->pose_b};
    const NumberedPair pairs[] = {{0, 1, 0.0f}, {1, 0, 0.0f}};
    SerialExecutor executor;
    std::vector<DistanceResult> many;
    distance({shapes, poses}, pairs, executor, {}, many);
    for (const DistanceResult& r : many) {
        if (fault = bounds_fault(*p, truth, r); !fault.empty()) return "in a batch: " + fault;
    }
    std::vector<Overlap> verdicts;
    overlaps({shapes, poses}, pairs, executor, verdicts);
    verdicts.push_back(overlaps(p->a, p->pose_a, p->b, p->pose_b));
    for (const Overlap verdict : verdicts) {
        if (fault = verdict_fault(truth, verdict); !fault.empty()) return fault;
    }
    return "";
}

/// Two boxes, also side by side with others in the lanes.
[[nodiscard]] inline std::string sat_fault(std::span<const std::uint8_t> data) {
    std::string fault;
    const std::optional<NearPair> p = draw_pair(data, true, fault);
    if (!p) return fault;
    const JudgedPair truth(*p);
    const Shape* const shapes[] = {&p->a, &p->b};
    const Pose poses[] = {p->pose_a, p->pose_b};
    const std::vector<NumberedPair> pairs(17, NumberedPair{0, 1, 0.0f});
    SerialExecutor executor;
    std::vector<Overlap> verdicts;
    overlaps({shapes, poses}, pairs, executor, verdicts);
    verdicts.push_back(overlaps(p->a, p->pose_a, p->b, p->pose_b));
    verdicts.push_back(overlaps(p->b, p->pose_b, p->a, p->pose_a));
    for (const Overlap verdict : verdicts) {
        if (fault = verdict_fault(truth, verdict); !fault.empty()) return fault;
    }
    return "";
}

/// The depth: b moved by it is free, and no separating axis has less.
[[nodiscard]] inline std::string epa_fault(std::span<const std::uint8_t> data) {
    std::string fault;
    const std::optional<NearPair> p = draw_pair(data, false, fault);
    if (!p) return fault;
    const PenetrationResult r = penetration(p->a, p->pose_a, p->b, p->pose_b);
    if (!is_finite(r.lower) || !is_finite(r.upper) || !is_finite(r.normal) || !is_finite(r.on_a) || !is_finite(r.on_b)) return "not finite";
    if (!(r.lower >= 0.0 && r.lower <= r.upper)) return "bounds of the depth in no order";
    const JudgedPair truth(*p);
    const double e = 2.0 * query_rounding(*p);
    const bool sure = overlaps(p->a, p->pose_a, p->b, p->pose_b) == Overlap::Overlapping, round = truth.radii.sign() != 0;
    if (sure && !(r.upper > 0.0)) return "an overlap without a depth";
    const double size = 2.0 * std::max(bounding_radius(p->a), bounding_radius(p->b)), thin = std::min(smallest_extent(p->a), smallest_extent(p->b));
    if (sure && !round && thin > 1e-5 * size && r.upper - r.lower > 1e-9 * size + e) return "bounds of the depth far apart";
    if (r.lower > 0.0 && !truth.overlap()) return "a depth of shapes that are apart";
    if (r.upper <= 0.0) return "";
    if (std::abs(glm::dot(r.normal, r.normal) - 1.0) > 1e-12) return "a normal that is not of unit length";
    JudgedPair moved = truth;
    for (exact::Vec& corner : moved.b.corners) corner = corner + exact::number(r.upper + e) * exact::vec(r.normal);
    moved.core_sq = exact::core_distance_sq(moved.a, moved.b);
    if (moved.overlap()) return "moved by its depth the shape still overlaps";
    if (round || r.upper > 1e9 || query_rounding(*p) > 1e-3) return "";
    const auto solid = [&](const Shape& s, const Pose& pose) {
        return std::holds_alternative<Box>(s) ? solid_of(std::get<Box>(s), pose, p->pose_a.position)
                                              : solid_of(*std::get<ConvexHullPtr>(s), pose, p->pose_a.position);
    };
    const Real gap = greatest_separation(solid(p->a, p->pose_a), solid(p->b, p->pose_b)).value;
    return static_cast<double>(-gap) < r.lower - e ? "an axis parts the shapes by less than the lower bound" : "";
}

}  // namespace carom::test
