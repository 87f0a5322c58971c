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

using dynamics::LaneTraits;
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

/// Gives the bodies what a pass changed, in the frame of the manifold: what it left alone keeps its bits.
CAROM_PASS_INLINE void write_back(SolverBodies& all, const ContactBundle& c, int lane, const Basis& basis, const Masses& masses,
                                  const Floats3& impulse, const Floats3& turn_a, const Floats3& turn_b) {
    const Floats3 p = from_frame(basis, impulse);
    add_motion(all, c.row_a.data() + lane, {-masses.inverse_a * p, from_frame(basis, turn_a)});
    add_motion(all, c.row_b.data() + lane, {masses.inverse_b * p, from_frame(basis, turn_b)});
}

/// Where a body of each lane went since the start of the step, as far as it shows along the normal.
struct Displacement {
    Floats shift;     ///< of the centre of mass
    Floats3 turned;   ///< the normal as the turned body sees it, less the normal: times a lever arm, what the turn moves that point by
};

CAROM_PASS_INLINE Displacement read_displacement(const SolverBodies& all, const std::int32_t* rows, Floats turns, const Basis& basis) {
    const float* body = reinterpret_cast<const float*>(all.bodies.data());
    const TwoRows r = gather_two_rows(body, rows, kBodyStride, 8);
    const Floats3 q = to_frame(basis, Floats3{r.e, r.f, r.g});
    const Floats w = r.h;
    const Floats two = broadcast(2.0f) * turns;
    return {dot(Floats3{r.a, r.b, r.c}, basis.n), two * Floats3{-(q.y * q.y + q.z * q.z), q.x * q.y - w * q.z, q.x * q.z + w * q.y}};
}

HWY_INLINE Displacement no_displacement() {
    const Floats zero = broadcast(0.0f);
    return {zero, {zero, zero, zero}};
}

/// How far two balls part by moving sideways, off the plane that they touched in at first: |d + s| - |d| = s·n + |s - (s·n) n|² / (2 |d|) to second order.
CAROM_PASS_INLINE Floats parting(const SolverBodies& all, const std::int32_t* rows_a, const std::int32_t* rows_b, Floats curvature, const Basis& basis) {
    const float* body = reinterpret_cast<const float*>(all.bodies.data());
    const TwoRows a = gather_two_rows(body, rows_a, kBodyStride, 8), b = gather_two_rows(body, rows_b, kBodyStride, 8);
    const Floats3 way = to_frame(basis, Floats3{b.a, b.b, b.c} - Floats3{a.a, a.b, a.c});
    return curvature * (way.y * way.y + way.z * way.z);
}

void warm_start_bundle(const ContactBundle& c, SolverBodies& all, int lane) {
    const Basis basis = make_basis(c, lane);
    const Masses masses = read_masses(c, lane);
    const Floats zero = broadcast(0.0f);
    Floats3 impulse{zero, zero, zero}, torque_a = impulse, torque_b = impulse;
    for (int k = 0; k < c.point_count; ++k) {
        const PointLanes& p = c.points[static_cast<std::size_t>(k)];
        const Floats3 of_point{get(p.normal_impulse, lane), get(p.tangent_impulse_1, lane), get(p.tangent_impulse_2, lane)};
        impulse = impulse + of_point;
        torque_a = torque_a - cross(get3(p.a, lane), of_point);
        torque_b = torque_b + cross(get3(p.b, lane), of_point);
    }
    write_back(all, c, lane, basis, masses, impulse, masses.a * torque_a, masses.b * torque_b);
}

struct SoftLanes {
    Floats bias_rate, mass_scale, impulse_scale, push_limit;
};

/// A bundle in the middle of a pass.
struct Begun {
    Basis basis;
    Displacement da, db;
    Masses masses;
    Relative before, now;
    Floats friction;
    Floats to_speed;  ///< about 1 / tangent mass: impulses are compared as speeds, whose squares fit into floats at any mass
    SoftLanes soft;
};

template <bool kGapsKnown>
CAROM_PASS_INLINE Begun begin(const ContactBundle& c, const SolverBodies& all, const dynamics::SoftContacts& soft, int lane) {
    const std::int32_t* rows_a = c.row_a.data() + lane;
    const std::int32_t* rows_b = c.row_b.data() + lane;
    const Motion a = read_motion(all, rows_a), b = read_motion(all, rows_b);
    const Basis basis = make_basis(c, lane);
    const Displacement da = kGapsKnown ? no_displacement() : read_displacement(all, rows_a, by_trait(c, lane, LaneTraits::kBallA, 0.0f, 1.0f), basis);
    Displacement db = kGapsKnown ? no_displacement() : read_displacement(all, rows_b, by_trait(c, lane, LaneTraits::kBallB, 0.0f, 1.0f), basis);
    if constexpr (!kGapsKnown) {
        const Floats curvature = get(c.curvature, lane);
        if (any(curvature > broadcast(0.0f))) db.shift = db.shift + parting(all, rows_a, rows_b, curvature, basis);
    }
    const Relative motion = relative_motion(basis, a, b);
    const Floats first_mass = get(c.points[0].tangent_mass, lane);
    const Mask used = first_mass > broadcast(0.0f);
    const Floats to_speed = select(used, broadcast(1.0f) / select(used, first_mass, broadcast(1.0f)), broadcast(0.0f));
    return {basis, da, db, read_masses(c, lane), motion, motion, get(c.friction, lane), to_speed,
            {bias_rates(c, lane, soft), by_trait(c, lane, LaneTraits::kFixed, soft.fixed.mass_scale, soft.moving.mass_scale),
             by_trait(c, lane, LaneTraits::kFixed, soft.fixed.impulse_scale, soft.moving.impulse_scale), get(c.push_limit, lane)}};
}

