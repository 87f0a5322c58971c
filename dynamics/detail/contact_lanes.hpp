// What the contact kernels share: the two bodies of each lane, and the lanes of a bundle. Compiled once for each target.

#if defined(CAROM_DYNAMICS_CONTACT_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_DYNAMICS_CONTACT_LANES_HPP
#undef CAROM_DYNAMICS_CONTACT_LANES_HPP
#else
#define CAROM_DYNAMICS_CONTACT_LANES_HPP
#endif

#include <carom/core/lanes.hpp>
#include <carom/dynamics/detail/contact_bundle.hpp>

// The passes are one piece of code each, so that the lanes stay in registers. With the sanitizers' checks in it, such a piece would keep
// GCC 12 busy for many minutes: there they stay apart.
#ifndef CAROM_PASS_INLINE
#ifdef __SANITIZE_ADDRESS__
#define CAROM_PASS_INLINE inline
#else
#define CAROM_PASS_INLINE HWY_INLINE
#endif
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using dynamics::ContactBundle;
using dynamics::PointLanes;
using dynamics::SolverBodies;

constexpr std::size_t kBodyStride = sizeof(dynamics::SolverBody) / sizeof(float);
constexpr std::size_t kMassStride = sizeof(dynamics::SolverMass) / sizeof(float);

template <class Array>
Floats get(const Array& lanes, int lane) {
    return load(lanes.data() + lane);
}
template <class Array>
void put(Array& lanes, int lane, Floats value) {
    store(value, lanes.data() + lane);
}

/// One body of each lane: its motion and its inverse mass.
struct Bodies {
    Floats3 v, w;
    Floats ixx, iyy, izz, ixy, ixz, iyz, inverse_mass;

    /// Velocity change by the impulse ±p at lever arm r.
    void push(const Floats3& p, const Floats3& r) {
        v = v + inverse_mass * p;
        w = w + turned(cross(r, p));
    }
    void pull(const Floats3& p, const Floats3& r) {
        v = v - inverse_mass * p;
        w = w - turned(cross(r, p));
    }
    Floats3 turned(const Floats3& t) const {
        return {ixx * t.x + ixy * t.y + ixz * t.z, ixy * t.x + iyy * t.y + iyz * t.z, ixz * t.x + iyz * t.y + izz * t.z};
    }
    Floats3 velocity_at(const Floats3& r) const { return v + cross(w, r); }
};

CAROM_PASS_INLINE Bodies read_bodies(const SolverBodies& all, const std::int32_t* rows) {
    const float* body = reinterpret_cast<const float*>(all.bodies.data());
    const float* mass = reinterpret_cast<const float*>(all.masses.data());
    // GCC 12 compiles implicit constructors of aggregates for the baseline target: fill them from locals.
    Floats vx, vy, vz, wx, wy, wz, ixx, iyy, izz, ixy, ixz, iyz, inverse_mass, unused;
    gather_rows(body, rows, kBodyStride, 0, vx, vy, vz, unused);
    gather_rows(body, rows, kBodyStride, 4, wx, wy, wz, unused);
    gather_rows(mass, rows, kMassStride, 0, ixx, iyy, izz, inverse_mass);
    gather_rows(mass, rows, kMassStride, 4, ixy, ixz, iyz, unused);
    return {{vx, vy, vz}, {wx, wy, wz}, ixx, iyy, izz, ixy, ixz, iyz, inverse_mass};
}

CAROM_PASS_INLINE void write_bodies(SolverBodies& all, const std::int32_t* rows, const Bodies& b) {
    float* body = reinterpret_cast<float*>(all.bodies.data());
    const Floats zero = broadcast(0.0f);
    scatter_rows(body, rows, kBodyStride, 0, b.v.x, b.v.y, b.v.z, zero, all.movable);
    scatter_rows(body, rows, kBodyStride, 4, b.w.x, b.w.y, b.w.z, zero, all.movable);
}

struct Basis {
    Floats3 n, t1, t2;
};

/// Tangents of the normal (Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017).
CAROM_PASS_INLINE Basis make_basis(const ContactBundle& c, int lane) {
    const Floats one = broadcast(1.0f);
    const Floats3 n{get(c.nx, lane), get(c.ny, lane), get(c.nz, lane)};
    const Floats sign = select(n.z < broadcast(0.0f), -one, one);
    const Floats a = -one / (sign + n.z);
    const Floats b = n.x * n.y * a;
    return {n, {one + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
