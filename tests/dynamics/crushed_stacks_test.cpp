// Light stacks under loads of up to 10⁶ times their density, which crush, tilt, slip off and are caught: none gains energy from the contact solvers.
//
//   CAROM_STACKS=4000 test_dynamics --gtest_filter='CrushedStacks.*'     the long run: a minute and a half
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/dynamics/world.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace carom {
namespace {

double log_range(Random& random, double least, double most) { return least * std::pow(most / least, random.unit()); }

/// Adds boxes, and cylinders among them, one on the other; every number of them is drawn from `random`.
class Stack {
public:
    explicit Stack(Random& random) : random_(random), friction_(random.unit() < 0.25 ? 0.0f : static_cast<float>(random.range(0.1, 1.0))) {}

    void put_ground(World& world) {
        const BodyId ground = world.create_body({.type = BodyType::Static});
        if (random_.unit() < 0.5) {
            world.add_shape(ground, Plane{}, {.friction = friction_});
        } else {
            world.add_shape(ground, Box{{50.0f, 5.0f, 50.0f}}, {.friction = friction_, .local = {.position = {0.0, -5.0, 0.0}}});
        }
        if (random_.unit() > 0.2) return;
        for (const double side : {-1.0, 1.0}) {  // walls that lean out
            const BodyId wall = world.create_body({.type = BodyType::Static, .position = {1.7 * side, 1.0, 0.0}, .orientation = rotation_from_vector({0.0, 0.0, -0.4 * side})});
            world.add_shape(wall, Box{{0.1f, 3.0f, 3.0f}}, {.friction = friction_});
        }
    }

    /// @param tilt  about x and z at most [rad]   @param aside  at most [m]
    void put(World& world, double density, double tilt, double aside, double above) {
        const vec3 half{static_cast<float>(random_.range(0.2, 0.6)), static_cast<float>(random_.range(0.05, 0.4)), static_cast<float>(random_.range(0.2, 0.6))};
        const double reach = tilt == 0.0 ? static_cast<double>(half.y) : std::hypot(static_cast<double>(half.x), static_cast<double>(half.y), static_cast<double>(half.z));
        top_ += above + reach;
        const dvec3 turn{random_.range(-tilt, tilt), random_.range(0.0, 6.0), random_.range(-tilt, tilt)};
        const BodyId body = world.create_body({.position = {random_.range(-aside, aside), top_, random_.range(-aside, aside)}, .orientation = rotation_from_vector(turn)});
        const Shape shape = random_.unit() < 0.15 ? Shape{Cylinder{half.x, half.y}} : Shape{Box{half}};
        world.add_shape(body, shape, {.density = density, .friction = friction_});
        top_ += reach;
        const double mass = world.mass_properties(body).mass;
        potential_ += mass * 9.81 * std::max(0.1, world.center_of_mass(body).y);
    }

    [[nodiscard]] double potential() const { return potential_; }

private:
    Random& random_;
    float friction_;
    double top_ = 0.0, potential_ = 0.0;
};

/// Energy that comes from nothing in 400 steps, over the potential energy at the start. @param direct  islands that were solved so, over all steps
double gain_of(std::uint64_t seed, std::size_t& direct) {
    Random random(seed);
    World world;
    Stack stack(random);
    stack.put_ground(world);
    const int light = 1 + static_cast<int>(random.unit() * (random.unit() < 0.2 ? 24.0 : 8.0)), heavy = random.unit() < 0.5 ? 1 : 1 + static_cast<int>(random.unit() * 4.0);
    for (int i = 0; i < light; ++i) stack.put(world, 1000.0, 0.0, 0.05, 0.0);
    const double density = 1000.0 * log_range(random, 10.0, 1e6), tilt = random.unit() < 0.5 ? 0.0 : random.range(0.01, 0.5);
    const double drop = random.unit() < 0.3 ? 0.0 : log_range(random, 1e-4, 3.0);
    for (int i = 0; i < heavy; ++i) stack.put(world, density, tilt, heavy == 1 ? 0.0 : 0.3, drop);
    const double dt = random.unit() < 0.3 ? 1.0 / 120.0 : 1.0 / 60.0;
    const bool varies = random.unit() < 0.3;
    const double before = world.energy().total();
    double most = before;
    for (int step = 0; step < 400; ++step) {
        direct += world.step(varies ? random.range(0.3, 1.7) * dt : dt).direct.solved;
        most = std::max(most, world.energy().total());
    }
    return (most - before) / stack.potential();
}

TEST(CrushedStacks, GainNothing) {
    const char* const asked = std::getenv("CAROM_STACKS");
    const int stacks = asked == nullptr ? 200 : std::stoi(asked);
    std::size_t direct = 0;
    double worst = 0.0;
    for (int k = 0; k < stacks; ++k) {
        const double gain = gain_of(static_cast<std::uint64_t>(1 + k), direct);
        worst = std::max(worst, gain);
        EXPECT_LT(gain, 0.01) << k;
    }
    EXPECT_GT(direct, 20u * static_cast<std::size_t>(stacks));
    RecordProperty("worst", std::to_string(worst));
    std::printf("%d crushed stacks: the most energy gained, over the potential at the start: %.2g\n", stacks, worst);
}

}  // namespace
}  // namespace carom
