#include <carom/dynamics/free_rotation.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace carom {
namespace {

constexpr double kStrangError = 0.08;   // of the energy, times the square of a cycle's angle
constexpr double kFourthError = 2e-4;   // times its fourth power
constexpr double kMostFourth = 0.25;    // [rad]: up to which that holds

// Blanes and Moan's S6: A a[0], B b[0], A a[1], ..., and back.
constexpr std::array<double, 4> kFourthA{0.0792036964311957, 0.353172906049774, -0.0420650803577195,
                                         1.0 - 2.0 * (0.0792036964311957 + 0.353172906049774 - 0.0420650803577195)};
constexpr std::array<double, 3> kFourthB{0.209515106613362, -0.143851773179818, 0.5 - (0.209515106613362 - 0.143851773179818)};

struct Outer {
    int least = 0, most = 2;  // axes of the least and the largest moment
    double least_rate = 0.0, most_rate = 0.0;  // angular velocity about each over L's component
};

Outer outer_of(const FreeRotation& body) noexcept {
    Outer o{(body.axis + 1) % 3, (body.axis + 2) % 3};
    if (body.moments[o.least] > body.moments[o.most]) std::swap(o.least, o.most);
    const double middle = body.inverse_moments[body.axis];
    o.least_rate = body.inverse_moments[o.least] - middle;
    o.most_rate = body.inverse_moments[o.most] - middle;
    return o;
}

/// The fastest that either axis turns in the splitting, over the whole motion: from |L| and the energy, which are kept [rad/s].
double greatest_rate(const dvec3& momentum, const Outer& o) noexcept {
    const double r1 = o.least_rate, r3 = -o.most_rate;
    const double l_sq = glm::dot(momentum, momentum);
    const double excess = r1 * momentum[o.least] * momentum[o.least] - r3 * momentum[o.most] * momentum[o.most];
    const double least_sq = std::max(0.0, excess + r3 * l_sq) / (r1 + r3), most_sq = std::max(0.0, r1 * l_sq - excess) / (r1 + r3);
    return std::max(r1 * std::sqrt(least_sq), r3 * std::sqrt(most_sq));
}

/// The body turns about its own axis `i`; in body axes L turns the other way.
void turn_about_axis(int i, double rate, double dt, dquat& orientation, dvec3& momentum) noexcept {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const SinCos half = sin_cos(0.5 * dt * rate * momentum[i]);
    const double c = 1.0 - 2.0 * half.sin * half.sin, s = 2.0 * half.sin * half.cos;
    const double mj = momentum[j], mk = momentum[k];
    momentum[j] = c * mj + s * mk;
    momentum[k] = c * mk - s * mj;
    dquat about{half.cos, 0.0, 0.0, 0.0};
    about[i] = half.sin;  // GLM stores x, y, z, w
    orientation = orientation * about;
}

constexpr double kMostCycles = 1e6;

struct Cycles {
    int count = 1;
    SpinScheme scheme = SpinScheme::Strang;
};

/// @return what is wrong, or null.
const char* fault_of(const Rotation& rotation, double dt, const SpinSettings& settings) noexcept {
    if (!is_finite(rotation.orientation) || !is_finite(rotation.spin) || !is_finite(dt)) return "free rotation: a state or dt is not finite";
    if (!(settings.tolerance >= 1e-12 && settings.tolerance <= 1.0)) return "free rotation: the tolerance must be within 1e-12 .. 1";
    return nullptr;
}

Cycles plan_cycles(double angle, const SpinSettings& settings) noexcept {
    const double strang = angle / std::sqrt(settings.tolerance / kStrangError);
    const double fourth = angle / std::min(kMostFourth, std::sqrt(std::sqrt(settings.tolerance / kFourthError)));
    const bool fewer = 3.0 * std::floor(strang + 1.0) <= 13.0 * std::floor(fourth + 1.0);  // rotations
    if (settings.scheme == SpinScheme::Strang || (settings.scheme == SpinScheme::Automatic && fewer)) {
        return {1 + static_cast<int>(std::min(strang, kMostCycles)), SpinScheme::Strang};
    }
    return {1 + static_cast<int>(std::min(fourth, kMostCycles)), SpinScheme::FourthOrder};
}

void rotate_asymmetric(dquat& q, dvec3& momentum, const FreeRotation& body, double dt, const SpinSettings& settings) noexcept {
    const Outer o = outer_of(body);
    const Cycles cycles = plan_cycles(greatest_rate(momentum, o) * std::abs(dt), settings);
    const double h = dt / cycles.count;
    const auto least = [&](double share) { turn_about_axis(o.least, o.least_rate, share * h, q, momentum); };
    const auto most = [&](double share) { turn_about_axis(o.most, o.most_rate, share * h, q, momentum); };
    for (int cycle = 0; cycle < cycles.count; ++cycle) {
        if (cycles.scheme == SpinScheme::Strang) {
            least(0.5), most(1.0), least(0.5);
            continue;
        }
        for (std::size_t s = 0; s < 3; ++s) least(kFourthA[s]), most(kFourthB[s]);
        least(kFourthA[3]);
        for (std::size_t s = 3; s-- > 0;) most(kFourthB[s]), least(kFourthA[s]);
    }
}

}  // namespace

