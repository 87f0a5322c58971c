#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/dynamics/detail/contact_prepare.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/check.hpp>
#include <carom/dynamics/detail/contact_lanes.hpp>
#include <carom/dynamics/detail/contact_prepare.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using dynamics::LaneTraits;
using dynamics::ManifoldRow;
using dynamics::PrepareInput;

constexpr std::size_t kRowStride = sizeof(ManifoldRow) / sizeof(float);
constexpr std::size_t kPointStride = sizeof(ContactPoint) / sizeof(float);
constexpr std::size_t kImpulseStride = sizeof(dynamics::PointImpulse) / sizeof(float);
static_assert(offsetof(ContactPoint, separation) == 12 && sizeof(dynamics::PointImpulse) == 16);

// One manifold of each lane, without its points.
struct WideManifold {
    Floats3 origin_a, origin_b;
    Ints first_point;
    Ints count;  ///< 0 in unused lanes
};

constexpr std::size_t kMassStride = sizeof(dynamics::SolverMass) / sizeof(float);

/// Both bodies of each lane.
struct Masses {
    Symmetric a, b;
    Floats linear;  ///< sum of the inverse masses
};

CAROM_PASS_INLINE void put_inertia(dynamics::FrameMass& to, int lane, const Symmetric& inertia) {
    put3(to.diagonal, lane, inertia.diagonal);
    put(to.n1, lane, inertia.xy), put(to.n2, lane, inertia.xz), put(to.t12, lane, inertia.yz);
}

/// @return the inverse inertia in the frame; the bundle has it too from now on.
CAROM_PASS_INLINE Symmetric turn_mass(const SolverBodies& all, const std::int32_t* rows, const Basis& basis, dynamics::FrameMass& to, int lane) {
    const auto* const mass = reinterpret_cast<const float*>(all.masses.data());
    const TwoRows r = gather_two_rows(mass, rows, kMassStride, 0);  // as SolverMass has them
    const Symmetric world{{r.a, r.b, r.c}, r.e, r.f, r.g};
    const Floats3 n = world * basis.n, t1 = world * basis.t1, t2 = world * basis.t2;
    const Symmetric turned{{dot(basis.n, n), dot(basis.t1, t1), dot(basis.t2, t2)}, dot(basis.n, t1), dot(basis.n, t2), dot(basis.t1, t2)};
    put_inertia(to, lane, turned);
    put(to.inverse_mass, lane, r.d);
    return turned;
}

/// An inverse inertia felt at a lever arm: along the normal, and within the plane of the tangents.
struct Response {
    Floats nn, k11, k22, k12;
};

CAROM_PASS_INLINE Response response(const Symmetric& i, const Floats3& r) {
    const Floats3 n = along_n(i, r), t1 = along_t1(i, r), t2 = along_t2(i, r);
    return {r.z * n.y - r.y * n.z, r.x * t1.z - r.z * t1.x, r.y * t2.x - r.x * t2.y, r.y * t1.x - r.x * t1.y};
}

Floats inverse_or_zero(Floats x, Mask used) {
    const Mask good = used & (x > broadcast(0.0f));
    return select(good, broadcast(1.0f) / select(good, x, broadcast(1.0f)), broadcast(0.0f));
}

// A point of each lane as the manifold has it.
struct WidePoint {
    Floats3 position;
    Floats separation, normal_impulse;
    Floats3 friction_impulse;
    Mask used;
};

/// Effective masses of a point at its lever arms.
CAROM_PASS_INLINE void put_masses(PointLanes& p, int lane, const Floats3& ra, const Floats3& rb, const Masses& masses, Mask used) {
    const Response a = response(masses.a, ra), b = response(masses.b, rb);
    put(p.normal_mass, lane, inverse_or_zero(masses.linear + (a.nn + b.nn), used));
    const Floats k11 = masses.linear + (a.k11 + b.k11), k22 = masses.linear + (a.k22 + b.k22), k12 = a.k12 + b.k12;
    // The largest eigenvalue, from entries divided by the trace: their squares would leave the range of floats.
    const Floats trace = k11 + k22;
    const Floats scale = select(trace > broadcast(0.0f), trace, broadcast(1.0f));
    const Floats half_difference = broadcast(0.5f) * (k11 - k22) / scale;
    const Floats off_diagonal = k12 / scale;
    const Floats largest = trace * (broadcast(0.5f) + sqrt(half_difference * half_difference + off_diagonal * off_diagonal));
    put(p.tangent_mass, lane, inverse_or_zero(largest, used));
}

