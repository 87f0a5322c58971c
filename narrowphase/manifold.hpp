// Contact manifolds: where two shapes touch, and how deep.
#pragma once

#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace carom {

inline constexpr int kMaxManifoldPoints = 4;

/// One point of contact.
struct ContactPoint {
    vec3 position{0.0f};        ///< midway between the two surfaces, from A's shape origin along world axes [m]
    float separation = 0.0f;    ///< along the manifold's normal [m]; negative: overlap
    std::uint64_t feature = 0;  ///< names the pair of features; equal in two steps means the same point
};

/// Up to four points with one normal: one contact patch. A convex pair has at most one manifold, a mesh pair one for each patch, a
/// pair with a compound those of each of its parts.
/// Two cache lines, the points first: wide kernels write and read them as rows of 16 bytes.
struct alignas(64) Manifold {
    std::array<ContactPoint, kMaxManifoldPoints> points{};
    vec3 normal{0.0f};            ///< unit, world axes, from A to B
    std::uint32_t pair = 0;       ///< index of the pair in the batch
    std::uint32_t count = 0;      ///< points in use, 1..4
    std::uint16_t part_a = 0;     ///< of A, where it is a compound; otherwise 0
    std::uint16_t part_b = 0;

    [[nodiscard]] std::span<const ContactPoint> used() const noexcept { return {points.data(), count}; }
};

}  // namespace carom
