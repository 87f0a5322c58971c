#include <carom/dynamics/detail/bundle_fill.hpp>

#include <algorithm>
#include <cmath>

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

vec3 turned(const SolverMass& m, const vec3& t) {
    const auto& d = m.diagonal;
    const auto& o = m.others;
    return {d[0] * t.x + o[0] * t.y + o[1] * t.z, o[0] * t.x + d[1] * t.y + o[2] * t.z, o[1] * t.x + o[2] * t.y + d[2] * t.z};
}

/// Both bodies' inverse masses, felt at a point.
struct PointMass {
    const SolverMass& a;
    const SolverMass& b;
    vec3 ra, rb;

    /// Velocity along `v` of the two points against each other, for a unit impulse along `u`.
    float response(const vec3& u, const vec3& v) const {
        const float linear = (a.diagonal[3] + b.diagonal[3]) * glm::dot(u, v);
        return linear + glm::dot(turned(a, glm::cross(ra, u)), glm::cross(ra, v)) +
               glm::dot(turned(b, glm::cross(rb, u)), glm::cross(rb, v));
    }
};

float inverse_or_zero(float x) { return x > 0.0f ? 1.0f / x : 0.0f; }

vec3 velocity_at(const SolverBody& body, const vec3& r) {
    return vec3{body.velocity[0], body.velocity[1], body.velocity[2]} +
           glm::cross(vec3{body.spin[0], body.spin[1], body.spin[2]}, r);
}

void fill_point(PointLanes& p, std::size_t lane, const LaneInput& in, std::size_t k, const SolverBodies& rows) {
    const auto a = static_cast<std::size_t>(in.row_a);
    const auto b = static_cast<std::size_t>(in.row_b);
    const ContactPoint& point = in.manifold->points[k];
    const vec3& n = in.manifold->normal;
    const PointMass mass{rows.masses[a], rows.masses[b], in.origin_a + point.position, in.origin_b + point.position};
    const auto [t1, t2] = tangents(n);
    p.ax[lane] = mass.ra.x;
    p.ay[lane] = mass.ra.y;
    p.az[lane] = mass.ra.z;
    p.bx[lane] = mass.rb.x;
    p.by[lane] = mass.rb.y;
    p.bz[lane] = mass.rb.z;
    p.separation[lane] = point.separation - glm::dot(mass.rb - mass.ra, n);
    p.normal_mass[lane] = inverse_or_zero(mass.response(n, n));
    const float k11 = mass.response(t1, t1);
    const float k22 = mass.response(t2, t2);
    const float k12 = mass.response(t1, t2);
    const float half_difference = 0.5f * (k11 - k22);
    const float largest = 0.5f * (k11 + k22) + std::sqrt(half_difference * half_difference + k12 * k12);
    p.tangent_mass[lane] = inverse_or_zero(largest);
    const PointImpulse& impulse = (*in.impulses)[k];
    p.normal_impulse[lane] = impulse.normal;
    p.tangent_impulse_1[lane] = glm::dot(impulse.friction, t1);
    p.tangent_impulse_2[lane] = glm::dot(impulse.friction, t2);
    p.approach[lane] = glm::dot(velocity_at(rows.bodies[b], mass.rb) - velocity_at(rows.bodies[a], mass.ra), n);
}

}  // namespace

void clear_bundle(ContactBundle& bundle, std::int32_t unmovable_row) noexcept {
    const Wide<std::uint32_t> manifold = bundle.manifold;
    bundle = ContactBundle{};
    bundle.manifold = manifold;
    bundle.row_a.fill(unmovable_row);
    bundle.row_b.fill(unmovable_row);
    bundle.ny.fill(1.0f);
    bundle.mass_scale.fill(1.0f);
}

void fill_lane(ContactBundle& bundle, std::size_t lane, const LaneInput& input, const SolverBodies& rows) noexcept {
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
    const auto count = static_cast<std::int32_t>(input.manifold->count);
    bundle.point_count = std::max(bundle.point_count, count);
    for (std::size_t k = 0; k < input.manifold->count; ++k) fill_point(bundle.points[k], lane, input, k, rows);
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