/// Coulomb friction in the tangent plane: one scalar step in both directions, then back radially into the circle.
CAROM_PASS_INLINE void solve_friction(PointLanes& p, int lane, Begun& s) {
    const Masses& masses = s.masses;
    Relative& m = s.now;
    const Floats3 ra = get3(p.a, lane), rb = get3(p.b, lane);
    const Floats v1 = m.velocity.y + ((m.spin_b.z * rb.x - m.spin_b.x * rb.z) - (m.spin_a.z * ra.x - m.spin_a.x * ra.z));
    const Floats v2 = m.velocity.z + ((m.spin_b.x * rb.y - m.spin_b.y * rb.x) - (m.spin_a.x * ra.y - m.spin_a.y * ra.x));
    const Floats mass = get(p.tangent_mass, lane);
    const Floats old1 = get(p.tangent_impulse_1, lane);
    const Floats old2 = get(p.tangent_impulse_2, lane);
    const Floats new1 = old1 - mass * v1;
    const Floats new2 = old2 - mass * v2;
    const Floats limit = s.friction * (get(p.normal_impulse, lane) * s.to_speed);
    const Floats speed1 = new1 * s.to_speed;
    const Floats speed2 = new2 * s.to_speed;
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

template <bool kBias>
CAROM_PASS_INLINE void solve_normal(PointLanes& p, int lane, const SolveSettings& settings, Begun& s) {
    const SoftLanes& soft = s.soft;
    const Masses& masses = s.masses;
    Relative& m = s.now;
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

template <bool kBias, bool kGapsKnown>
CAROM_PASS_INLINE void solve_contact(PointLanes& p, int lane, const SolveSettings& settings, Begun& s) {
    if constexpr (!kGapsKnown) {
        const Floats turned = dot(s.db.turned, get3(p.b, lane)) - dot(s.da.turned, get3(p.a, lane));
        put(p.gap, lane, get(p.separation, lane) + ((s.db.shift - s.da.shift) + turned));
    }
    solve_normal<kBias>(p, lane, settings, s);
}

CAROM_PASS_INLINE void finish(SolverBodies& all, const ContactBundle& c, int lane, const Begun& s) {
    write_back(all, c, lane, s.basis, s.masses, s.now.impulse, s.now.spin_a - s.before.spin_a, s.now.spin_b - s.before.spin_b);
}

/// @tparam kGapsKnown  see SolveSettings.
template <bool kBias, bool kGapsKnown>
void solve_bundle(ContactBundle& c, SolverBodies& all, const SolveSettings& settings, int lane) {
    Begun s = begin<kGapsKnown>(c, all, settings.soft, lane);
    for (int k = 0; k < c.point_count; ++k) solve_friction(c.points[static_cast<std::size_t>(k)], lane, s);
    for (int k = 0; k < c.point_count; ++k) solve_contact<kBias, kGapsKnown>(c.points[static_cast<std::size_t>(k)], lane, settings, s);
    finish(all, c, lane, s);
}

/// The same of two bundles, of which the second has at most the points of the first. A point waits for the one before it: two bundles, which
/// share no body, fill each other's waits.
template <bool kBias, bool kGapsKnown>
void solve_two(ContactBundle& c, ContactBundle& d, SolverBodies& all, const SolveSettings& settings, int lane) {
    Begun s = begin<kGapsKnown>(c, all, settings.soft, lane);
    Begun t = begin<kGapsKnown>(d, all, settings.soft, lane);
    for (int k = 0; k < c.point_count; ++k) {
        solve_friction(c.points[static_cast<std::size_t>(k)], lane, s);
        if (k < d.point_count) solve_friction(d.points[static_cast<std::size_t>(k)], lane, t);
    }
    for (int k = 0; k < c.point_count; ++k) {
        solve_contact<kBias, kGapsKnown>(c.points[static_cast<std::size_t>(k)], lane, settings, s);
        if (k < d.point_count) solve_contact<kBias, kGapsKnown>(d.points[static_cast<std::size_t>(k)], lane, settings, t);
    }
    finish(all, c, lane, s);
    finish(all, d, lane, t);
}

void WarmStart(std::span<ContactBundle> bundles, SolverBodies& bodies) {
    for (ContactBundle& c : bundles) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) warm_start_bundle(c, bodies, lane);
    }
}

template <bool kBias, bool kGapsKnown>
void solve_all(std::span<ContactBundle> bundles, SolverBodies& bodies, const SolveSettings& settings) {
    std::size_t i = 0;
    for (; i + 1 < bundles.size(); i += 2) {
        const bool more = bundles[i].point_count >= bundles[i + 1].point_count;  // than its neighbour, which may have as many
        ContactBundle &first = bundles[more ? i : i + 1], &second = bundles[more ? i + 1 : i];
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) solve_two<kBias, kGapsKnown>(first, second, bodies, settings, lane);
    }
    for (; i < bundles.size(); ++i) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) solve_bundle<kBias, kGapsKnown>(bundles[i], bodies, settings, lane);
    }
}

void Solve(std::span<ContactBundle> bundles, SolverBodies& bodies, const SolveSettings& settings) {
    if (settings.bias) {
        settings.gaps_known ? solve_all<true, true>(bundles, bodies, settings) : solve_all<true, false>(bundles, bodies, settings);
    } else {
        settings.gaps_known ? solve_all<false, true>(bundles, bodies, settings) : solve_all<false, false>(bundles, bodies, settings);
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
