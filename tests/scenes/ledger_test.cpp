// The ledgers of energy and momentum, by worlds whose velocities are set by hand.
#include "support.hpp"

#include <carom/studies/oracle/ledger.hpp>

#include <limits>

namespace carom::test {
namespace {

using oracle::EnergyLedger;
using oracle::MomentumLedger;

/// A cube of 1 kg and edge 1 m.
BodyId add_cube(World& world, const dvec3& at, const dvec3& velocity) {
    const BodyId body = world.create_body({.position = at, .linear_velocity = velocity});
    world.add_shape(body, Box{vec3{0.5f}}, {.density = 1.0});
    return body;
}

TEST(EnergyLedger, MeasuresAGainAgainstTheLargestKineticEnergyAndALiftOfOneSize) {
    World world({.gravity = {0.0, -10.0, 0.0}});
    const BodyId cube = add_cube(world, dvec3{0.0}, {2.0, 0.0, 0.0});
    EnergyLedger ledger(world);
    EXPECT_NEAR(ledger.reference(), 2.0 + 1.0 * 10.0 * 1.0, 1e-12);
    EXPECT_EQ(ledger.drift(), 0.0);
    world.set_linear_velocity(cube, {0.0, 0.0, 0.0});
    ledger.stepped(world);
    EXPECT_NEAR(ledger.change(), -2.0, 1e-12);
    EXPECT_EQ(ledger.drift(), 0.0);  // a loss is no error
    world.set_linear_velocity(cube, {0.0, 3.0, 0.0});
    ledger.stepped(world);
    EXPECT_NEAR(ledger.change(), 2.5, 1e-12);
    EXPECT_NEAR(ledger.drift(), 2.5 / 14.5, 1e-12);
    world.set_linear_velocity(cube, {0.0, 0.0, 0.0});
    ledger.stepped(world);
    EXPECT_NEAR(ledger.drift(), 2.5 / 14.5, 1e-12);  // the worst of the run stays
}

TEST(EnergyLedger, DoesNotTakeWhatTheUserBringsForAGain) {
    World world({.gravity = {0.0, -10.0, 0.0}});
    add_cube(world, dvec3{0.0}, dvec3{0.0});
    EnergyLedger ledger(world);
    const BodyId second = add_cube(world, {0.0, 5.0, 0.0}, {4.0, 0.0, 0.0});
    ledger.bodies_changed(world);
    ledger.stepped(world);
    EXPECT_NEAR(ledger.change(), 0.0, 1e-12);
    EXPECT_EQ(ledger.drift(), 0.0);
    world.destroy_body(second);
    ledger.bodies_changed(world);
    ledger.stepped(world);
    EXPECT_NEAR(ledger.change(), 0.0, 1e-12);
}

TEST(EnergyLedger, HasNoDriftWhereThereIsNothing) {
    World world({.gravity = dvec3{0.0}});
    EnergyLedger empty(world);
    empty.stepped(world);
    EXPECT_EQ(empty.drift(), 0.0);
}

TEST(EnergyLedger, AFallKeepsItsEnergy) {
    World world;
    add_cube(world, {0.0, 100.0, 0.0}, {1.0, 0.0, 0.0});
    EnergyLedger ledger(world);
    for (int i = 0; i < 120; ++i) {
        world.step(1.0 / 60.0);
        ledger.stepped(world);
    }
    EXPECT_NEAR(ledger.change(), 0.0, 1e-9 * ledger.reference());
    EXPECT_LT(ledger.drift(), 1e-9);
}

TEST(MomentumLedger, HasNothingToSayWhereTheWorldIsNotFree) {
    World heavy;
    add_cube(heavy, dvec3{0.0}, dvec3{0.0});
    EXPECT_FALSE(MomentumLedger(heavy).drift().has_value());
    World walled({.gravity = dvec3{0.0}});
    walled.create_body({.type = BodyType::Static});
    EXPECT_FALSE(MomentumLedger(walled).drift().has_value());
    World free({.gravity = dvec3{0.0}});
    MomentumLedger ledger(free);
    EXPECT_TRUE(ledger.drift().has_value());
    free.create_body({.type = BodyType::Static});
    ledger.bodies_changed(free);
    EXPECT_FALSE(ledger.drift().has_value());
}

TEST(MomentumLedger, MeasuresChangesAgainstWhatMoves) {
    World world({.gravity = dvec3{0.0}});
    const BodyId a = add_cube(world, {0.0, 1.0, 0.0}, {2.0, 0.0, 0.0});
    const BodyId b = add_cube(world, {0.0, -1.0, 0.0}, {-2.0, 0.0, 0.0});
    MomentumLedger ledger(world);
    ledger.stepped(world);
    EXPECT_EQ(ledger.drift()->linear, 0.0);
    // p = (0.5, 0, 0) against a sum of 4.5; L from (0, 0, -4) to (0, 0, -4.5).
    world.set_linear_velocity(a, {2.5, 0.0, 0.0});
    ledger.stepped(world);
    EXPECT_NEAR(ledger.drift()->linear, 0.5 / 4.5, 1e-12);
    EXPECT_NEAR(ledger.drift()->angular, 0.125, 1e-12);
    EXPECT_NEAR(ledger.drift()->angular_magnitude, 0.125, 1e-12);
    // The vector may turn where its length stays.
    world.set_linear_velocity(a, {0.0, 0.0, 2.0});
    world.set_linear_velocity(b, {0.0, 0.0, -2.0});
    ledger.stepped(world);
    EXPECT_NEAR(ledger.drift()->angular, std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(ledger.drift()->angular_magnitude, 0.125, 1e-12);
}

TEST(MomentumLedger, DoesNotTakeWhatTheUserBringsForADrift) {
    World world({.gravity = dvec3{0.0}});
    add_cube(world, dvec3{0.0}, {1.0, 0.0, 0.0});
    MomentumLedger ledger(world);
    add_cube(world, {5.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
    ledger.bodies_changed(world);
    ledger.stepped(world);
    EXPECT_EQ(ledger.drift()->linear, 0.0);
    EXPECT_EQ(ledger.drift()->angular, 0.0);
}

}  // namespace
}  // namespace carom::test
