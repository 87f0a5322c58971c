// Names of contact points that survive small motion.
#pragma once

#include <cstdint>

namespace carom::detail {

/// What of the two shapes meets in a point.
enum class FeatureKind : std::uint32_t { Edges = 0, VertexOfFirst = 1, VertexOfSecond = 2 };

/// Name of a point of two polytopes. It does not depend on which of the two faces was the reference, so that a change of
/// reference keeps the points' names.
[[nodiscard]] constexpr std::uint64_t feature_name(FeatureKind kind, std::uint32_t first, std::uint32_t second) noexcept {
    return (static_cast<std::uint64_t>(kind) << 62) | (static_cast<std::uint64_t>(first & 0x7fffffffu) << 31) |
           (second & 0x7fffffffu);
}

/// Name of a point of a convex shape with triangle `triangle` of a mesh; `name` is the name within the pair (convex, triangle),
/// with features 0..3 of the triangle and below 2^28 of the convex shape.
[[nodiscard]] constexpr std::uint64_t triangle_feature(std::uint32_t triangle, std::uint64_t name) noexcept {
    const std::uint64_t kind = name >> 62;
    const std::uint64_t of_convex = (name >> 31) & 0xfffffffu;
    const std::uint64_t of_triangle = name & 3u;
    return (static_cast<std::uint64_t>(triangle) << 32) | (kind << 30) | (of_triangle << 28) | of_convex;
}

}  // namespace carom::detail
