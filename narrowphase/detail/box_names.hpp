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

/// By the face's axis, the signs of the normal that leaves it (bit k: not negative along axis k) and a number within the face, in this
/// order from the coarsest. Corners run (+,+), (-,+), (-,-), (+,-) in the two axes after the face's own; edge k goes from corner k to k + 1;
/// sides are the edges on p+, p-, q+, q-.
struct BoxNames {
    alignas(64) std::int32_t corner[96] = {};
    alignas(64) std::int32_t edge[96] = {};
    alignas(64) std::int32_t side[96] = {};
    alignas(64) std::int32_t leading[24] = {};  ///< by axis and signs: the edge along the axis that is farthest along the normal
};

constexpr BoxNames make_box_names() noexcept {
    BoxNames names;
    for (int axis = 0; axis < 3; ++axis) {
        const int p = (axis + 1) % 3, q = (axis + 2) % 3;
        for (int toward = 0; toward < 8; ++toward) {
            const int face = 32 * axis + 4 * toward;
            for (int k = 0; k < 4; ++k) {
                names.corner[face + k] = (toward & (1 << axis)) | (k == 0 || k == 3 ? 1 << p : 0) | (k < 2 ? 1 << q : 0);
                names.edge[face + k] = edge_number(k % 2 == 0 ? p : q, names.corner[face + k]);
            }
            constexpr int kEdgeOfSide[4] = {3, 1, 0, 2};
            for (int k = 0; k < 4; ++k) names.side[face + k] = names.edge[face + kEdgeOfSide[k]];
            names.leading[8 * axis + toward] = edge_number(axis, toward);
        }
    }
    return names;
}
inline constexpr BoxNames kBoxNames = make_box_names();

}  // namespace carom::detail
