#include <carom/studies/oracle/exact_rays.hpp>

#include <glm/geometric.hpp>

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <cmath>

namespace carom::oracle {
namespace {

using Integer = boost::multiprecision::cpp_int;
using IntegerVector = std::array<Integer, 3>;

constexpr int kMantissaBits = 53;

// The exponent of a number's lowest bit at most; of zero: one that binds nobody.
int lowest_bit(double x) {
    if (x == 0.0) return 2000;
    int exponent = 0;
    static_cast<void>(std::frexp(x, &exponent));
    return exponent - kMantissaBits;
}

int lowest_bit(const dvec3& v) { return std::min({lowest_bit(v.x), lowest_bit(v.y), lowest_bit(v.z)}); }

// x 2^shift, which is whole.
Integer whole(double x, int shift) {
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    const Integer digits(static_cast<std::int64_t>(std::ldexp(mantissa, kMantissaBits)));
    const int up = exponent - kMantissaBits + shift;
    return x == 0.0 ? Integer(0) : Integer(digits * (Integer(1) << up));
}

IntegerVector whole(const dvec3& v, int shift) { return {whole(v.x, shift), whole(v.y, shift), whole(v.z, shift)}; }

IntegerVector minus(const IntegerVector& a, const IntegerVector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

IntegerVector cross(const IntegerVector& a, const IntegerVector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Integer dot(const IntegerVector& a, const IntegerVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// numerator / denominator for positive integers, to some 2^-63.
long double quotient(const Integer& numerator, const Integer& denominator) {
    if (numerator == 0) return 0.0L;
    const int missing = 70 + static_cast<int>(msb(denominator)) - static_cast<int>(msb(numerator));
    const int up = std::max(missing, 0);
    const Integer q = (numerator << up) / denominator;
    return std::ldexp(q.convert_to<long double>(), -up);
}

// A ray and the scales in which its numbers, and those of the triangles, are whole.
class ExactRay {
public:
    ExactRay(std::span<const vec3> vertices, const dvec3& offset, const Ray& ray) {
        int lowest = std::min(lowest_bit(ray.origin), lowest_bit(offset));
        for (const vec3& v : vertices) {
            lowest = std::min(lowest, lowest_bit(dvec3(v)));
        }
        shift_ = -lowest;
        direction_shift_ = -lowest_bit(ray.direction);
        to_origin_ = minus(whole(offset, shift_), whole(ray.origin, shift_));
        direction_ = whole(ray.direction, direction_shift_);
        const long double x = ray.direction.x, y = ray.direction.y, z = ray.direction.z;
        length_ = std::sqrt(x * x + y * y + z * z);
    }

    // The distance along the ray at which it crosses a triangle; none where it does not.
    [[nodiscard]] std::optional<long double> cross_triangle(const vec3& p, const vec3& q, const vec3& r) const {
        const IntegerVector a = seen(p), b = seen(q), c = seen(r);
        const Integer u = dot(direction_, cross(b, c)), v = dot(direction_, cross(c, a)), w = dot(direction_, cross(a, b));
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
        Integer below = u + v + w;  // direction . normal
        if (below == 0) return std::nullopt;
        Integer above = dot(a, cross(b, c));
        if (below < 0) {
            below = -below;
            above = -above;
        }
        if (above < 0) return std::nullopt;
        return std::ldexp(quotient(above, below), direction_shift_ - shift_) * length_;
    }

private:
    // A vertex relative to the ray's origin.
    [[nodiscard]] IntegerVector seen(const vec3& vertex) const {
        const IntegerVector v = whole(dvec3(vertex), shift_);
        return {v[0] + to_origin_[0], v[1] + to_origin_[1], v[2] + to_origin_[2]};
    }

    int shift_ = 0, direction_shift_ = 0;
    IntegerVector to_origin_, direction_;
    long double length_ = 1.0L;
};

// False only where the line of the ray passes the triangle by, by far more than rounding in double can hide.
bool may_cross(const std::array<dvec3, 3>& corners, const dvec3& offset, const Ray& ray, const dvec3& direction) {
    const dvec3 center = (corners[0] + corners[1] + corners[2]) / 3.0;
    double radius = 0.0;
    for (const dvec3& corner : corners) {
        radius = std::max(radius, glm::length(corner - center));
    }
    const dvec3 seen = (center + offset) - ray.origin;
    const double slack = 1e-12 * (glm::length(seen) + glm::length(ray.origin) + glm::length(offset) + glm::length(center));
    return glm::length(glm::cross(seen, direction)) <= 1.001 * radius + slack;
}

}  // namespace

std::optional<double> exact_distance(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
                                     const dvec3& offset, const Ray& ray) {
    const ExactRay exact(vertices, offset, ray);
    const dvec3 size = glm::abs(ray.direction);
    const dvec3 scaled = ray.direction / std::max({size.x, size.y, size.z});
    const dvec3 direction = scaled / glm::length(scaled);
    std::optional<long double> nearest;
    for (const std::array<std::uint32_t, 3>& t : triangles) {
        const std::array<dvec3, 3> corners{dvec3(vertices[t[0]]), dvec3(vertices[t[1]]), dvec3(vertices[t[2]])};
        if (!may_cross(corners, offset, ray, direction)) continue;
        const std::optional<long double> crossing = exact.cross_triangle(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
        if (crossing && (!nearest || *crossing < *nearest)) nearest = crossing;
    }
    return nearest ? std::optional<double>(static_cast<double>(*nearest)) : std::nullopt;
}

}  // namespace carom::oracle
