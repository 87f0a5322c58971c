#include <carom/collision/detail/plane_extent.hpp>
#include <carom/collision/detail/widen.hpp>
#include <carom/collision/plane_tests.hpp>

namespace carom::geo {
namespace {

template <class T, class Shape>
PlaneExtent measure(const Plane<T>& plane, const Shape& shape) {
    return extent_of(widened(plane), widened(shape));
}
template <class T>
PlaneExtent measure(const Plane<T>& plane, const Vec3<T>& point) {
    PlaneExtent e;
    e.add(height_of(widened(plane), dvec3(point)));
    return e;
}
template <class T>
PlaneExtent measure(const Plane<T>& plane, std::span<const Vec3<T>> hull) {
    const Plane<double> wide = widened(plane);
    PlaneExtent e;
    for (const Vec3<T>& vertex : hull) {
        e.add(height_of(wide, dvec3(vertex)));
    }
    return e;
}
template <class T>
PlaneExtent measure(const Plane<T>& plane, const Triangle<T>& triangle) {
    const std::array<Vec3<T>, 3> corners{triangle.a, triangle.b, triangle.c};
    return measure(plane, std::span<const Vec3<T>>(corners));
}

template <class T, class Shape>
Extent<T> narrowed(const Plane<T>& plane, const Shape& shape) {
    const PlaneExtent e = measure(plane, shape);
    constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
    return e.is_valid() ? Extent<T>{static_cast<T>(e.lowest), static_cast<T>(e.highest)} : Extent<T>{kNan, kNan};
}

template <class T, class Shape>
Side side(const Plane<T>& plane, const Shape& shape, T margin) {
    const PlaneExtent e = measure(plane, shape);
    const auto beyond = static_cast<double>(margin);
    if (!e.is_valid()) {
        return Side::Across;
    }
    return e.lowest > beyond ? Side::Above : e.highest < -beyond ? Side::Below : Side::Across;
}

}  // namespace

template <class T>
T signed_distance(const Plane<T>& plane, const Vec3<T>& point) noexcept {
    return narrowed(plane, point).lowest;
}
template float signed_distance(const Plane<float>&, const Vec3<float>&) noexcept;
template double signed_distance(const Plane<double>&, const Vec3<double>&) noexcept;

template <class T>
Side side_of(const Plane<T>& plane, const Vec3<T>& point, T margin) noexcept {
    return side(plane, point, margin);
}
template Side side_of(const Plane<float>&, const Vec3<float>&, float) noexcept;
template Side side_of(const Plane<double>&, const Vec3<double>&, double) noexcept;

template <class T>
Extent<T> extent(const Plane<T>& plane, std::span<const Vec3<T>> hull) noexcept {
    return narrowed(plane, hull);
}
template Extent<float> extent(const Plane<float>&, std::span<const Vec3<float>>) noexcept;
template Extent<double> extent(const Plane<double>&, std::span<const Vec3<double>>) noexcept;

template <class T>
Side side_of(const Plane<T>& plane, std::span<const Vec3<T>> hull, T margin) noexcept {
    return side(plane, hull, margin);
}
template Side side_of(const Plane<float>&, std::span<const Vec3<float>>, float) noexcept;
template Side side_of(const Plane<double>&, std::span<const Vec3<double>>, double) noexcept;

#define CAROM_PLANE_TESTS(Shape)                                                         \
    template <class T>                                                                   \
    Extent<T> extent(const Plane<T>& plane, const Shape<T>& shape) noexcept {            \
        return narrowed(plane, shape);                                                   \
    }                                                                                    \
    template <class T>                                                                   \
    Side side_of(const Plane<T>& plane, const Shape<T>& shape, T margin) noexcept {      \
        return side(plane, shape, margin);                                               \
    }                                                                                    \
    template Extent<float> extent(const Plane<float>&, const Shape<float>&) noexcept;    \
    template Extent<double> extent(const Plane<double>&, const Shape<double>&) noexcept; \
    template Side side_of(const Plane<float>&, const Shape<float>&, float) noexcept;     \
    template Side side_of(const Plane<double>&, const Shape<double>&, double) noexcept;
CAROM_PLANE_TESTS(Sphere)
CAROM_PLANE_TESTS(Aabb)
CAROM_PLANE_TESTS(Obb)
CAROM_PLANE_TESTS(Capsule)
CAROM_PLANE_TESTS(Triangle)
#undef CAROM_PLANE_TESTS

}  // namespace carom::geo
