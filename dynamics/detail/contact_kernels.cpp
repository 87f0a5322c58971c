#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/dynamics/detail/contact_kernels.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/math.hpp>
#include <carom/dynamics/detail/contact_kernels.hpp>
#include <carom/dynamics/detail/contact_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using dynamics::SolveSettings;

/// How the two bodies of each lane move against each other, in the frame of the manifold: what a pass carries from point to point.
struct Relative {
    Floats3 velocity;          ///< of B's centre of mass less A's [m/s]
    Floats3 spin_a, spin_b;    ///< [rad/s]
    Floats3 impulse;           ///< on B, and against A, so far [N s]
};

CAROM_PASS_INLINE Relative relative_motion(const Basis& basis, const Motion& a, const Motion& b) {
    const Floats zero = broadcast(0.0f);
    return {to_frame(basis, b.v - a.v), to_frame(basis, a.w), to_frame(basis, b.w), {zero, zero, zero}};
}

/// Both bodies' masses.
struct Masses {
    Symmetric a, b;
    Floats inverse_a, inverse_b;
};

CAROM_PASS_INLINE Masses read_masses(const ContactBundle& c, int lane) {
    return {read_inertia(c.a, lane), read_inertia(c.b, lane), get(c.a.inverse_mass, lane), get(c.b.inverse_mass, lane)};
}

/// What the pass changed goes to the bodies: what it left alone keeps its bits.
CAROM_PASS_INLINE void write_back(SolverBodies& all, const ContactBundle& c, int lane, const Basis& basis, const Masses& masses,
                                  const Relative& before, const Relative& after, Motion& a, Motion& b) {
    const Floats3 impulse = from_frame(basis, after.impulse);
    a.v = a.v - masses.inverse_a * impulse;
    b.v = b.v + masses.inverse_b * impulse;
    a.w = a.w + from_frame(basis, after.spin_a - before.spin_a);
    b.w = b.w + from_frame(basis, after.spin_b - before.spin_b);
    write_motion(all, c.row_a.data() + lane, a);
    write_motion(all, c.row_b.data() + lane, b);
}

/// Where a body of each lane went since the start of the step, as far as it shows along the normal.
struct Displacement {
    Floats shift;     ///< of the centre of mass
    Floats3 turned;   ///< the normal as the turned body sees it, less the normal: times a lever arm, what the turn moves that point by
};

CAROM_PASS_INLINE Displacement read_displacement(const SolverBodies& all, const std::int32_t* rows, Floats turns, const Basis& basis) {
    const float* body = reinterpret_cast<const float*>(all.bodies.data());
    Floats sx, sy, sz, tx, ty, tz, w, unused;
    gather_rows(body, rows, kBodyStride, 8, sx, sy, sz, unused);
    gather_rows(body, rows, kBodyStride, 12, tx, ty, tz, w);
    const Floats3 q = to_frame(basis, Floats3{tx, ty, tz});
    const Floats two = broadcast(2.0f) * turns;
    return {dot(Floats3{sx, sy, sz}, basis.n), two * Floats3{-(q.y * q.y + q.z * q.z), q.x * q.y - w * q.z, q.x * q.z + w * q.y}};
}

HWY_INLINE Displacement no_displacement() {
    const Floats zero = broadcast(0.0f);
    return {zero, {zero, zero, zero}};
}

void warm_start_bundle(ContactBundle& c, SolverBodies& all, int lane) {
    Motion a = read_motion(all, c.row_a.data() + lane);
    Motion b = read_motion(all, c.row_b.data() + lane);
    const Basis basis = make_basis(c, lane);
    const Masses masses = read_masses(c, lane);
    const Relative before = relative_motion(basis, a, b);
    const Floats zero = broadcast(0.0f);
    Floats3 impulse{zero, zero, zero}, torque_a = impulse, torque_b = impulse;
    for (int k = 0; k < c.point_count; ++k) {
        const PointLanes& p = c.points[static_cast<std::size_t>(k)];
        const Floats3 of_point{get(p.normal_impulse, lane), get(p.tangent_impulse_1, lane), get(p.tangent_impulse_2, lane)};
        impulse = impulse + of_point;
        torque_a = torque_a + cross(get3(p.a, lane), of_point);
        torque_b = torque_b + cross(get3(p.b, lane), of_point);
    }
    const Relative after{before.velocity, before.spin_a - masses.a * torque_a, before.spin_b + masses.b * torque_b, impulse};
    write_back(all, c, lane, basis, masses, before, after, a, b);
}

