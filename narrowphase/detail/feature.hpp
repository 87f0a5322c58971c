// Names of contact points that survive small motion.
#pragma once

#include <algorithm>
#include <array>
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

/// One number from another, so that numbers that differ little share none by rule: the finalizer of SplitMix64 (Steele, Lea, Flood
/// 2014). It is one to one.
[[nodiscard]] constexpr std::uint64_t scrambled(std::uint64_t x) noexcept {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// Name of a point of a convex shape with a triangle of a mesh, of which `corners` are the vertices; `name` is the name within the pair
/// (convex, triangle), with features 0..2 of the triangle. It names the vertex or edge of the mesh and no triangle: a point on an edge
/// belongs to both triangles beside it, and rounding says which of them has it in a step.
[[nodiscard]] constexpr std::uint64_t mesh_feature(const std::array<std::uint32_t, 3>& corners, std::uint64_t name) noexcept {
    constexpr std::uint64_t kKind = std::uint64_t{3} << 62;
    const std::uint64_t kind = name & kKind;
    const auto of_convex = static_cast<std::uint32_t>((name >> 31) & 0x7fffffffu);
    const auto of_triangle = static_cast<std::size_t>(name & 3u) % 3;
    if (kind == feature_name(FeatureKind::VertexOfFirst, 0, 0)) return kind | of_convex;
    if (kind == feature_name(FeatureKind::VertexOfSecond, 0, 0)) return kind | corners[of_triangle];
    const std::uint32_t a = corners[of_triangle], b = corners[(of_triangle + 1) % 3];
    const std::uint64_t edge = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
    return scrambled(scrambled(edge) + of_convex) & ~kKind;
}

}  // namespace carom::detail
