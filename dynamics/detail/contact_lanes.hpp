// What the contact kernels share: the lanes of a bundle, the frame of its manifolds, and their bodies. Compiled once for each target.

#if defined(CAROM_DYNAMICS_CONTACT_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_DYNAMICS_CONTACT_LANES_HPP
#undef CAROM_DYNAMICS_CONTACT_LANES_HPP
#else
#define CAROM_DYNAMICS_CONTACT_LANES_HPP
#endif

#include <carom/core/lanes.hpp>
#include <carom/dynamics/detail/body_rows.hpp>
#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/contact_kernels.hpp>

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

template <class Array>
Floats get(const Array& lanes, int lane) {
    return load(lanes.data() + lane);
}
template <class Array>
void put(Array& lanes, int lane, Floats value) {
    store(value, lanes.data() + lane);
}

/// Of a lane with the bit one value, of the others another.
CAROM_PASS_INLINE Floats by_trait(const ContactBundle& c, int lane, std::int32_t bit, float with, float without) {
    const Ints traits = load(c.traits.data() + lane);
    return select((traits & Ints{bit}) != Ints{0}, broadcast(with), broadcast(without));
}
CAROM_PASS_INLINE Floats bias_rates(const ContactBundle& c, int lane, const dynamics::SoftContacts& soft) {
    return by_trait(c, lane, dynamics::LaneTraits::kFixed, soft.fixed.bias_rate, soft.moving.bias_rate);
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

/// A vector in the frame of a basis: x along the normal, y and z along the tangents. The frame is right-handed.
CAROM_PASS_INLINE Floats3 to_frame(const Basis& basis, const Floats3& v) { return {dot(v, basis.n), dot(v, basis.t1), dot(v, basis.t2)}; }
CAROM_PASS_INLINE Floats3 from_frame(const Basis& basis, const Floats3& v) { return v.x * basis.n + (v.y * basis.t1 + v.z * basis.t2); }

CAROM_PASS_INLINE Floats3 get3(const dynamics::FrameVectors& v, int lane) { return {get(v.n, lane), get(v.t1, lane), get(v.t2, lane)}; }
CAROM_PASS_INLINE void put3(dynamics::FrameVectors& v, int lane, const Floats3& value) {
    put(v.n, lane, value.x), put(v.t1, lane, value.y), put(v.t2, lane, value.z);
}

/// A symmetric matrix of each lane.
struct Symmetric {
    Floats3 diagonal;
    Floats xy, xz, yz;

    Floats3 operator*(const Floats3& v) const {
        return {diagonal.x * v.x + (xy * v.y + xz * v.z), diagonal.y * v.y + (xy * v.x + yz * v.z), diagonal.z * v.z + (xz * v.x + yz * v.y)};
    }
};

/// What a unit push at the lever arm r, along the normal or a tangent, changes the spin by.
CAROM_PASS_INLINE Floats3 along_n(const Symmetric& i, const Floats3& r) {
    return {i.xy * r.z - i.xz * r.y, i.diagonal.y * r.z - i.yz * r.y, i.yz * r.z - i.diagonal.z * r.y};
}
CAROM_PASS_INLINE Floats3 along_t1(const Symmetric& i, const Floats3& r) {
    return {i.xz * r.x - i.diagonal.x * r.z, i.yz * r.x - i.xy * r.z, i.diagonal.z * r.x - i.xz * r.z};
}
CAROM_PASS_INLINE Floats3 along_t2(const Symmetric& i, const Floats3& r) {
    return {i.diagonal.x * r.y - i.xy * r.x, i.xy * r.y - i.diagonal.y * r.x, i.xz * r.y - i.yz * r.x};
}

CAROM_PASS_INLINE Symmetric read_inertia(const dynamics::FrameMass& m, int lane) {
    return {get3(m.diagonal, lane), get(m.n1, lane), get(m.n2, lane), get(m.t12, lane)};
}

/// The motion of one body of each lane, in world axes.
struct Motion {
    Floats3 v, w;
};

CAROM_PASS_INLINE Motion read_motion(const SolverBodies& all, const std::int32_t* rows) {
    const float* body = reinterpret_cast<const float*>(all.bodies.data());
    const TwoRows r = gather_two_rows(body, rows, kBodyStride, 0);
    return {{r.a, r.b, r.c}, {r.e, r.f, r.g}};
}

CAROM_PASS_INLINE void add_motion(SolverBodies& all, const std::int32_t* rows, const Motion& m) {
    const Floats zero = broadcast(0.0f);
    Floats change[8] = {m.v.x, m.v.y, m.v.z, zero, m.w.x, m.w.y, m.w.z, zero};
    add_rows(reinterpret_cast<float*>(all.bodies.data()), rows, kBodyStride, change, all.movable);
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