CAROM_PASS_INLINE void prepare_point(PointLanes& p, int lane, const WideManifold& m, const WidePoint& point, const Basis& basis,
                                     const Masses& masses) {
    const Floats zero = broadcast(0.0f);
    const Mask used = point.used;
    const Floats3 none{zero, zero, zero};
    const Floats3 ra = to_frame(basis, select(used, m.origin_a + point.position, none));
    const Floats3 rb = to_frame(basis, select(used, m.origin_b + point.position, none));
    put3(p.a, lane, ra), put3(p.b, lane, rb);
    put_masses(p, lane, ra, rb, masses, used);
    put(p.separation, lane, point.separation);
    put(p.normal_impulse, lane, point.normal_impulse);
    put(p.tangent_impulse_1, lane, dot(point.friction_impulse, basis.t1));
    put(p.tangent_impulse_2, lane, dot(point.friction_impulse, basis.t2));
}

CAROM_PASS_INLINE WideManifold read_manifold(ContactBundle& c, int lane, const ManifoldRow* all) {
    alignas(64) std::int32_t row[kLanes];
    for (int k = 0; k < kLanes; ++k) row[k] = lane + k;
    const float* const rows = all->normal;
    Floats nx, ny, nz, push_limit, ox, oy, oz, friction, px, py, pz, round, row_a, row_b, first_point, count;
    gather_rows(rows, row, kRowStride, 0, nx, ny, nz, push_limit);
    gather_rows(rows, row, kRowStride, 4, ox, oy, oz, friction);
    gather_rows(rows, row, kRowStride, 8, px, py, pz, round);
    gather_rows(rows, row, kRowStride, 12, row_a, row_b, first_point, count);
    store(as_ints(row_a), c.row_a.data() + lane);
    store(as_ints(row_b), c.row_b.data() + lane);
    put(c.nx, lane, nx), put(c.ny, lane, ny), put(c.nz, lane, nz);
    put(c.push_limit, lane, push_limit);
    put(c.friction, lane, friction);
    const Ints balls = as_ints(round), counted = as_ints(count), fixed{ManifoldRow::kMeetsFixed};
    const Mask both = balls > Ints{3};
    put(c.curvature, lane, select(both, round, broadcast(0.0f)));
    const auto bit = [](Mask which, std::int32_t trait) { return select(which, Ints{trait}, Ints{0}); };
    store(bit(both | (balls == Ints{1}), LaneTraits::kBallA) | bit(both | (balls == Ints{2}), LaneTraits::kBallB) |
              bit((counted & fixed) == fixed, LaneTraits::kFixed),
          c.traits.data() + lane);
    return {{ox, oy, oz}, {px, py, pz}, as_ints(first_point), counted & Ints{ManifoldRow::kMeetsFixed - 1}};
}

CAROM_PASS_INLINE WidePoint read_point(const WideManifold& m, std::int32_t k, const PrepareInput& in) {
    const auto* const points = reinterpret_cast<const float*>(in.points.data());
    const auto* const impulses = reinterpret_cast<const float*>(in.impulses.data());
    const Mask used = m.count > Ints{k};
    alignas(64) std::int32_t index[kLanes];
    store(select(used, m.first_point + Ints{k}, Ints{0}), index);  // the first is there: some lane has this point
    Floats x, y, z, separation, normal, fx, fy, fz;
    gather_rows(points, index, kPointStride, 0, x, y, z, separation);
    gather_rows(impulses, index, kImpulseStride, 0, normal, fx, fy, fz);
    const Floats zero = broadcast(0.0f);
    return {{x, y, z}, select(used, separation, zero), select(used, normal, zero), select(used, Floats3{fx, fy, fz}, Floats3{zero, zero, zero}),
            used};
}

