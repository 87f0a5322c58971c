#include <carom/studies/oracle/free_body.hpp>

#include <carom/core/check.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace carom::oracle {
namespace {

using Real = long double;
using Vector3 = std::array<Real, 3>;
using Quaternion = std::array<Real, 4>;  // w, x, y, z

constexpr std::size_t kOrder = 32;
constexpr Real kMostAngle = 0.25L;  // of a step [rad]

struct Turning {
    Quaternion orientation;
    Vector3 spin;  // body axes
};

Quaternion product(const Quaternion& a, const Quaternion& b) {
    return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Vector3 turned(const Quaternion& q, const Vector3& v) {
    const Quaternion r = product(product(q, {0.0L, v[0], v[1], v[2]}), {q[0], -q[1], -q[2], -q[3]});
    return {r[1], r[2], r[3]};
}

Turning advanced(const Turning& from, const Vector3& moments, Real h) {
    std::array<Vector3, kOrder + 1> spin{};
    std::array<Quaternion, kOrder + 1> orientation{};
    spin[0] = from.spin;
    orientation[0] = from.orientation;
    for (std::size_t n = 0; n < kOrder; ++n) {
        const Real share = 1.0L / static_cast<Real>(n + 1);
        for (std::size_t k = 0; k <= n; ++k) {
            const Vector3 &a = spin[k], &b = spin[n - k];
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t j = (i + 1) % 3, l = (i + 2) % 3;
                spin[n + 1][i] += share * (moments[j] - moments[l]) / moments[i] * a[j] * b[l];
            }
            const Quaternion part = product(orientation[k], {0.0L, b[0], b[1], b[2]});
            for (std::size_t i = 0; i < 4; ++i) orientation[n + 1][i] += 0.5L * share * part[i];
        }
    }
    Turning to{orientation[kOrder], spin[kOrder]};
    for (std::size_t n = kOrder; n-- > 0;) {
        for (std::size_t i = 0; i < 3; ++i) to.spin[i] = to.spin[i] * h + spin[n][i];
        for (std::size_t i = 0; i < 4; ++i) to.orientation[i] = to.orientation[i] * h + orientation[n][i];
    }
    return to;
}

Real length(const Vector3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

Vector3 widened(const dvec3& v) { return {v.x, v.y, v.z}; }
dvec3 rounded(const Vector3& v) { return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])}; }

FreeBodyState state_at(const FreeBody& body, const Turning& turning, Real t) {
    const Quaternion& q = turning.orientation;
    FreeBodyState out;
    for (int i = 0; i < 3; ++i) {
        const Real x = body.start.position[i], v = body.start.velocity[i], a = body.acceleration[i];
        out.position[i] = static_cast<double>(x + v * t + 0.5L * a * t * t);
        out.velocity[i] = static_cast<double>(v + a * t);
    }
    out.orientation = {static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2]), static_cast<double>(q[3])};
    out.spin = rounded(turned(q, turning.spin));
    return out;
}

bool is_sound(const FreeBody& body, std::span<const double> times) {
    const FreeBodyState& s = body.start;
    const bool finite = is_finite(s.position) && is_finite(s.orientation) && is_finite(s.velocity) && is_finite(s.spin) &&
                        is_finite(body.acceleration) && is_finite(body.moments);
    const bool positive = body.moments.x > 0.0 && body.moments.y > 0.0 && body.moments.z > 0.0;
    const bool forward = std::ranges::all_of(times, [](double t) { return is_finite(t) && t >= 0.0; }) && std::ranges::is_sorted(times);
    return finite && positive && forward;
}

}  // namespace

std::vector<FreeBodyState> free_motion(const FreeBody& body, std::span<const double> times) {
    CAROM_REQUIRE(is_sound(body, times), ErrorCode::InvalidArgument, "free_motion: moments must be positive, times must rise, all be finite", {});
    const Vector3 moments = widened(body.moments);
    const dquat& q = body.start.orientation;
    Turning turning{{q.w, q.x, q.y, q.z}, {}};
    turning.spin = turned({q.w, -q.x, -q.y, -q.z}, widened(body.start.spin));
    std::vector<FreeBodyState> out;
    Real now = 0.0L;
    for (const double time : times) {
        while (now < static_cast<Real>(time)) {
            const Real left = static_cast<Real>(time) - now, angle = length(turning.spin) * left;
            const Real steps = std::max(1.0L, std::ceil(angle / kMostAngle)), h = left / steps;
            turning = advanced(turning, moments, h);
            now = steps == 1.0L ? static_cast<Real>(time) : now + h;
        }
        out.push_back(state_at(body, turning, now));
    }
    return out;
}

}  // namespace carom::oracle
