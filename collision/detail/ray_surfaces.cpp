// Lines against surfaces.
#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/detail/ray_surfaces.hpp>
#include <carom/collision/detail/ray_triangle.hpp>
#include <carom/collision/detail/widen.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::geo {
namespace {

/// a b - c d within 2 ulp of itself, not only of its products; its sign is exact, or zero where products underflow.
double exact_difference(double a, double b, double c, double d) noexcept {
    const double p = a * b;
    const double q = c * d;
    const double difference = p - q;
    const double larger = std::max(std::abs(p), std::abs(q));
    if (2.0 * std::abs(difference) >= larger) [[likely]] {
        return difference;
    }
    if (larger < kLeastProduct) [[unlikely]] {
        return difference;  // which is exact: the products are within a factor of two
    }
    return difference + (product_error(a, b, p) - product_error(c, d, q));
}

/// Translated to the line's origin, axes permuted so that its largest component comes last, then sheared so that the
/// line is the last axis. A corner's image depends on the line and the corner alone, hence is the same for every
/// triangle round it.
class ShearedFrame {
public:
    explicit ShearedFrame(const Line& line) noexcept : origin_(line.origin) {
        const dvec3 size = glm::abs(line.direction);
        z_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        shear_x_ = line.direction[x_] / line.direction[z_];
        shear_y_ = line.direction[y_] / line.direction[z_];
    }
    [[nodiscard]] dvec3 image(const dvec3& corner) const noexcept {
        const dvec3 v = corner - origin_;
        return {v[x_] - shear_x_ * v[z_], v[y_] - shear_y_ * v[z_], v[z_]};
    }
    [[nodiscard]] int main_axis() const noexcept { return z_; }

private:
    dvec3 origin_;
    int x_ = 0;
    int y_ = 1;
    int z_ = 2;
    double shear_x_ = 0.0;
    double shear_y_ = 0.0;
};

/// Counts one edge from p to q of an outline about the point (0, 0).
class Outline {
public:
    void add(const dvec2& p, const dvec2& q) noexcept {
        const double side = difference_of_products(p.x, q.y, q.x, p.y);
        const bool spans_x = std::min(p.x, q.x) <= 0.0 && std::max(p.x, q.x) >= 0.0;
        const bool spans_y = std::min(p.y, q.y) <= 0.0 && std::max(p.y, q.y) >= 0.0;
        on_it_ = on_it_ || (side == 0.0 && spans_x && spans_y);
        // Half-open in y, so that a corner on the line outward counts for one of its edges.
        if ((p.y > 0.0) != (q.y > 0.0) && (side > 0.0) == (q.y > p.y)) {
            odd_ = !odd_;
        }
    }
    [[nodiscard]] bool holds_point() const noexcept { return odd_ || on_it_; }

private:
    bool odd_ = false;
    bool on_it_ = false;
};

}  // namespace

std::optional<Crossing> cross(const Plane<double>& plane, const Line& line) noexcept {
    const double rate = accurate_dot(plane.normal, line.direction, 0.0);
    if (rate == 0.0) {
        return std::nullopt;
    }
    return Crossing{-accurate_dot(plane.normal, line.origin, plane.offset) / rate, plane.normal};
}

std::optional<Crossing> cross(const Disc<double>& disc, const Line& line) noexcept {
    const dvec3 to_center = disc.center - line.origin;
    const double rate = accurate_dot(disc.normal, line.direction, 0.0);
    if (rate == 0.0) {
        return std::nullopt;
    }
    const double t = accurate_dot(disc.normal, to_center, 0.0) / rate;
    const dvec3 from_center = t * line.direction - to_center;
    if (!(glm::dot(from_center, from_center) <= disc.radius * disc.radius)) {
        return std::nullopt;
    }
    return Crossing{t, disc.normal};
}

std::optional<Crossing> cross(const Triangle<double>& triangle, const Line& line) noexcept {
    const ShearedFrame frame(line);
    dvec3 p = frame.image(triangle.a);
    dvec3 q = frame.image(triangle.b);
    dvec3 r = frame.image(triangle.c);
    const double size = std::max({std::abs(p.x), std::abs(p.y), std::abs(q.x), std::abs(q.y), std::abs(r.x), std::abs(r.y)});
    if (size < 0x1p-400 && size > 0.0) [[unlikely]] {
        // Products would underflow and take every edge with them. Scaled by a power of two the signs are the same ones, so that
        // neighbours that need no scaling agree.
        const int up = std::min(-std::ilogb(size), 1000);
        for (dvec3* image : {&p, &q, &r}) {
            image->x = std::ldexp(image->x, up);
            image->y = std::ldexp(image->y, up);
        }
    }
    const std::optional<dvec3> weights = weights_at_axis(p, q, r, exact_difference);
    if (!weights) {
        return std::nullopt;
    }
    const double z = weights->x * p.z + weights->y * q.z + weights->z * r.z;
    return Crossing{z / line.direction[frame.main_axis()], glm::cross(triangle.b - triangle.a, triangle.c - triangle.a),
                    *weights};
}

template <class T>
std::optional<Crossing> cross(std::span<const Vec3<T>> corners, double scale, const Line& line) noexcept {
    const auto corner = [&](std::size_t i) { return scale * dvec3(corners[i]); };
    const dvec3 first = corner(0);
    dvec3 normal{0.0};
    dvec3 arm = corner(1) - first;
    double reach = largest(arm);
    for (std::size_t i = 2; i < corners.size(); ++i) {
        const dvec3 next = corner(i) - first;
        normal += glm::cross(arm, next);
        arm = next;
        reach = std::max(reach, largest(arm));
    }
    // Each of n cross products errs by 6 u of 2 reach^2 and their sum by n u of n times that: a normal below is all rounding.
    const auto n = static_cast<double>(corners.size());
    if (!(largest(normal) > n * (n + 6.0) * 0x1p-52 * (reach * reach))) {
        return std::nullopt;
    }
    const std::optional<Crossing> crossing =
        cross(Disc<double>{first, normal, std::numeric_limits<double>::infinity()}, line);
    if (!crossing) {
        return std::nullopt;
    }
    const dvec3 size = glm::abs(normal);
    const int dropped = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const int x = (dropped + 1) % 3;
    const int y = (dropped + 2) % 3;
    const auto image = [&](std::size_t i) {
        const dvec3 v = (corner(i) - line.origin) - crossing->t * line.direction;
        return dvec2{v[x], v[y]};
    };
    Outline outline;
    dvec2 previous = image(corners.size() - 1);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const dvec2 next = image(i);
        outline.add(previous, next);
        previous = next;
    }
    return outline.holds_point() ? crossing : std::nullopt;
}

template std::optional<Crossing> cross(std::span<const Vec3<float>>, double, const Line&) noexcept;
template std::optional<Crossing> cross(std::span<const Vec3<double>>, double, const Line&) noexcept;

}  // namespace carom::geo
