#include <carom/core/rotations.hpp>

#include <carom/core/math.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

// The axes of the three turns, and whether they follow each other as x, y, z do.
struct Order {
    int i, j, k;
    double parity;
};

Order axes_of(EulerOrder order) noexcept {
    switch (order) {
        case EulerOrder::XYZ:
            return {0, 1, 2, 1.0};
        case EulerOrder::XZY:
            return {0, 2, 1, -1.0};
        case EulerOrder::YXZ:
            return {1, 0, 2, -1.0};
        case EulerOrder::YZX:
            return {1, 2, 0, 1.0};
        case EulerOrder::ZXY:
            return {2, 0, 1, 1.0};
        case EulerOrder::ZYX:
            break;
    }
    return {2, 1, 0, -1.0};
}

dquat about(int axis, double angle) noexcept {
    dvec3 unit{0.0};
    unit[axis] = 1.0;
    return rotation_about(unit, angle);
}

double length(const dvec3& v) noexcept {
    const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
    if (!(largest > 0.0)) return largest;
    const dvec3 unit = v / largest;  // the squares cannot underflow
    return largest * std::sqrt(glm::dot(unit, unit));
}

}  // namespace

dquat rotation_from_euler(const EulerAngles& angles, EulerOrder order) noexcept {
    const Order o = axes_of(order);
    return about(o.i, angles.first) * about(o.j, angles.second) * about(o.k, angles.third);
}

EulerAngles euler_angles(const dquat& q, EulerOrder order) noexcept {
    const Order o = axes_of(order);
    const int i = o.i, j = o.j, k = o.k;
    const double parity = o.parity;
    const dmat3 columns = rotation_matrix(q);
    const auto r = [&](int row, int column) { return columns[column][row]; };
    // Row i of Ri(a) Rj(b) Rk(c) is (cos b cos c, -e cos b sin c, e sin b), column k is (e sin b, -e sin a cos b, cos a cos b).
    const double sine = parity * r(i, k), cosine = std::sqrt(r(j, k) * r(j, k) + r(k, k) * r(k, k));
    EulerAngles angles;
    angles.second = arctan2(sine, cosine);
    if (!(cosine <= 0x1p-50)) angles.first = arctan2(-parity * r(j, k), r(k, k));
    // With the first turn undone, row j is (e sin c, cos c, 0), of unit length whatever b is: so the third angle completes the first one
    // to the right rotation, even where that one is noise.
    const SinCos first = sin_cos(angles.first);
    const auto undone = [&](int column) { return first.cos * r(j, column) + parity * first.sin * r(k, column); };
    angles.third = arctan2(parity * undone(i), undone(j));
    return angles;
}

AxisAngle axis_angle(const dquat& q) noexcept {
    const dvec3 v = std::signbit(q.w) ? dvec3{-q.x, -q.y, -q.z} : dvec3{q.x, q.y, q.z};
    const double sine = length(v);
    if (sine == 0.0) return {};
    return {v / sine, 2.0 * arctan2(sine, std::fabs(q.w))};
}

dvec3 rotation_vector(const dquat& q) noexcept {
    const AxisAngle turn = axis_angle(q);
    return turn.angle * turn.axis;
}

dmat3 rotation_matrix(const dquat& q) noexcept {
    const double w = q.w, x = q.x, y = q.y, z = q.z;
    return {dvec3{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)},
            dvec3{2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)},
            dvec3{2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)}};
}

dquat rotation_from_matrix(const dmat3& m) noexcept {
    const double xx = m[0][0], yy = m[1][1], zz = m[2][2];
    // Four times the square of each component.
    const double w = 1.0 + xx + yy + zz, x = 1.0 + xx - yy - zz, y = 1.0 - xx + yy - zz, z = 1.0 - xx - yy + zz;
    dquat q{};
    if (w >= x && w >= y && w >= z) {
        q = dquat{w, m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]};
    } else if (x >= y && x >= z) {
        q = dquat{m[1][2] - m[2][1], x, m[1][0] + m[0][1], m[2][0] + m[0][2]};
    } else if (y >= z) {
        q = dquat{m[2][0] - m[0][2], m[1][0] + m[0][1], y, m[2][1] + m[1][2]};
    } else {
        q = dquat{m[0][1] - m[1][0], m[2][0] + m[0][2], m[2][1] + m[1][2], z};
    }
    const double scale = (q.w < 0.0 ? -1.0 : 1.0) / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
}

}  // namespace carom
