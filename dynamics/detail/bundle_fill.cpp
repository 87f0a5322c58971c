#include <carom/dynamics/detail/bundle_fill.hpp>

#include <carom/core/check.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

struct Tangents {
    vec3 t1, t2;
};

/// The same tangents as the solver's (Duff et al. 2017).
Tangents tangents(const vec3& n) {
    const float sign = n.z < 0.0f ? -1.0f : 1.0f;
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

void fill_point(PointLanes& p, std::size_t lane, const LaneInput& in, std::size_t k) {
    const ContactPoint& point = in.manifold->points[k];
    const vec3 ra = in.origin_a + point.position;
    const vec3 rb = in.origin_b + point.position;
    p.ax[lane] = ra.x;
    p.ay[lane] = ra.y;
    p.az[lane] = ra.z;
    p.bx[lane] = rb.x;
    p.by[lane] = rb.y;
    p.bz[lane] = rb.z;
    p.separation[lane] = point.separation;
    const PointImpulse& impulse = (*in.impulses)[k];
    p.normal_impulse[lane] = impulse.normal;
    p.tangent_impulse_1[lane] = impulse.friction.x;
    p.tangent_impulse_2[lane] = impulse.friction.y;
    p.peak_impulse[lane] = impulse.friction.z;
    p.normal_mass[lane] = 1.0f;
}

}  // namespace

void clear_bundle(ContactBundle& bundle, std::int32_t unmovable_row, std::size_t point_count) noexcept {
    bundle.row_a.fill(unmovable_row);
    bundle.row_b.fill(unmovable_row);
    bundle.nx.fill(0.0f);
    bundle.ny.fill(1.0f);
    bundle.nz.fill(0.0f);
    for (Wide<float>* lanes : {&bundle.friction, &bundle.restitution, &bundle.bias_rate, &bundle.impulse_scale, &bundle.push_limit}) {
        lanes->fill(0.0f);
    }
    bundle.mass_scale.fill(1.0f);
    bundle.bounces = false;
    bundle.point_count = static_cast<std::int32_t>(point_count);
    std::fill_n(bundle.points.begin(), point_count, PointLanes{});
}

void fill_lane(ContactBundle& bundle, std::size_t lane, const LaneInput& input) noexcept {
    bundle.row_a[lane] = input.row_a;
    bundle.row_b[lane] = input.row_b;
    bundle.nx[lane] = input.manifold->normal.x;
    bundle.ny[lane] = input.manifold->normal.y;
    bundle.nz[lane] = input.manifold->normal.z;
    bundle.friction[lane] = input.friction;
    bundle.restitution[lane] = input.restitution;
    bundle.bounces |= input.restitution > 0.0f;
    bundle.bias_rate[lane] = input.soft.bias_rate;
    bundle.mass_scale[lane] = input.soft.mass_scale;
    bundle.impulse_scale[lane] = input.soft.impulse_scale;
    bundle.push_limit[lane] = input.push_limit;
    CAROM_ASSERT(input.manifold->count <= static_cast<std::uint32_t>(bundle.point_count));
    for (std::size_t k = 0; k < input.manifold->count; ++k) fill_point(bundle.points[k], lane, input, k);
}

void store_impulses(const ContactBundle& bundle, ContactSet& contacts) noexcept {
    for (std::size_t lane = 0; lane < kLanesPerBundle; ++lane) {
        if (bundle.manifold[lane] == kUnusedLane) continue;
        const Manifold& manifold = contacts.manifolds[bundle.manifold[lane]];
        const auto [t1, t2] = tangents(manifold.normal);
        ManifoldImpulses& impulses = contacts.impulses[bundle.manifold[lane]];
        for (std::size_t k = 0; k < manifold.count; ++k) {
            const PointLanes& p = bundle.points[k];
            impulses[k].normal = p.normal_impulse[lane];
            impulses[k].friction = p.tangent_impulse_1[lane] * t1 + p.tangent_impulse_2[lane] * t2;
        }
    }
}

}  // namespace carom::dynamics
