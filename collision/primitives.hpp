// Geometric primitives as plain values, anywhere in space, in float or in double.
//
//   geo::Obb<float> crate{.center = {0, 1, 0}, .half_extents = {0.5f, 0.5f, 0.5f}};
//   geo::Ray<double> ray{.origin = {0, 9, 0}, .direction = {0, -1, 0}};
//
// These are what the primitive tests take: rays (ray_primitives.hpp), planes (plane_tests.hpp), overlaps (overlap_tests.hpp), closest
// points (closest_points.hpp), clipping (clipping.hpp) and frusta (frustum.hpp). The shapes of bodies (shapes.hpp) lie about their own
// origin instead and are placed by a Pose; some have the same names, so import one of the two namespaces, not both.
#pragma once

#include <carom/core/types.hpp>

#include <limits>

namespace carom::geo {

template <class T>
using Vec3 = glm::vec<3, T>;
template <class T>
using Mat3 = glm::mat<3, 3, T>;

/// The points `origin + t direction` with t_min <= t <= t_max. `direction` is not zero and need not be of unit length; t counts its
/// lengths.
template <class T>
struct Ray {
    Vec3<T> origin{T(0)};
    Vec3<T> direction{T(0), T(0), T(1)};
    T t_min = T(0);
    T t_max = std::numeric_limits<T>::infinity();
};

/// The points from `a` to `b`; a point where they are equal.
template <class T>
struct Segment {
    Vec3<T> a{T(0)};
    Vec3<T> b{T(0)};
};

/// The points with dot(normal, x) = offset; the half-space below it is dot(normal, x) <= offset. The normal need not be of unit
/// length where only a side is asked for; distances come in its lengths.
template <class T>
struct Plane {
    Vec3<T> normal{T(0), T(1), T(0)};
    T offset = T(0);
};

/// A ball. radius >= 0.
template <class T>
struct Sphere {
    Vec3<T> center{T(0)};
    T radius = T(0);
};

/// A closed box along the axes. lower <= upper on each.
template <class T>
struct Aabb {
    Vec3<T> lower{T(0)};
    Vec3<T> upper{T(0)};
};

/// A closed box with axes of its own: the columns of `axes`, orthonormal to a few ulp. Half extents >= 0.
template <class T>
struct Obb {
    Vec3<T> center{T(0)};
    Vec3<T> half_extents{T(0)};
    Mat3<T> axes{T(1)};
};

/// All points within `radius` of the segment. radius >= 0.
template <class T>
struct Capsule {
    Segment<T> axis;
    T radius = T(0);
};

/// A solid cylinder with flat ends at `axis.a` and `axis.b`, which differ. radius > 0.
template <class T>
struct Cylinder {
    Segment<T> axis;
    T radius = T(0);
};

/// A solid cone from its tip to the flat disc of `radius` about `base_center`, which differ. radius > 0.
template <class T>
struct Cone {
    Vec3<T> tip{T(0)};
    Vec3<T> base_center{T(0)};
    T radius = T(0);
};

/// A flat round plate. `normal` is not zero and need not be of unit length; radius >= 0.
template <class T>
struct Disc {
    Vec3<T> center{T(0)};
    Vec3<T> normal{T(0), T(1), T(0)};
    T radius = T(0);
};

/// Counter-clockwise seen from outside.
template <class T>
struct Triangle {
    Vec3<T> a{T(0)};
    Vec3<T> b{T(0)};
    Vec3<T> c{T(0)};
};

}  // namespace carom::geo
