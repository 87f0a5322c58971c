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

Floats3 lever_a(const PointLanes& p, int lane) { return {get(p.ax, lane), get(p.ay, lane), get(p.az, lane)}; }
Floats3 lever_b(const PointLanes& p, int lane) { return {get(p.bx, lane), get(p.by, lane), get(p.bz, lane)}; }

/// Where the bodies of each lane went since the start of the step.
struct Displacement {
    Floats3 shift;
    Floats3 turn;
    Floats turn_w;

    Floats3 at(const Floats3& r) const {
        const Floats two = broadcast(2.0f);
        const Floats3 t = two * cross(turn, r);
        return shift + r + turn_w * t + cross(turn, t);
    }
};

CAROM_PASS_INLINE Displacement read_displacement(const SolverBodies& all, const std::int32_t* rows, Floats turns) {
    const float* body = reinterpret_cast<const float*>(all.bodies.data());
    Floats sx, sy, sz, tx, ty, tz, tw, unused;
    gather_rows(body, rows, kBodyStride, 8, sx, sy, sz, unused);
    gather_rows(body, rows, kBodyStride, 12, tx, ty, tz, tw);
    return {{sx, sy, sz}, {turns * tx, turns * ty, turns * tz}, tw};
}

HWY_INLINE Displacement no_displacement() {
    const Floats zero = broadcast(0.0f);
    return {{zero, zero, zero}, {zero, zero, zero}, zero};
}

void warm_start_bundle(ContactBundle& c, SolverBodies& all, int lane) {
    Bodies a = read_bodies(all, c.row_a.data() + lane);
    Bodies b = read_bodies(all, c.row_b.data() + lane);
    const Basis basis = make_basis(c, lane);
    for (int k = 0; k < c.point_count; ++k) {
        const PointLanes& p = c.points[static_cast<std::size_t>(k)];
        const Floats3 impulse = get(p.normal_impulse, lane) * basis.n + get(p.tangent_impulse_1, lane) * basis.t1 +
                                get(p.tangent_impulse_2, lane) * basis.t2;
        a.pull(impulse, lever_a(p, lane));
        b.push(impulse, lever_b(p, lane));
    }
    write_bodies(all, c.row_a.data() + lane, a);
    write_bodies(all, c.row_b.data() + lane, b);
}

/// Coulomb friction in the tangent plane: one scalar step in both directions, then back radially into the circle.
/// @param to_speed  about 1 / tangent mass: lengths are compared as speeds, whose squares fit into floats at any mass.
CAROM_PASS_INLINE void solve_friction(PointLanes& p, int lane, Floats friction, Floats to_speed, const Basis& basis, Bodies& a,
                               Bodies& b) {
    const Floats3 ra = lever_a(p, lane);
    const Floats3 rb = lever_b(p, lane);
    const Floats3 dv = b.velocity_at(rb) - a.velocity_at(ra);
    const Floats mass = get(p.tangent_mass, lane);
    const Floats old1 = get(p.tangent_impulse_1, lane);
    const Floats old2 = get(p.tangent_impulse_2, lane);
    const Floats new1 = old1 - mass * dot(dv, basis.t1);
    const Floats new2 = old2 - mass * dot(dv, basis.t2);
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
    const Floats3 impulse = (clamped1 - old1) * basis.t1 + (clamped2 - old2) * basis.t2;
    a.pull(impulse, ra);
    b.push(impulse, rb);
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
                  const Basis& basis, Bodies& a, Bodies& b) {
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
    const Floats3 ra = lever_a(p, lane);
    const Floats3 rb = lever_b(p, lane);
    const Floats vn = dot(b.velocity_at(rb) - a.velocity_at(ra), basis.n);
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
    const Floats3 impulse = (accumulated - old) * basis.n;
    a.pull(impulse, ra);
    b.push(impulse, rb);
}

/// @tparam kGapsKnown  see SolveSettings.
template <bool kBias, bool kGapsKnown>
void solve_bundle(ContactBundle& c, SolverBodies& all, const SolveSettings& settings, int lane) {
    const std::int32_t* rows_a = c.row_a.data() + lane;
    const std::int32_t* rows_b = c.row_b.data() + lane;
    Bodies a = read_bodies(all, rows_a);
    Bodies b = read_bodies(all, rows_b);
    const Displacement da = kGapsKnown ? no_displacement() : read_displacement(all, rows_a, get(c.turns_a, lane));
    const Displacement db = kGapsKnown ? no_displacement() : read_displacement(all, rows_b, get(c.turns_b, lane));
    const Basis basis = make_basis(c, lane);
    const Floats friction = get(c.friction, lane);
    const SoftLanes soft{get(c.bias_rate, lane), get(c.mass_scale, lane), get(c.impulse_scale, lane),
                         get(c.push_limit, lane)};
    const Floats first_mass = get(c.points[0].tangent_mass, lane);
    const Mask used = first_mass > broadcast(0.0f);
    const Floats to_speed = select(used, broadcast(1.0f) / select(used, first_mass, broadcast(1.0f)), broadcast(0.0f));
    for (int k = 0; k < c.point_count; ++k) {
        solve_friction(c.points[static_cast<std::size_t>(k)], lane, friction, to_speed, basis, a, b);
    }
    for (int k = 0; k < c.point_count; ++k) {
        PointLanes& p = c.points[static_cast<std::size_t>(k)];
        if constexpr (!kGapsKnown) put(p.gap, lane, dot(db.at(lever_b(p, lane)) - da.at(lever_a(p, lane)), basis.n) + get(p.separation, lane));
        solve_normal<kBias>(p, lane, soft, settings, basis, a, b);
    }
    write_bodies(all, rows_a, a);
    write_bodies(all, rows_b, b);
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