void prepare_bundle(ContactBundle& c, const PrepareInput& in) {
    alignas(64) std::array<ManifoldRow, kBundleWidth> rows;
    std::memcpy(rows.data(), rows_in(c), sizeof(rows));
    c.point_count = 0;
    c.deep = 0;
    for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
        const WideManifold m = read_manifold(c, lane, rows.data());
        const auto most = static_cast<std::int32_t>(greatest_lane(to_floats(m.count)));
        // Points that no lane of this part has, but one of another part, are no-ops here.
        for (std::int32_t k = c.point_count; kLanes < kBundleWidth && k < most; ++k) c.points[static_cast<std::size_t>(k)] = PointLanes{};
        c.point_count = most > c.point_count ? most : c.point_count;
        const Basis basis = make_basis(c, lane);
        const Symmetric inertia_a = turn_mass(in.bodies, c.row_a.data() + lane, basis, c.a, lane);
        const Symmetric inertia_b = turn_mass(in.bodies, c.row_b.data() + lane, basis, c.b, lane);
        const Masses masses{inertia_a, inertia_b, get(c.a.inverse_mass, lane) + get(c.b.inverse_mass, lane)};
        const Floats bias_rate = bias_rates(c, lane, in.soft), push_limit = get(c.push_limit, lane);
        for (std::int32_t k = 0; k < most; ++k) {
            const WidePoint point = read_point(m, k, in);
            c.deep += static_cast<std::int32_t>(hwy::PopCount(bits(point.used & (bias_rate * point.separation < -push_limit))));
            prepare_point(c.points[static_cast<std::size_t>(k)], lane, m, point, basis, masses);
        }
    }
}

void PrepareBundles(std::span<ContactBundle> bundles, const PrepareInput& in) {
    for (ContactBundle& c : bundles) prepare_bundle(c, in);
}

Mask changed_lanes(const ContactBundle& c, int lane, const unsigned char* changed) {
    alignas(64) std::int32_t found[kLanes];
    for (int k = 0; k < kLanes; ++k) {
        const auto i = static_cast<std::size_t>(lane + k);
        found[k] = changed[c.row_a[i]] | changed[c.row_b[i]];
    }
    return load(found) != Ints{0};
}

Symmetric select(Mask which, const Symmetric& yes, const Symmetric& no) {
    return {select(which, yes.diagonal, no.diagonal), select(which, yes.xy, no.xy), select(which, yes.xz, no.xz), select(which, yes.yz, no.yz)};
}

bool any_changed(const ContactBundle& c, const unsigned char* changed) {
    unsigned found = 0;
    for (int lane = 0; lane < kBundleWidth; ++lane) {
        const auto i = static_cast<std::size_t>(lane);
        found |= static_cast<unsigned>(changed[c.row_a[i]] | changed[c.row_b[i]]);
    }
    return found != 0;
}

void RenewMasses(std::span<ContactBundle> bundles, const SolverBodies& bodies, const unsigned char* changed) {
    for (ContactBundle& c : bundles) {
        if (!any_changed(c, changed)) continue;
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            // The other lanes keep theirs, to the bit: in a step that kept its contacts these are of when they were prepared, and which lanes are beside each other
            // depends on the number of threads.
            const Mask renewed = changed_lanes(c, lane, changed);
            const Basis basis = make_basis(c, lane);
            const Symmetric had_a = read_inertia(c.a, lane), had_b = read_inertia(c.b, lane);
            const Symmetric inertia_a = turn_mass(bodies, c.row_a.data() + lane, basis, c.a, lane);
            const Symmetric inertia_b = turn_mass(bodies, c.row_b.data() + lane, basis, c.b, lane);
            const Masses masses{inertia_a, inertia_b, get(c.a.inverse_mass, lane) + get(c.b.inverse_mass, lane)};
            put_inertia(c.a, lane, select(renewed, inertia_a, had_a));
            put_inertia(c.b, lane, select(renewed, inertia_b, had_b));
            for (int k = 0; k < c.point_count; ++k) {
                PointLanes& p = c.points[static_cast<std::size_t>(k)];
                const Floats normal = get(p.normal_mass, lane), tangent = get(p.tangent_mass, lane);
                put_masses(p, lane, get3(p.a, lane), get3(p.b, lane), masses, tangent > broadcast(0.0f));
                put(p.normal_mass, lane, select(renewed, get(p.normal_mass, lane), normal));
                put(p.tangent_mass, lane, select(renewed, get(p.tangent_mass, lane), tangent));
            }
        }
    }
}