/// Coulomb friction in the tangent plane: one scalar step in both directions, then back radially into the circle.
/// @param to_speed  about 1 / tangent mass: lengths are compared as speeds, whose squares fit into floats at any mass.
CAROM_PASS_INLINE void solve_friction(PointLanes& p, int lane, Floats friction, Floats to_speed, const Masses& masses, Relative& m) {
    const Floats3 ra = get3(p.a, lane), rb = get3(p.b, lane);
    const Floats v1 = m.velocity.y + ((m.spin_b.z * rb.x - m.spin_b.x * rb.z) - (m.spin_a.z * ra.x - m.spin_a.x * ra.z));
    const Floats v2 = m.velocity.z + ((m.spin_b.x * rb.y - m.spin_b.y * rb.x) - (m.spin_a.x * ra.y - m.spin_a.y * ra.x));
    const Floats mass = get(p.tangent_mass, lane);
    const Floats old1 = get(p.tangent_impulse_1, lane);
    const Floats old2 = get(p.tangent_impulse_2, lane);
    const Floats new1 = old1 - mass * v1;
    const Floats new2 = old2 - mass * v2;
    const Floats limit = friction * (get(p.normal_impulse, lane) * to_speed);
    const Floats speed1 = new1 * to_speed;
    const Floats speed2 = new2 * to_speed;
    const Floats length_sq = speed1 * speed1 + speed2 * speed2;
    const Floats one = broadcast(1.0f);
    const Mask slips = length_sq > limit * limit;
    Floats clamped1 = new1, clamped2 = new2;
    if (any(slips)) {  // seldom at rest: the root and the quotient take as long as all the rest, and what follows waits for them
        const Floats scale = select(slips, limit / sqrt(select(slips, length_sq, one)), one);
        clamped1 = scale * new1;
        clamped2 = scale * new2;
    }
    put(p.tangent_impulse_1, lane, clamped1);
    put(p.tangent_impulse_2, lane, clamped2);
    const Floats p1 = clamped1 - old1, p2 = clamped2 - old2;
    const Floats inverse_mass = masses.inverse_a + masses.inverse_b;
    m.velocity.y = m.velocity.y + inverse_mass * p1;
    m.velocity.z = m.velocity.z + inverse_mass * p2;
    m.impulse.y = m.impulse.y + p1;
    m.impulse.z = m.impulse.z + p2;
    m.spin_a = m.spin_a - (p1 * along_t1(masses.a, ra) + p2 * along_t2(masses.a, ra));
    m.spin_b = m.spin_b + (p1 * along_t1(masses.b, rb) + p2 * along_t2(masses.b, rb));
}

/// A pair at its push limit is parted at least at this share of the limit ...
constexpr float kJamShare = 0.004f;
/// ... until the impulse of a substep is this many times what would give the pair the speed of its limit. At the default softness the push
/// leaks as much as it adds at 3.7 times; stiffer or more damped settings push harder by themselves, and are left alone above this.
constexpr float kJamMost = 8.0f;

struct SoftLanes {
    Floats bias_rate, mass_scale, impulse_scale, push_limit;
};

template <bool kBias>
CAROM_PASS_INLINE void solve_normal(PointLanes& p, int lane, const SoftLanes& soft, const SolveSettings& settings,
                                    const Masses& masses, Relative& m) {
    const Floats separation = get(p.gap, lane);
    const Floats zero = broadcast(0.0f);
    const Floats one = broadcast(1.0f);
    const Mask apart = separation > zero;
    Floats bias = select(apart, separation * broadcast(settings.inverse_h), zero);
    Floats mass_scale = one;
    Floats impulse_scale = zero;
    if constexpr (kBias) {
        const Floats push = max(soft.bias_rate * separation, -soft.push_limit);
        bias = select(apart, bias, push);
        mass_scale = select(apart, one, soft.mass_scale);
        impulse_scale = select(apart, zero, soft.impulse_scale);
    }
    const Floats3 ra = get3(p.a, lane), rb = get3(p.b, lane);
    const Floats vn = m.velocity.x + ((m.spin_b.y * rb.z - m.spin_b.z * rb.y) - (m.spin_a.y * ra.z - m.spin_a.z * ra.y));
    const Floats old = get(p.normal_impulse, lane);
    const Floats mass = get(p.normal_mass, lane);
    Floats change = -(mass * mass_scale * (vn + bias)) - impulse_scale * old;
    if constexpr (kBias) {
        // What leaks away bounds a push at its limit. Where others jam the pair, it has to grow until they give way, if slowly; and not for
        // ever, for they may be unable to.
        const Mask at_limit = soft.bias_rate * separation < -soft.push_limit;
        if (any(at_limit)) {
            const Floats push = mass * soft.push_limit;
            const Floats growing = min(mass * (broadcast(kJamShare) * soft.push_limit - vn), max(broadcast(kJamMost) * push - old, zero));
            change = select(at_limit, max(change, growing), change);
        }
    }
    const Floats accumulated = max(old + change, zero);
    put(p.normal_impulse, lane, accumulated);
    const Floats impulse = accumulated - old;
    m.velocity.x = m.velocity.x + (masses.inverse_a + masses.inverse_b) * impulse;
    m.impulse.x = m.impulse.x + impulse;
    m.spin_a = m.spin_a - impulse * along_n(masses.a, ra);
    m.spin_b = m.spin_b + impulse * along_n(masses.b, rb);
}

