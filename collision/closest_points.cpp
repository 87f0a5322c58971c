#include <carom/collision/closest_points.hpp>

#include <carom/collision/detail/closest_pair.hpp>

#include <limits>

namespace carom::geo {
namespace {

// Two points and radii about them: where the balls are nearest, or a point of both.
detail::Nearest rounded(const detail::Nearest& n, double radius_a, double radius_b) noexcept {
    const double sum = radius_a + radius_b;
    if (sum == 0.0) return n;
    const dvec3 d = n.b - n.a;
    const double distance = std::sqrt(n.sq);
    if (distance <= sum) {
        const dvec3 shared = n.a + (radius_a / sum) * d;
        return {shared, shared, 0.0};
    }
    const double gap = distance - sum;
    return {n.a + (radius_a / distance) * d, n.b - (radius_b / distance) * d, gap * gap};
}

}  // namespace

template <Measurable A, Measurable B>
requires std::same_as<detail::Scalar<A>, detail::Scalar<B>> ClosestPoints<detail::Scalar<A>> closest_points(const A& a, const B& b)
noexcept {
    using T = detail::Scalar<A>;
    const auto pair = detail::make_pair(a, b);
    if (!pair.valid) {
        constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
        return {Vec3<T>{kNan}, Vec3<T>{kNan}, kNan};
    }
    const detail::Nearest n = rounded(detail::closest_cores(pair), pair.radius_a, pair.radius_b);
    const double back = 1.0 / pair.scale;  // exact
    return {Vec3<T>(pair.origin + back * n.a), Vec3<T>(pair.origin + back * n.b), static_cast<T>(back * (back * n.sq))};
}

#define CAROM_CLOSEST(A, B, T) template ClosestPoints<T> closest_points<A<T>, B<T>>(const A<T>&, const B<T>&) noexcept;
#define CAROM_CLOSEST_ALL(A, T)   \
    CAROM_CLOSEST(A, Vec3, T)     \
    CAROM_CLOSEST(A, Segment, T)  \
    CAROM_CLOSEST(A, Triangle, T) \
    CAROM_CLOSEST(A, Aabb, T) CAROM_CLOSEST(A, Obb, T) CAROM_CLOSEST(A, Capsule, T) CAROM_CLOSEST(A, Sphere, T)
#define CAROM_CLOSEST_TABLE(T)     \
    CAROM_CLOSEST_ALL(Vec3, T)     \
    CAROM_CLOSEST_ALL(Segment, T)  \
    CAROM_CLOSEST_ALL(Triangle, T) \
    CAROM_CLOSEST_ALL(Aabb, T) CAROM_CLOSEST_ALL(Obb, T) CAROM_CLOSEST_ALL(Capsule, T) CAROM_CLOSEST_ALL(Sphere, T)
CAROM_CLOSEST_TABLE(float)
CAROM_CLOSEST_TABLE(double)
#undef CAROM_CLOSEST_TABLE
#undef CAROM_CLOSEST_ALL
#undef CAROM_CLOSEST

}  // namespace carom::geo