void StoreImpulses(std::span<const ContactBundle> bundles, std::span<const dynamics::ContactManifold> manifolds, std::span<dynamics::PointImpulse> impulses) {
    auto* const to = reinterpret_cast<float*>(impulses.data());
    constexpr std::int32_t kNowhere = std::numeric_limits<std::int32_t>::max();
    for (const ContactBundle& c : bundles) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            alignas(64) std::int32_t first[kLanes], count[kLanes], row[kLanes];
            for (std::size_t k = 0; k < std::size_t{kLanes}; ++k) {
                const std::uint32_t m = c.manifold[static_cast<std::size_t>(lane) + k];
                const bool used = m != dynamics::kUnusedLane;
                first[k] = used ? static_cast<std::int32_t>(manifolds[m].first_point) : 0;
                count[k] = used ? manifolds[m].count : 0;
            }
            const Ints firsts = load(first), counts = load(count);
            const Basis basis = make_basis(c, lane);
            for (int k = 0; k < c.point_count; ++k) {
                const PointLanes& p = c.points[static_cast<std::size_t>(k)];
                const Floats3 friction = get(p.tangent_impulse_1, lane) * basis.t1 + get(p.tangent_impulse_2, lane) * basis.t2;
                store(select(counts > Ints{k}, firsts + Ints{k}, Ints{kNowhere}), row);
                scatter_rows(to, row, kImpulseStride, 0, get(p.normal_impulse, lane), friction.x,
                             friction.y, friction.z, kNowhere);
            }
        }
    }
}

void CarryGaps(std::span<ContactBundle> bundles, std::span<const dynamics::ContactManifold> manifolds, std::span<ContactPoint> points,
               const dynamics::SoftContacts& soft) {
    for (ContactBundle& c : bundles) {
        c.deep = 0;
        for (int k = 0; k < c.point_count; ++k) {
            PointLanes& p = c.points[static_cast<std::size_t>(k)];
            for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
                const Mask used = get(p.normal_mass, lane) > broadcast(0.0f);
                const Floats separation = select(used, get(p.gap, lane), get(p.separation, lane));
                put(p.separation, lane, separation);
                c.deep += static_cast<std::int32_t>(hwy::PopCount(bits(used & (bias_rates(c, lane, soft) * separation < -get(c.push_limit, lane)))));
            }
            for (std::size_t lane = 0; lane < kBundleWidth; ++lane) {
                if (p.normal_mass[lane] > 0.0f) points[manifolds[c.manifold[lane]].first_point + static_cast<std::uint32_t>(k)].separation = p.separation[lane];
            }
        }
    }
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
HWY_EXPORT(PrepareBundles);
HWY_EXPORT(RenewMasses);
HWY_EXPORT(StoreImpulses);
HWY_EXPORT(CarryGaps);

namespace dynamics {

void prepare_bundles(std::span<ContactBundle> bundles, const PrepareInput& input) { HWY_DYNAMIC_DISPATCH(PrepareBundles)(bundles, input); }

void renew_masses(std::span<ContactBundle> bundles, const SolverBodies& bodies, std::span<const unsigned char> changed) {
    CAROM_ASSERT(changed.size() == bodies.bodies.size());
    HWY_DYNAMIC_DISPATCH(RenewMasses)(bundles, bodies, changed.data());
}

void store_impulses(std::span<const ContactBundle> bundles, std::span<const ContactManifold> manifolds, std::span<PointImpulse> impulses) {
    HWY_DYNAMIC_DISPATCH(StoreImpulses)(bundles, manifolds, impulses);
}

void carry_gaps(std::span<ContactBundle> bundles, std::span<const ContactManifold> manifolds, std::span<ContactPoint> points, const SoftContacts& soft) {
    HWY_DYNAMIC_DISPATCH(CarryGaps)(bundles, manifolds, points, soft);
}

}  // namespace dynamics
}  // namespace carom
#endif