/// @tparam kGapsKnown  see SolveSettings.
template <bool kBias, bool kGapsKnown>
void solve_bundle(ContactBundle& c, SolverBodies& all, const SolveSettings& settings, int lane) {
    const std::int32_t* rows_a = c.row_a.data() + lane;
    const std::int32_t* rows_b = c.row_b.data() + lane;
    Motion a = read_motion(all, rows_a);
    Motion b = read_motion(all, rows_b);
    const Basis basis = make_basis(c, lane);
    const Displacement da = kGapsKnown ? no_displacement() : read_displacement(all, rows_a, get(c.turns_a, lane), basis);
    const Displacement db = kGapsKnown ? no_displacement() : read_displacement(all, rows_b, get(c.turns_b, lane), basis);
    const Masses masses = read_masses(c, lane);
    const Relative before = relative_motion(basis, a, b);
    Relative now = before;
    const Floats friction = get(c.friction, lane);
    const SoftLanes soft{get(c.bias_rate, lane), get(c.mass_scale, lane), get(c.impulse_scale, lane),
                         get(c.push_limit, lane)};
    const Floats first_mass = get(c.points[0].tangent_mass, lane);
    const Mask used = first_mass > broadcast(0.0f);
    const Floats to_speed = select(used, broadcast(1.0f) / select(used, first_mass, broadcast(1.0f)), broadcast(0.0f));
    for (int k = 0; k < c.point_count; ++k) {
        solve_friction(c.points[static_cast<std::size_t>(k)], lane, friction, to_speed, masses, now);
    }
    for (int k = 0; k < c.point_count; ++k) {
        PointLanes& p = c.points[static_cast<std::size_t>(k)];
        if constexpr (!kGapsKnown) {
            const Floats turned = dot(db.turned, get3(p.b, lane)) - dot(da.turned, get3(p.a, lane));
            put(p.gap, lane, get(p.separation, lane) + ((db.shift - da.shift) + turned));
        }
        solve_normal<kBias>(p, lane, soft, settings, masses, now);
    }
    write_back(all, c, lane, basis, masses, before, now, a, b);
}

void WarmStart(std::span<ContactBundle> bundles, SolverBodies& bodies) {
    for (ContactBundle& c : bundles) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) warm_start_bundle(c, bodies, lane);
    }
}

void Solve(std::span<ContactBundle> bundles, SolverBodies& bodies, const SolveSettings& settings) {
    for (ContactBundle& c : bundles) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            if (settings.bias) {
                settings.gaps_known ? solve_bundle<true, true>(c, bodies, settings, lane) : solve_bundle<true, false>(c, bodies, settings, lane);
            } else {
                settings.gaps_known ? solve_bundle<false, true>(c, bodies, settings, lane) : solve_bundle<false, false>(c, bodies, settings, lane);
            }
        }
    }
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
HWY_EXPORT(WarmStart);
HWY_EXPORT(Solve);

namespace dynamics {

SoftContact soft_contact(double frequency, double damping, double h) noexcept {
    const double w = 2.0 * kPi * frequency;
    const double a1 = 2.0 * damping + h * w;
    const double a2 = h * w * a1;
    const double a3 = 1.0 / (1.0 + a2);
    return {static_cast<float>(w / a1), static_cast<float>(a2 * a3), static_cast<float>(a3)};
}

void warm_start(std::span<ContactBundle> bundles, SolverBodies& bodies) {
    HWY_DYNAMIC_DISPATCH(WarmStart)(bundles, bodies);
}

void solve(std::span<ContactBundle> bundles, SolverBodies& bodies, const SolveSettings& settings) {
    HWY_DYNAMIC_DISPATCH(Solve)(bundles, bodies, settings);
}

}  // namespace dynamics
}  // namespace carom
#endif
