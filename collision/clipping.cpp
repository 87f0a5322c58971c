#include <carom/collision/clipping.hpp>
#include <carom/collision/detail/plane_extent.hpp>
#include <carom/collision/detail/widen.hpp>

#include <algorithm>
#include <cmath>

namespace carom::geo {
namespace {

/// Beyond it, products of two overflow.
constexpr double kTooLarge = 1e150;

bool is_usable(const dvec3& v) { return largest(v) <= kTooLarge && is_finite(v); }
bool is_usable(const Plane<double>& p) { return is_usable(p.normal) && std::abs(p.offset) <= kTooLarge; }
template <class T>
bool is_usable(const Segment<T>& s) {
    return is_usable(dvec3(s.a)) && is_usable(dvec3(s.b));
}
bool is_usable(const Aabb<double>& b) {
    return is_usable(b.lower) && is_usable(b.upper) && glm::all(glm::lessThanEqual(b.lower, b.upper));
}
bool is_usable(const Obb<double>& b) {
    return is_usable(b.center) && is_usable(b.half_extents) &&
           glm::all(glm::greaterThanEqual(b.half_extents, dvec3{0.0})) && is_usable(b.axes[0]) &&
           is_usable(b.axes[1]) && is_usable(b.axes[2]);
}

/// A tiny normal would lose its digits in products, unless they are so far from the offset that only its sign counts.
template <class T>
Plane<double> usable(const Plane<T>& given) {
    const Plane<double> plane = widened(given);
    const Plane<double> scaled = balanced(plane);
    return is_usable(scaled) ? scaled : plane;
}

Plane<double> flipped(const Plane<double>& p) { return {-p.normal, -p.offset}; }

/// The part of a segment that is left.
struct Part {
    double from = 0.0;
    double to = 1.0;

    /// Keeps where a height that goes from `at_a` to `at_b` is <= 0.
    /// @return false where nothing is left.
    bool keep_below(double at_a, double at_b) {
        if (at_a > 0.0 && at_b > 0.0) {
            return false;
        }
        if (at_a > 0.0) {
            from = std::max(from, at_a / (at_a - at_b));
        } else if (at_b > 0.0) {
            to = std::min(to, at_a / (at_a - at_b));
        }
        return from <= to;
    }
};

/// Between a and b, at `t` from a, never beyond either on any axis.
dvec3 between(const dvec3& a, const dvec3& b, double t) {
    return glm::clamp(a + t * (b - a), glm::min(a, b), glm::max(a, b));
}

template <class T>
ClippedSegment<T> cut_to(const Segment<T>& segment, const Part& part) {
    const dvec3 a(segment.a);
    const dvec3 b(segment.b);
    ClippedSegment<T> result{segment, static_cast<T>(part.from), static_cast<T>(part.to)};
    if (part.from > 0.0) {
        result.segment.a = Vec3<T>(between(a, b, part.from));
    }
    if (part.to < 1.0) {
        result.segment.b = Vec3<T>(between(a, b, part.to));
    }
    return result;
}

bool keep_below(Part& part, const Plane<double>& plane, const dvec3& a, const dvec3& b) {
    return is_usable(plane) && part.keep_below(height_of(plane, a), height_of(plane, b));
}

}  // namespace

// ---------------------------------------------------------------------------------------------------------------------
// segments

template <class T>
std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Plane<T>& below) noexcept {
    return clip(segment, std::span<const Plane<T>>(&below, 1));
}

template <class T>
std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, std::span<const Plane<T>> planes) noexcept {
    Part part;
    const auto keep = [&](const Plane<T>& p) {
        return keep_below(part, usable(p), dvec3(segment.a), dvec3(segment.b));
    };
    if (!is_usable(segment) || !std::ranges::all_of(planes, keep)) {
        return std::nullopt;
    }
    return cut_to(segment, part);
}

template <class T>
std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Frustum<T>& frustum) noexcept {
    Part part;
    const auto keep = [&](const Plane<T>& p) {
        return keep_below(part, flipped(usable(p)), dvec3(segment.a), dvec3(segment.b));
    };
    if (!is_usable(segment) || !std::ranges::all_of(frustum.planes, keep)) {
        return std::nullopt;
    }
    return cut_to(segment, part);
}

template <class T>
std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Aabb<T>& box) noexcept {
    if (!is_usable(segment) || !is_usable(widened(box))) {
        return std::nullopt;
    }
    const unsigned out_a = outcode(box, segment.a);
    const unsigned out_b = outcode(box, segment.b);
    if ((out_a & out_b) != 0) {
        return std::nullopt;
    }
    if ((out_a | out_b) == 0) {
        return ClippedSegment<T>{segment};
    }
    const Aabb<double> wide = widened(box);
    const dvec3 a(segment.a);
    const dvec3 b(segment.b);
    Part part;
    for (int k = 0; k < 3; ++k) {
        if (!part.keep_below(wide.lower[k] - a[k], wide.lower[k] - b[k]) ||
            !part.keep_below(a[k] - wide.upper[k], b[k] - wide.upper[k])) {
            return std::nullopt;
        }
    }
    ClippedSegment<T> result = cut_to(segment, part);
    result.segment.a = glm::clamp(result.segment.a, box.lower, box.upper);
    result.segment.b = glm::clamp(result.segment.b, box.lower, box.upper);
    return result;
}

