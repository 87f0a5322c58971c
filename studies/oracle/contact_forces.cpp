#include <carom/studies/oracle/contact_forces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace carom::oracle {
namespace {

using Real = long double;
using Vector = std::array<Real, 3>;

Vector widened(const dvec3& v) { return {v.x, v.y, v.z}; }
Vector cross(const Vector& a, const Vector& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
Real dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Real length(const Vector& a) { return std::sqrt(dot(a, a)); }
void add(Vector& to, const Vector& v, Real times) {
    for (std::size_t i = 0; i < 3; ++i) to[i] += times * v[i];
}

struct Sum {
    Vector force{}, torque{};
    Real lengths = 0.0L, reach = 0.0L, upward = 0.0L;
};

void add_force(Sum& sum, const Vector& force, const Vector& arm, const Vector& up) {
    add(sum.force, force, 1.0L);
    add(sum.torque, cross(arm, force), 1.0L);
    sum.lengths += length(force);
    sum.reach = std::max(sum.reach, length(arm));
    sum.upward += std::max(dot(force, up), 0.0L);
}

}  // namespace

ContactForces contact_forces(const World& world, double dt) {
    ContactForces out;
    const Vector gravity = widened(world.settings().gravity);
    const Real pull = length(gravity), scale = static_cast<Real>(world.settings().substeps) / static_cast<Real>(dt);
    Vector up{};
    if (pull > 0.0L) add(up, gravity, -1.0L / pull);
    std::map<BodyId, Sum> sums;
    Real largest = 0.0L, excess = 0.0L, negative = 0.0L;
    for (std::size_t i = 0; i < world.contact_count(); ++i) {
        const ContactView view = world.contact(i);
        const Real friction = std::sqrt(static_cast<Real>(world.shape_def(view.shape_a).friction) * static_cast<Real>(world.shape_def(view.shape_b).friction));
        for (std::size_t k = 0; k < view.manifold.count; ++k) {
            const Vector normal = widened(dvec3{view.manifold.normal}), slide = widened(dvec3{view.friction_impulse[k]});
            const Vector at = widened(view.origin + dvec3{view.manifold.points[k].position});
            const auto press = static_cast<Real>(view.normal_impulse[k]);
            largest = std::max(largest, press), negative = std::max(negative, -press), excess = std::max(excess, length(slide) - friction * press);
            Vector force{};
            add(force, normal, press * scale);
            add(force, slide, scale);
            for (const auto& [body, sign] : {std::pair{view.body_a, -1.0L}, std::pair{view.body_b, 1.0L}}) {
                Vector arm = at, on_body{};
                add(arm, widened(world.center_of_mass(body)), -1.0L);
                add(on_body, force, sign);
                add_force(sums[body], on_body, arm, up);
            }
        }
    }
    for (const BodyId body : world.bodies()) {
        if (world.type(body) != BodyType::Dynamic) continue;
        Sum sum = sums[body];
        const Real mass = world.mass_properties(body).mass;
        out.carried.push_back(static_cast<double>(sum.upward));
        add(sum.force, gravity, mass);
        const Real all = sum.lengths + mass * pull, torque = sum.reach > 0.0L ? length(sum.torque) / sum.reach : 0.0L;
        if (all > 0.0L) out.unbalanced = std::max(out.unbalanced, static_cast<double>(std::max(length(sum.force), torque) / all));
    }
    if (largest > 0.0L) {
        out.beyond_cone = static_cast<double>(excess / largest);
        out.pull = static_cast<double>(negative / largest);
    }
    return out;
}

}  // namespace carom::oracle
