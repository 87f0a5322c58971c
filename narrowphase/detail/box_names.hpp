// The names of a box's corners and edges, in tables that lanes look up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace carom::detail {

/// Bit k of a corner is set on the positive side of axis k; an edge is 4 * axis + the signs of the next two.
constexpr std::int32_t edge_number(int axis, std::int32_t corner) noexcept {
    return 4 * axis + ((corner >> ((axis + 1) % 3)) & 1) + 2 * ((corner >> ((axis + 2) % 3)) & 1);
}

/// By the face's axis and the signs of the normal that leaves it (bit k: not negative along axis k), in this order from the coarsest: eight
/// numbers of four bits, the first lowest. Corners run (+,+), (-,+), (-,-), (+,-) in the two axes after the face's own; edge k goes from corner
/// k to k + 1; sides are the edges on p+, p-, q+, q-.
struct BoxNames {
    alignas(64) std::uint32_t corners_and_sides[24] = {};
    alignas(64) std::uint32_t corners_and_edges[24] = {};
    alignas(64) std::int32_t leading[24] = {};  ///< by axis and signs: the edge along the axis that is farthest along the normal
};

constexpr BoxNames make_box_names() noexcept {
    BoxNames names;
    for (int axis = 0; axis < 3; ++axis) {
        const int p = (axis + 1) % 3, q = (axis + 2) % 3;
        for (int toward = 0; toward < 8; ++toward) {
            const int face = 8 * axis + toward;
            std::uint32_t corners = 0, edges = 0, sides = 0;
            for (int k = 0; k < 4; ++k) {
                constexpr int kSideOfEdge[4] = {2, 1, 3, 0};
                const std::int32_t corner = (toward & (1 << axis)) | (k == 0 || k == 3 ? 1 << p : 0) | (k < 2 ? 1 << q : 0);
                const auto edge = static_cast<std::uint32_t>(edge_number(k % 2 == 0 ? p : q, corner));
                corners |= static_cast<std::uint32_t>(corner) << (4 * k);
                edges |= edge << (4 * k);
                sides |= edge << (4 * kSideOfEdge[k]);
            }
            names.corners_and_sides[face] = corners | (sides << 16);
            names.corners_and_edges[face] = corners | (edges << 16);
            names.leading[face] = edge_number(axis, toward);
        }
    }
    return names;
}
inline constexpr BoxNames kBoxNames = make_box_names();

}  // namespace carom::detail
