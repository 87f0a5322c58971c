#include <carom/narrowphase/detail/box_sat.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <algorithm>

namespace carom::detail {

BoxPair box_pair(const PairFrame& pair) noexcept {
    BoxPair p;
    const dvec3 a(as<Box>(pair.first).half_extents), b(as<Box>(pair.second).half_extents);
    p.a[0] = a.x, p.a[1] = a.y, p.a[2] = a.z;
    p.b[0] = b.x, p.b[1] = b.y, p.b[2] = b.z;
    p.offset_a[0] = pair.translation.x, p.offset_a[1] = pair.translation.y, p.offset_a[2] = pair.translation.z;
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
        const dvec3& axis = pair.rotation[j];
        p.axes[0][j] = axis.x, p.axes[1][j] = axis.y, p.axes[2][j] = axis.z;
        p.size[0][j] = std::abs(axis.x), p.size[1][j] = std::abs(axis.y), p.size[2][j] = std::abs(axis.z);
        p.offset_b[j] = axis.x * p.offset_a[0] + axis.y * p.offset_a[1] + axis.z * p.offset_a[2];
    }
    return p;
}

bool find_box_axis(const BoxPair& p, double margin, BoxAxis& axis) noexcept {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const double s = std::abs(p.offset_a[i]) - (p.a[i] + p.size[i][0] * p.b[0] + p.size[i][1] * p.b[1] + p.size[i][2] * p.b[2]);
        if (s > margin) return false;
        if (s > axis.separation) axis = {s, i, -1};
    }
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
        const double s = std::abs(p.offset_b[j]) - (p.b[j] + p.size[0][j] * p.a[0] + p.size[1][j] * p.a[1] + p.size[2][j] * p.a[2]);
        if (s > margin) return false;
        if (s > axis.separation) axis = {s, -1, j};
    }
    BoxAxis edge;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            // e_i x b_j has no component along i, so its length suffers no cancellation as the edges become parallel.
            const double length_sq = p.axes[i1][j] * p.axes[i1][j] + p.axes[i2][j] * p.axes[i2][j];
            if (length_sq < kParallelSine * kParallelSine) continue;
            const double reach = p.a[i1] * p.size[i2][j] + p.a[i2] * p.size[i1][j] + p.b[j1] * p.size[i][j2] + p.b[j2] * p.size[i][j1];
            const double along = std::abs(p.offset_a[i2] * p.axes[i1][j] - p.offset_a[i1] * p.axes[i2][j]);
            const double s = (along - reach) / std::sqrt(length_sq);
            if (s > margin) return false;
            if (s > edge.separation) edge = {s, i, j};
        }
    }
    const double size = std::max({p.a[0], p.a[1], p.a[2], p.b[0], p.b[1], p.b[2]});
    if (edge.separation > axis.separation + kFacePreference * size) axis = edge;
    return true;
}

}  // namespace carom::detail