template <class T>
std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Obb<T>& box) noexcept {
    const Obb<double> wide = widened(box);
    if (!is_usable(segment) || !is_usable(wide)) {
        return std::nullopt;
    }
    const dvec3 a = dvec3(segment.a) - wide.center;
    const dvec3 b = dvec3(segment.b) - wide.center;
    Part part;
    for (int k = 0; k < 3; ++k) {
        const double at_a = glm::dot(wide.axes[k], a);
        const double at_b = glm::dot(wide.axes[k], b);
        const double half = wide.half_extents[k];
        if (!part.keep_below(-half - at_a, -half - at_b) || !part.keep_below(at_a - half, at_b - half)) {
            return std::nullopt;
        }
    }
    return cut_to(segment, part);
}

// ---------------------------------------------------------------------------------------------------------------------
// polygons

/// Copies the polygon, which may be the last result.
template <class T>
bool PolygonClipper<T>::load(std::span<const Vec3<T>> polygon) {
    next_.assign(polygon.begin(), polygon.end());
    std::swap(corners_, next_);
    return std::ranges::all_of(corners_, [](const Vec3<T>& c) { return is_usable(dvec3(c)); });
}

template <class T>
std::span<const Vec3<T>> PolygonClipper<T>::result() {
    if (corners_.size() < 3) {
        corners_.clear();
    }
    return corners_;
}

/// Keeps where `height` is <= 0. A cut is always measured from the corner inside, so that it does not depend on the
/// polygon's turn.
template <class T>
template <class Height, class Settle>
void PolygonClipper<T>::cut_by(Height height, Settle settle) {
    next_.clear();
    if (!corners_.empty()) {
        Vec3<T> before = corners_.back();
        double before_height = height(before);
        for (const Vec3<T>& corner : corners_) {
            const double corner_height = height(corner);
            const bool leaves = before_height < 0.0 && corner_height > 0.0;
            const bool enters = before_height > 0.0 && corner_height < 0.0;
            if (leaves || enters) {
                const double inside = leaves ? before_height : corner_height;
                const double outside = leaves ? corner_height : before_height;
                const dvec3 from(leaves ? before : corner);
                const dvec3 to(leaves ? corner : before);
                next_.push_back(settle(Vec3<T>(between(from, to, inside / (inside - outside)))));
            }
            if (corner_height <= 0.0) {
                next_.push_back(corner);
            }
            before = corner;
            before_height = corner_height;
        }
    }
    std::swap(corners_, next_);
}

template <class T>
void PolygonClipper<T>::cut(const Plane<double>& below) {
    if (!is_usable(below)) {
        corners_.clear();
        return;
    }
    cut_by([&](const Vec3<T>& c) { return height_of(below, dvec3(c)); }, [](const Vec3<T>& c) { return c; });
}

template <class T>
void PolygonClipper<T>::cut(int axis, T bound, bool keep_less) {
    const auto at = static_cast<double>(bound);
    const auto height = [&](const Vec3<T>& c) {
        const auto x = static_cast<double>(c[axis]);
        return keep_less ? x - at : at - x;
    };
    cut_by(height, [&](Vec3<T> c) {
        c[axis] = bound;
        return c;
    });
}

template <class T>
std::span<const Vec3<T>> PolygonClipper<T>::clip(std::span<const Vec3<T>> polygon, const Plane<T>& below) {
    return clip(polygon, std::span<const Plane<T>>(&below, 1));
}

template <class T>
std::span<const Vec3<T>> PolygonClipper<T>::clip(std::span<const Vec3<T>> polygon, std::span<const Plane<T>> planes) {
    if (!load(polygon)) {
        corners_.clear();
    }
    for (const Plane<T>& plane : planes) {
        cut(usable(plane));
    }
    return result();
}

template <class T>
std::span<const Vec3<T>> PolygonClipper<T>::clip(std::span<const Vec3<T>> polygon, const Frustum<T>& frustum) {
    if (!load(polygon)) {
        corners_.clear();
    }
    for (const Plane<T>& plane : frustum.planes) {
        cut(flipped(usable(plane)));
    }
    return result();
}

template <class T>
std::span<const Vec3<T>> PolygonClipper<T>::clip(std::span<const Vec3<T>> polygon, const Aabb<T>& box) {
    if (!load(polygon) || !is_usable(widened(box))) {
        corners_.clear();
    }
    for (int k = 0; k < 3; ++k) {
        cut(k, box.lower[k], false);
        cut(k, box.upper[k], true);
    }
    return result();
}

template <class T>
std::span<const Vec3<T>> PolygonClipper<T>::clip(std::span<const Vec3<T>> polygon, const Obb<T>& box) {
    const Obb<double> wide = widened(box);
    if (!load(polygon) || !is_usable(wide)) {
        corners_.clear();
    }
    for (int k = 0; k < 3; ++k) {
        const dvec3& axis = wide.axes[k];
        const double center = accurate_dot(axis, wide.center, 0.0);
        cut(Plane<double>{axis, center + wide.half_extents[k]});
        cut(Plane<double>{-axis, wide.half_extents[k] - center});
    }
    return result();
}

template class PolygonClipper<float>;
template class PolygonClipper<double>;

#define CAROM_CLIPPING(T)                                                                                  \
    template std::optional<ClippedSegment<T>> clip(const Segment<T>&, const Plane<T>&) noexcept;           \
    template std::optional<ClippedSegment<T>> clip(const Segment<T>&, std::span<const Plane<T>>) noexcept; \
    template std::optional<ClippedSegment<T>> clip(const Segment<T>&, const Aabb<T>&) noexcept;            \
    template std::optional<ClippedSegment<T>> clip(const Segment<T>&, const Obb<T>&) noexcept;             \
    template std::optional<ClippedSegment<T>> clip(const Segment<T>&, const Frustum<T>&) noexcept;
CAROM_CLIPPING(float)
CAROM_CLIPPING(double)
#undef CAROM_CLIPPING

}  // namespace carom::geo
