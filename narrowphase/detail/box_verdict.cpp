#include <carom/narrowphase/detail/box_verdict.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {

Overlap judge_boxes(const vec3& half_a, const Pose& pose_a, const vec3& half_b, const Pose& pose_b) noexcept {
    const dvec3 a(half_a), b(half_b);
    const dmat3 axes = glm::mat3_cast(pose_a.orientation);
    const dmat3 r = glm::transpose(axes) * glm::mat3_cast(pose_b.orientation);  // r[j][i]: component along axis i of A of axis j of B
    const dvec3 t = (pose_b.position - pose_a.position) * axes;
    const double size = ((std::abs(t.x) + std::abs(t.y)) + std::abs(t.z)) + (((a.x + a.y) + a.z) + ((b.x + b.y) + b.z));
    if (!(size > 1e-60 && size < 1e60)) return Overlap::Undecided;
    const double error = 0x1p-46 * size;
    const dmat3 s{glm::abs(r[0]), glm::abs(r[1]), glm::abs(r[2])};
    double most = -size;  // the greatest separation, in units of the axis or less
    for (int i = 0; i < 3; ++i) {
        most = std::max(most, std::abs(t[i]) - (a[i] + (s[0][i] * b.x + s[1][i] * b.y + s[2][i] * b.z)));
        most = std::max(most, std::abs(glm::dot(r[i], t)) - (b[i] + glm::dot(s[i], a)));
    }
    if (most > error) return Overlap::Apart;
    bool sure = most < -error;
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const double length = s[j][i1] + s[j][i2];
            if (!(length > 1e-20)) continue;  // parallel: the axis is one of a face, to as much
            const double reach = (a[i1] * s[j][i2] + a[i2] * s[j][i1]) + (b[j1] * std::abs(r[j][i1] * r[j1][i2] - r[j][i2] * r[j1][i1]) +
                                                                         b[j2] * std::abs(r[j][i1] * r[j2][i2] - r[j][i2] * r[j2][i1]));
            const double gap = std::abs(t[i2] * r[j][i1] - t[i1] * r[j][i2]) - reach;
            if (gap > error * length) return Overlap::Apart;
            sure = sure && gap < -error * length;
        }
    }
    return sure ? Overlap::Overlapping : Overlap::Undecided;
}

}  // namespace carom::detail
