#include <carom/broadphase/queries.hpp>

#include <carom/core/check.hpp>

#include <algorithm>
#include <limits>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool are_finite(const dvec3& a, const dvec3& b, double c = 0.0) noexcept { return is_finite(a) && is_finite(b) && is_finite(c); }

bool is_ordered(const dvec3& lower, const dvec3& upper) noexcept { return lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z; }

// Regions may be open on any side, so no arithmetic here may turn an infinity into a NaN.
double distance_sq(const dvec3& point, const FloatAabb& box) noexcept {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double below = double(box.lower[k]) - point[k], above = point[k] - double(box.upper[k]);
        const double gap = std::max(std::max(below, above), 0.0);
        sum += gap * gap;
    }
    return sum;
}

// The part of a path in which it meets a box; empty if first > last.
struct Span {
    double first = 0.0, last = 0.0;
};

Span clip(const SweepPath& path, const FloatAabb& box) noexcept {
    Span span{0.0, path.t_max};
    for (int k = 0; k < 3; ++k) {
        const double lower = double(box.lower[k]) - path.grow[k], upper = double(box.upper[k]) + path.grow[k];
        if (path.direction[k] == 0.0) {
            if (path.origin[k] < lower || path.origin[k] > upper) return {1.0, 0.0};
            continue;
        }
        const double a = (lower - path.origin[k]) / path.direction[k], b = (upper - path.origin[k]) / path.direction[k];
        span.first = std::max(span.first, std::min(a, b));
        span.last = std::min(span.last, std::max(a, b));
    }
    return span;
}

// A graze that rounding alone makes a miss counts as a hit.
bool is_hit(const Span& span) noexcept { return span.first <= span.last + 0x1p-48 * (span.first + span.last); }

void sweep(const Broadphase& broadphase, const SweepPath& path, SlotVisitor visit) {
    broadphase.visit_along(
        path, [&](const FloatAabb& box) { return is_hit(clip(path, box)); }, visit);
}

}  // namespace

void query_box(const Broadphase& broadphase, const dvec3& lower, const dvec3& upper, SlotVisitor visit) {
    CAROM_REQUIRE(are_finite(lower, upper), ErrorCode::NotFinite, "a box to look in must be finite");
    CAROM_REQUIRE(is_ordered(lower, upper), ErrorCode::InvalidArgument, "a box to look in has lower > upper");
    broadphase.visit_where(
        [&](const FloatAabb& box) {
            bool touches = true;
            for (int k = 0; k < 3; ++k) touches = touches && double(box.lower[k]) <= upper[k] && lower[k] <= double(box.upper[k]);
            return touches;
        },
        visit);
}

void query_sphere(const Broadphase& broadphase, const dvec3& centre, double radius, SlotVisitor visit) {
    CAROM_REQUIRE(are_finite(centre, dvec3{0.0}, radius), ErrorCode::NotFinite, "a ball to look in must be finite");
    CAROM_REQUIRE(radius >= 0.0, ErrorCode::InvalidArgument, "the radius must not be negative");
    broadphase.visit_where([&](const FloatAabb& box) { return distance_sq(centre, box) <= radius * radius; }, visit);
}

void query_volume(const Broadphase& broadphase, std::span<const HalfSpace> half_spaces, SlotVisitor visit) {
    for (const HalfSpace& h : half_spaces) {
        CAROM_REQUIRE(are_finite(h.normal, dvec3{0.0}, h.offset), ErrorCode::NotFinite, "half-spaces must be finite");
    }
    broadphase.visit_where(
        [&](const FloatAabb& box) {
            for (const HalfSpace& h : half_spaces) {
                double deepest = 0.0, size = 0.0;  // of the corner that lies farthest inside
                for (int k = 0; k < 3; ++k) {
                    if (h.normal[k] == 0.0) continue;  // times an open side would be NaN
                    const double term = h.normal[k] * double(h.normal[k] > 0.0 ? box.lower[k] : box.upper[k]);
                    deepest += term;
                    size += term < 0.0 ? -term : term;
                }
                if (deepest > h.offset + 0x1p-48 * size) return false;
            }
            return true;
        },
        visit);
}

void query_ray(const Broadphase& broadphase, const dvec3& origin, const dvec3& direction, double t_max, SlotVisitor visit) {
    CAROM_REQUIRE(are_finite(origin, direction, t_max), ErrorCode::NotFinite, "a ray must be finite");
    CAROM_REQUIRE(direction != dvec3{0.0} && t_max >= 0.0, ErrorCode::InvalidArgument, "a ray needs a direction and t_max >= 0");
    sweep(broadphase, {.origin = origin, .direction = direction, .t_max = t_max}, visit);
}

void query_swept_box(const Broadphase& broadphase, const dvec3& lower, const dvec3& upper, const dvec3& motion, SlotVisitor visit) {
    CAROM_REQUIRE(are_finite(lower, upper) && is_finite(motion), ErrorCode::NotFinite, "a moving box must be finite");
    CAROM_REQUIRE(is_ordered(lower, upper), ErrorCode::InvalidArgument, "a moving box has lower > upper");
    sweep(broadphase, {.origin = 0.5 * lower + 0.5 * upper, .direction = motion, .t_max = 1.0, .grow = 0.5 * upper - 0.5 * lower}, visit);
}

std::optional<BoxHit> closest_on_ray(const Broadphase& broadphase, const dvec3& origin, const dvec3& direction, double t_max,
                                     SlotVisitor accept) {
    CAROM_REQUIRE(are_finite(origin, direction, t_max), ErrorCode::NotFinite, "a ray must be finite", {});
    CAROM_REQUIRE(direction != dvec3{0.0} && t_max >= 0.0, ErrorCode::InvalidArgument, "a ray needs a direction and t_max >= 0", {});
    std::optional<BoxHit> best;
    const SweepPath ray{.origin = origin, .direction = direction, .t_max = t_max};
    SweepPath rest = ray;  // up to the nearest box so far
    const auto met = [&](const FloatAabb& box) { return is_hit(clip(rest, box)); };
    broadphase.visit_along(rest, met, [&](std::uint32_t slot) {
        const double t = clip(ray, broadphase.box(slot)).first;
        const bool nearer = !best || t < best->t || (t == best->t && slot < best->slot);
        if (nearer && accept(slot)) {
            best = BoxHit{slot, t};
            rest.t_max = t;
        }
        return true;
    });
    return best;
}

std::vector<std::uint32_t> nearest_boxes(const Broadphase& broadphase, const dvec3& point, std::size_t count) {
    CAROM_REQUIRE(is_finite(point), ErrorCode::NotFinite, "the point must be finite", {});
    struct Near {
        double distance_sq;
        std::uint32_t slot;
        bool operator<(const Near& b) const { return distance_sq != b.distance_sq ? distance_sq < b.distance_sq : slot < b.slot; }
    };
    std::vector<Near> found;  // a heap, the farthest first
    double limit = count == 0 ? -1.0 : kInfinity;
    broadphase.visit_where([&](const FloatAabb& box) { return distance_sq(point, box) <= limit; },
                           [&](std::uint32_t slot) {
                               found.push_back({distance_sq(point, broadphase.box(slot)), slot});
                               std::push_heap(found.begin(), found.end());
                               if (found.size() > count) {
                                   std::pop_heap(found.begin(), found.end());
                                   found.pop_back();
                               }
                               if (found.size() == count) limit = found.front().distance_sq;
                               return true;
                           });
    std::sort_heap(found.begin(), found.end());
    std::vector<std::uint32_t> slots;
    for (const Near& near : found) slots.push_back(near.slot);
    return slots;
}

}  // namespace carom
