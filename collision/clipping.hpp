// Segments and polygons cut by half-spaces, boxes and frusta.
//
//   if (auto seen = geo::clip(segment, box)) { draw(seen->segment); }
//   geo::PolygonClipper<float> clipper;                       // keep it: its buffers are used again
//   std::span<const vec3> visible = clipper.clip(polygon, frustum);
//
// A half-space is what lies below a plane, dot(normal, x) <= offset; normals need not be of unit length. A frustum is what lies above
// its planes: cut by the frustum itself, which knows that; its planes one by one, or in a span, would keep the rest of the world. Solids are closed: what lies in
// a face is kept.
//   Accuracy   computed in double, float rounded once. Whether an end or a corner is inside a half-space or a box along
//              the axes is decided exactly, but for underflow: below 1e-240 m sides may be taken for the face itself. Ends
//              and corners inside are returned bit for bit. Where a cut lies: each function. eps is that of double. Pinned
//              in tests/collision/clipping_test.cpp against exact rationals.
//   Bad input  NaN or infinity (of a double, anything above 1e150), an inverted box, negative half extents: nothing is kept. A plane
//              without a normal keeps all where 0 <= offset, and nothing otherwise.
//   Cost       O(corners x planes); no allocation but for a clipper's buffers; thread-safe.
#pragma once

#include <carom/collision/frustum.hpp>
#include <carom/collision/primitives.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace carom::geo {

/// What is left of a segment: a + t (b - a) for t_a <= t <= t_b, within [0, 1].
template <class T>
struct ClippedSegment {
    Segment<T> segment;
    T t_a = T(0);
    T t_b = T(1);
};

/// Bit 2k: below the box on axis k; bit 2k + 1: above it. 0: inside. Two points with a bit in common see nothing of the
/// box between them (Cohen and Sutherland). NaN has no bits.
template <class T>
[[nodiscard]] constexpr std::uint8_t outcode(const Aabb<T>& box, const Vec3<T>& point) noexcept {
    unsigned code = 0;
    for (int k = 0; k < 3; ++k) {
        code |= (point[k] < box.lower[k] ? 1u : 0u) << (2 * k);
        code |= (point[k] > box.upper[k] ? 2u : 0u) << (2 * k);
    }
    return static_cast<std::uint8_t>(code);
}

/// Cut by the half-space below a plane. t has a relative error of 16 eps.
template <class T>
[[nodiscard]] std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Plane<T>& below) noexcept;
/// Cut by all of the half-spaces below `planes`, (n,): as by the exact half-spaces, moved by at most 16 eps of the
/// segment's length. Source: Cyrus and Beck (1978), from the heights of both ends rather than from the direction.
template <class T>
[[nodiscard]] std::optional<ClippedSegment<T>> clip(const Segment<T>& segment,
                                                    std::span<const Plane<T>> planes) noexcept;
/// Accepted and rejected by outcodes where they suffice, otherwise cut with faces moved by at most 8 eps of the
/// segment's length. The result is within the box, to the bit. Source: Liang and Barsky (1984).
template <class T>
[[nodiscard]] std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Aabb<T>& box) noexcept;
/// In the box's own frame, moved by at most 16 eps of the distance of the ends from its center plus the size of the
/// box.
template <class T>
[[nodiscard]] std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Obb<T>& box) noexcept;
template <class T>
[[nodiscard]] std::optional<ClippedSegment<T>> clip(const Segment<T>& segment, const Frustum<T>& frustum) noexcept;

/// Cuts flat polygons, one plane at a time, and holds the result until the next call. Allocates only where a polygon
/// has more corners than any before.
///
/// A convex polygon of n corners gains at most one for each plane: n + planes. One that is not has at most 3/2 times its
/// corners after each; where a plane cuts it into several pieces those stay joined by edges along that plane, outside of
/// the polygon (Sutherland and Hodgman 1974). Fewer than three corners count as nothing. Two polygons that share an edge
/// are cut at the same point of it, to the bit, whichever way round they have it.
/// Accuracy, in ulp (of T) of the largest coordinate: corners of the result are within 4 of each half-space and within 8 of
/// the polygon's plane, and of the polygon itself where it is a triangle. Of a box along the axes they are within it to
/// the bit.
template <class T>
class PolygonClipper {
public:
    /// @return (m,) corners in the polygon's order, valid until the next call; empty where nothing is left. `polygon`
    /// may be the result of the call before.
    std::span<const Vec3<T>> clip(std::span<const Vec3<T>> polygon, const Plane<T>& below);
    std::span<const Vec3<T>> clip(std::span<const Vec3<T>> polygon, std::span<const Plane<T>> planes);
    std::span<const Vec3<T>> clip(std::span<const Vec3<T>> polygon, const Aabb<T>& box);
    std::span<const Vec3<T>> clip(std::span<const Vec3<T>> polygon, const Obb<T>& box);
    std::span<const Vec3<T>> clip(std::span<const Vec3<T>> polygon, const Frustum<T>& frustum);

private:
    bool load(std::span<const Vec3<T>> polygon);
    void cut(const Plane<double>& below);
    void cut(int axis, T bound, bool keep_less);
    template <class Height, class Settle>
    void cut_by(Height height, Settle settle);
    std::span<const Vec3<T>> result();

    std::vector<Vec3<T>> corners_;
    std::vector<Vec3<T>> next_;
};

extern template class PolygonClipper<float>;
extern template class PolygonClipper<double>;

}  // namespace carom::geo