FreeRotation classify(const dvec3& moments) {
    const bool fit = is_finite(moments) && moments.x > 0.0 && moments.y > 0.0 && moments.z > 0.0;
    CAROM_REQUIRE(fit, ErrorCode::InvalidArgument, "moments of inertia must be positive and finite", FreeRotation{});
    FreeRotation body{moments, 1.0 / moments};
    const double tolerance = 1e-12 * std::max({moments.x, moments.y, moments.z});
    int equal_pairs = 0;
    for (int i = 0; i < 3; ++i) {
        if (std::abs(moments[(i + 1) % 3] - moments[(i + 2) % 3]) > tolerance) continue;
        ++equal_pairs;
        body.axis = i;
    }
    if (equal_pairs > 0) {
        body.inertia = equal_pairs == 1 ? InertiaClass::Symmetric : InertiaClass::Isotropic;
        return body;
    }
    body.inertia = InertiaClass::Asymmetric;
    for (int i = 0; i < 3; ++i) {
        const double before = moments[(i + 2) % 3] - moments[i], after = moments[(i + 1) % 3] - moments[i];
        if ((before < 0.0) != (after < 0.0)) body.axis = i;
    }
    return body;
}

void rotate_free(Rotation& rotation, const FreeRotation& body, double dt, const SpinSettings& settings) {
    const char* const fault = fault_of(rotation, dt, settings);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault);
    dquat& q = rotation.orientation;
    if (body.inertia == InertiaClass::Isotropic) {
        q = glm::normalize(rotation_from_vector(rotation.spin * dt) * q);
        return;
    }
    // About L at |L| over the middle moment (of a symmetric body: the equal ones), and about the body's own axes for the rest.
    dvec3 momentum = body.moments * rotate_inverse(q, rotation.spin);
    const dvec3 world_momentum = rotate(q, momentum);
    const int common = body.inertia == InertiaClass::Symmetric ? (body.axis + 1) % 3 : body.axis;
    const dquat about_momentum = rotation_from_vector(world_momentum * (body.inverse_moments[common] * dt));
    if (body.inertia == InertiaClass::Symmetric) {
        turn_about_axis(body.axis, body.inverse_moments[body.axis] - body.inverse_moments[common], dt, q, momentum);
    } else {
        rotate_asymmetric(q, momentum, body, dt, settings);
    }
    q = glm::normalize(about_momentum * q);
    rotation.spin = rotate(q, body.inverse_moments * momentum);
}

int count_cycles(const Rotation& rotation, const FreeRotation& body, double dt, const SpinSettings& settings) {
    const char* const fault = fault_of(rotation, dt, settings);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, 0);
    if (body.inertia != InertiaClass::Asymmetric) return 1;
    const dvec3 momentum = body.moments * rotate_inverse(rotation.orientation, rotation.spin);
    return plan_cycles(greatest_rate(momentum, outer_of(body)) * std::abs(dt), settings).count;
}

}  // namespace carom
