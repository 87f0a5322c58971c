#include <carom/collision/detail/plane_extent.hpp>
#include <carom/collision/detail/widen.hpp>
#include <carom/collision/frustum.hpp>
#include <carom/core/math.hpp>

#include <optional>

namespace carom::geo {
namespace {

constexpr const char* kWhere = "frustum_of";

/// `v` of unit length, or nothing where it is zero.
std::optional<dvec3> unit(dvec3 v) {
    const double size = largest(v);
    if (!(size > 0.0)) {
        return std::nullopt;
    }
    int exponent = 0;
    static_cast<void>(std::frexp(size, &exponent));
    v = {std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent), std::ldexp(v.z, -exponent)};
    return v / std::sqrt(glm::dot(v, v));
}

/// The plane through `point`, rounded once.
template <class T>
Plane<T> plane_at(const dvec3& normal, const dvec3& point, double beyond) {
    const double offset = accurate_dot(normal, point, -beyond);
    return {Vec3<T>(normal), static_cast<T>(offset)};
}

template <class T>
Status validate(const Camera<T>& c) {
    const T infinity = std::numeric_limits<T>::infinity();
    const bool finite = is_finite(c.position) && is_finite(c.forward) && is_finite(c.up) && is_finite(c.fovy) &&
                        is_finite(c.aspect) && is_finite(c.near_distance) &&
                        (is_finite(c.far_distance) || c.far_distance == infinity);
    if (!finite) {
        return Error{ErrorCode::NotFinite, "the camera has a field that is not finite", kWhere};
    }
    if (!(c.fovy > T(0) && static_cast<double>(c.fovy) < kPi)) {
        return Error{ErrorCode::InvalidArgument, "fovy is not in (0, pi)", kWhere};
    }
    if (!(c.aspect > T(0))) {
        return Error{ErrorCode::InvalidArgument, "aspect is not positive", kWhere};
    }
    if (!(c.near_distance >= T(0) && c.far_distance > c.near_distance)) {
        return Error{ErrorCode::InvalidArgument, "near_distance and far_distance are not 0 <= near < far", kWhere};
    }
    return {};
}

/// Everything is above it.
template <class T>
constexpr Plane<T> kNoPlane{{T(0), T(0), T(0)}, T(-1)};

template <class T, class Shape>
Containment contain(const Frustum<T>& frustum, const Shape& shape) {
    Containment result = Containment::Inside;
    for (const Plane<T>& plane : frustum.planes) {
        const PlaneExtent e = extent_of(widened(plane), shape);
        if (!e.is_valid()) {
            return Containment::Across;
        }
        if (e.highest < -e.error) {
            return Containment::Outside;
        }
        if (!(e.lowest >= e.error)) {
            result = Containment::Across;
        }
    }
    return result;
}

}  // namespace

template <class T>
Result<Frustum<T>> frustum_of(const Camera<T>& camera) {
    if (const Status status = validate(camera); !status) {
        return status.error();
    }
    const std::optional<dvec3> forward = unit(dvec3(camera.forward));
    const std::optional<dvec3> up_given = unit(dvec3(camera.up));
    const dvec3 across = forward && up_given ? glm::cross(*forward, *up_given) : dvec3{0.0};
    const std::optional<dvec3> right = unit(across);
    // The sine of an angle that rounding of T alone may make of none.
    if (!right || largest(across) <= 4.0 * static_cast<double>(std::numeric_limits<T>::epsilon())) {
        return Error{ErrorCode::Degenerate, "forward or up is zero, or one is along the other", kWhere};
    }
    const dvec3 up = glm::cross(*right, *forward);
    const SinCos half = sin_cos(0.5 * static_cast<double>(camera.fovy));
    const double aspect = static_cast<double>(camera.aspect);
    const dvec3 eye(camera.position);
    // A side's normal is at a right angle to the ray in the middle of that side.
    const auto side = [&](const dvec3& outward, double width) {
        return plane_at<T>(*unit(width * half.sin * *forward - half.cos * outward), eye, 0.0);
    };
    const auto far = static_cast<double>(camera.far_distance);
    return Frustum<T>{{side(-*right, aspect), side(*right, aspect), side(-up, 1.0), side(up, 1.0),
                       plane_at<T>(*forward, eye, static_cast<double>(camera.near_distance)),
                       is_finite(far) ? plane_at<T>(-*forward, eye, -far) : kNoPlane<T>}};
}

template <class T>
Result<Frustum<T>> frustum_of(const glm::mat<4, 4, T>& view_projection, ClipDepth depth) {
    const glm::dmat4 m(view_projection);
    const auto row = [&](int i) { return glm::dvec4(m[0][i], m[1][i], m[2][i], m[3][i]); };
    const glm::dvec4 w = row(3);
    const glm::dvec4 near = depth == ClipDepth::ZeroToOne ? row(2) : w + row(2);
    const std::array<glm::dvec4, 6> above{w + row(0), w - row(0), w + row(1), w - row(1), near, w - row(2)};
    Frustum<T> frustum;
    for (std::size_t i = 0; i < above.size(); ++i) {
        const dvec3 normal(above[i]);
        if (!is_finite(normal) || !is_finite(above[i].w)) {
            return Error{ErrorCode::NotFinite, "the matrix is not finite", kWhere};
        }
        if (normal == dvec3{0.0}) {
            // The near or far plane may be at infinity; a side that is not there is none that a projection has.
            if (i < 4 || !(above[i].w >= 0.0)) {
                return Error{ErrorCode::Degenerate, "nothing defines plane " + std::to_string(i), kWhere};
            }
            frustum.planes[i] = kNoPlane<T>;
            continue;
        }
        int exponent = 0;
        static_cast<void>(std::frexp(largest(normal), &exponent));
        const double scale = std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));
        const double size = length(scale * normal);
        frustum.planes[i] = {Vec3<T>(scale * normal / size), static_cast<T>(-scale * above[i].w / size)};
    }
    return frustum;
}

template <class T>
Containment classify(const Frustum<T>& frustum, const Sphere<T>& sphere) noexcept {
    return contain(frustum, widened(sphere));
}
template <class T>
Containment classify(const Frustum<T>& frustum, const Aabb<T>& box) noexcept {
    return contain(frustum, widened(box));
}
template <class T>
Containment classify(const Frustum<T>& frustum, const Obb<T>& box) noexcept {
    return contain(frustum, widened(box));
}

#define CAROM_FRUSTUM(T)                                                         \
    template Result<Frustum<T>> frustum_of(const Camera<T>&);                    \
    template Result<Frustum<T>> frustum_of(const glm::mat<4, 4, T>&, ClipDepth); \
    template Containment classify(const Frustum<T>&, const Sphere<T>&) noexcept; \
    template Containment classify(const Frustum<T>&, const Aabb<T>&) noexcept;   \
    template Containment classify(const Frustum<T>&, const Obb<T>&) noexcept;
CAROM_FRUSTUM(float)
CAROM_FRUSTUM(double)
#undef CAROM_FRUSTUM

}  // namespace carom::geo
