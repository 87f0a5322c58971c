#include <carom/studies/oracle/ledger.hpp>

#include <carom/collision/aabb.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::oracle {
namespace {

/// @return error / scale, where nothing over nothing is nothing.
double relative(double error, double scale) {
    if (error == 0.0) return 0.0;
    return scale > 0.0 ? error / scale : std::numeric_limits<double>::infinity();
}

bool is_free(const World& world) {
    if (world.settings().gravity != dvec3{0.0}) return false;
    return std::ranges::all_of(world.bodies(), [&](BodyId body) { return world.type(body) == BodyType::Dynamic; });
}

double momentum_sum(const World& world) {
    double sum = 0.0;
    for (const BodyId body : world.bodies())
        sum += world.mass_properties(body).mass * glm::length(world.linear_velocity(body));
    return sum;
}

}  // namespace

EnergyLedger::EnergyLedger(const World& world) {
    measure(world);
    start_ = last_.total();
    look_at_bodies(world);
}

void EnergyLedger::measure(const World& world) {
    last_ = world.energy();
    largest_kinetic_ = std::max(largest_kinetic_, last_.kinetic);
}

void EnergyLedger::look_at_bodies(const World& world) {
    bodies_.assign(world.bodies().begin(), world.bodies().end());
    double mass = 0.0;
    double smallest = std::numeric_limits<double>::infinity();
    for (const BodyId body : bodies_) {
        if (world.type(body) != BodyType::Dynamic) continue;
        mass += world.mass_properties(body).mass;
        for (const ShapeId shape : world.shapes(body)) {
            smallest = std::min(smallest, smallest_extent(world.shape(shape)));
        }
    }
    if (is_finite(smallest)) lift_ = std::max(lift_, mass * glm::length(world.settings().gravity) * smallest);
}

void EnergyLedger::bodies_changed(const World& world) {
    const double before = last_.total();
    measure(world);
    brought_ += last_.total() - before;
    if (!std::ranges::equal(bodies_, world.bodies())) look_at_bodies(world);
}

void EnergyLedger::stepped(const World& world) {
    measure(world);
    drift_ = std::max(drift_, relative(std::max(0.0, change()), reference()));
}

MomentumLedger::MomentumLedger(const World& world)
    : free_(is_free(world)), start_(world.momentum()), last_(start_), largest_sum_(momentum_sum(world)) {}

void MomentumLedger::bodies_changed(const World& world) {
    free_ = free_ && is_free(world);
    if (!free_) return;
    const Momentum now = world.momentum();
    start_.linear += now.linear - last_.linear;
    start_.angular += now.angular - last_.angular;
    last_ = now;
    largest_sum_ = std::max(largest_sum_, momentum_sum(world));
}

void MomentumLedger::stepped(const World& world) {
    if (!free_) return;
    last_ = world.momentum();
    largest_sum_ = std::max(largest_sum_, momentum_sum(world));
    const double spin = glm::length(start_.angular);
    drift_.linear = std::max(drift_.linear, relative(glm::length(last_.linear - start_.linear), largest_sum_));
    drift_.angular = std::max(drift_.angular, relative(glm::length(last_.angular - start_.angular), spin));
    drift_.angular_magnitude =
        std::max(drift_.angular_magnitude, relative(std::abs(glm::length(last_.angular) - spin), spin));
}

std::optional<MomentumDrift> MomentumLedger::drift() const noexcept {
    if (!free_) return std::nullopt;
    return drift_;
}

}  // namespace carom::oracle
