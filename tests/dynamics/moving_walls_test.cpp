// Kinematic walls that move and turn: what the step has stopped goes along with them, and nothing comes through them but what they crush.
//
//   CAROM_SHOTS=100000 test_dynamics --gtest_filter='MovingWalls.*'     the long run
#include "bullets.hpp"
#include "shuffled_executor.hpp"
#include "table.hpp"

#include <carom/dynamics/detail/body_path.hpp>
#include <carom/dynamics/explain_sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

enum class Going { Straight, Turning };

/// Two dozen bodies before a wall that comes towards them: some lie beside it, the others are shot at these and at it.
struct Crowd {
    World world;
    BodyId wall;
    std::vector<BodyId> bodies;
    int wall_kind;
    double thickness;
    double dt;
    ContinuousCounts counts{};
    std::vector<unsigned char> left;  ///< the wall's surroundings: it may have flown round its edge
    int behind = 0;

    Crowd(std::uint64_t seed, int kind, Going going, const WorldDef& def = kSpace) : world(def), wall_kind(kind) {
        Random random(seed);
        const auto thin = static_cast<float>(random.unit() < 0.5 ? 0.001 : random.range(0.001, 0.01));
        thickness = static_cast<double>(thin);
        dt = random.unit() < 0.6 ? kDt : random.unit() < 0.5 ? 2.0 * kDt : 0.25 * kDt;
        BodyDef wall_def{.type = BodyType::Kinematic};
        if (going == Going::Straight || random.unit() < 0.5) wall_def.linear_velocity = random.range(0.0, 60.0) * random_direction(random);
        if (going == Going::Turning) {
            const double about = random.range(0.0, 2.0 * kPi);
            wall_def.angular_velocity = std::pow(10.0, random.range(-6.0, 1.4)) * dvec3{std::cos(about), std::sin(about), 0.0};
        }
        wall = world.create_body(wall_def);
        world.add_shape(wall, thin_wall(kind, thin), {.restitution = random.unit() < 0.5 ? 0.0f : 1.0f});
        const int kind_a = static_cast<int>(random.unit() * kBullets), kind_b = static_cast<int>(random.unit() * kBullets);
        const bool rods = random.unit() < 0.3;
        for (int i = 0; i < 24; ++i) add(random, i, rods && i % 2 == 1 ? 2 : i % 2 == 0 ? kind_a : kind_b);
    }

    void add(Random& random, int i, int kind) {
        const dvec3 place{0.6 * (i % 5 - 2), 0.6 * (i / 5 - 2), 0.0};
        const double speed = 50.0 * std::pow(200.0, random.unit()),
                     spin = random.unit() < 0.5 ? 0.0 : std::pow(10.0, random.range(0.0, 4.0));
        BodyDef def{.position = place, .orientation = any_rotation(random)};
        if (i % 3 == 0) {
            const double reach = bounds(bullet(kind), Pose{def.position, def.orientation}).upper.z;
            def.position.z = -reach - 0.5 * thickness - std::pow(10.0, random.range(-6.0, -2.0));
            if (random.unit() < 0.3) def.linear_velocity = random.range(0.0, 50.0) * random_direction(random);
        } else {  // at one that lies there
            const int aim = 3 * static_cast<int>(8.0 * random.unit());
            def.position = {0.6 * (aim % 5 - 2) + random.range(-0.03, 0.03), 0.6 * (aim / 5 - 2) + random.range(-0.03, 0.03),
                            -1.2 - 1.1 * i - random.range(0.0, 1.0) * speed * dt};
            def.linear_velocity = speed * glm::normalize(dvec3{0.1 * random.range(-1.0, 1.0), 0.1 * random.range(-1.0, 1.0), 1.0});
            def.angular_velocity = spin * random_direction(random);
        }
        bodies.push_back(world.create_body(def));
        world.add_shape(bodies.back(), bullet(kind),
                        {.friction = random.unit() < 0.5 ? 0.6f : 0.0f, .restitution = random.unit() < 0.5 ? 0.5f : 0.0f});
    }

    void run(int steps) {
        left.resize(bodies.size());
        for (int k = 0; k < steps; ++k) {
            const ContinuousCounts step = world.step(dt).continuous;
            counts.impacts += step.impacts, counts.stopped += step.stopped, counts.carried += step.carried, counts.crushed += step.crushed;
            const Pose pose = world.pose(wall);
            for (std::size_t i = 0; i < bodies.size(); ++i) {
                const dvec3 at = inverse_transform_point(pose, world.center_of_mass(bodies[i]));
                const bool plane = wall_kind == kThinWalls - 1;
                if (left[i] != 0 || (!plane && glm::length(at) > 200.0)) {
                    left[i] = 1;
                } else if (at.z > (plane ? -0.5 * thickness : 0.0)) {
                    ++behind, left[i] = 1;
                }
            }
        }
    }
};

int shots() {
    const char* const asked = std::getenv("CAROM_SHOTS");
    return asked == nullptr ? 10'000 : std::stoi(asked);
}

void expect_nothing_comes_through(Going going, std::uint64_t first_seed) {
    std::size_t carried = 0, crushed = 0;
    const int crowds = shots() / 24 / 12;
    for (int i = 0; i < crowds; ++i) {
        Crowd crowd(first_seed + static_cast<std::uint64_t>(i), i % kThinWalls, going);
        crowd.run(6);
        EXPECT_EQ(crowd.behind, 0) << "crowd " << i << " at wall " << i % kThinWalls;
        carried += crowd.counts.carried, crushed += crowd.counts.crushed;
    }
    std::printf("moving walls: %d shots, %zu carried, %zu crushed\n", 24 * crowds, carried, crushed);
    EXPECT_EQ(crushed, 0u) << "there is nothing that they could be crushed against";
    EXPECT_GT(carried, static_cast<std::size_t>(crowds / 10)) << "or else little is tested";
}

TEST(MovingWalls, NothingOfACrowdComesThroughOneThatMoves) { expect_nothing_comes_through(Going::Straight, 1); }
TEST(MovingWalls, NothingOfACrowdComesThroughOneThatTurns) { expect_nothing_comes_through(Going::Turning, 100'001); }

TEST(MovingWalls, CrowdsHaveTheSameBitsOnAnyNumberOfThreads) {
    std::size_t carried = 0;
    ShuffledExecutor threads(4);
    WorldDef few = kSpace, shared = kSpace;
    few.continuous.most_impacts = shared.continuous.most_impacts = 3;
    shared.executor = &threads;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Crowd alone(seed, static_cast<int>(seed % kThinWalls), Going::Turning, few),
            crowd(seed, static_cast<int>(seed % kThinWalls), Going::Turning, shared);
        alone.run(4), crowd.run(4);
        EXPECT_EQ(alone.world.state_hash(), crowd.world.state_hash()) << seed;
        carried += alone.counts.carried;
    }
    EXPECT_GT(carried, 8u);
}

/// A ball that is hit once, which is all that it may be, by another, before a door that comes: both stand, and the door takes them along.
struct Doorway {
    World world;
    BodyId door, ball, shot;
    ContinuousCounts counts;

    explicit Doorway(const WorldDef& def = {.gravity = dvec3{0.0}, .record_paths = true, .continuous = {.most_impacts = 1}}) : world(def) {}

    void step(const dvec3& turning = dvec3{0.0}, double speed = 60.0) {
        door = world.create_body(
            {.type = BodyType::Kinematic, .position = {0.0, 0.0, -0.6}, .linear_velocity = {0.0, 0.0, speed}, .angular_velocity = turning});
        world.add_shape(door, Box{{3.0f, 3.0f, 0.01f}});
        ball = world.create_body({});
        world.add_shape(ball, Sphere{0.05f});
        shot = world.create_body({.position = {-3.0, 0.0, 0.0}, .linear_velocity = {400.0, 0.0, 0.0}});
        world.add_shape(shot, Sphere{0.05f});
        counts = world.step(kDt).continuous;
    }
    [[nodiscard]] Pose before_the_door(BodyId body, double t) const {
        return inverse(world.pose_within_step(door, t)) * world.pose_within_step(body, t);
    }
};

// What may not go everywhere does not ride: it keeps to its axes, and slides along these where they lead out of the wall's way; else it is crushed.
TEST(MovingWalls, WhatHasLockedAxesKeepsToThem) {
    for (const unsigned char locked : {LockedAxes::Plane2D, LockedAxes::MoveY}) {
        const bool is_flat = locked == LockedAxes::Plane2D;
        World world({.gravity = dvec3{0.0}, .continuous = {.most_impacts = 1}});
        const BodyId door = world.create_body({.type = BodyType::Kinematic,
                                               .position = {0.0, 0.0, -0.6},
                                               .linear_velocity = {0.0, 20.0, 60.0},
                                               .angular_velocity = {7.0, 5.0, 0.0}});
        world.add_shape(door, Box{{3.0f, 3.0f, 0.01f}}, {.friction = 0.0f});
        const auto add = [&](const dvec3& at, const dvec3& velocity) {
            const BodyId body = world.create_body({.position = at, .linear_velocity = velocity, .locked = locked});
            world.add_shape(body, Box{vec3{0.05f}}, {.friction = 0.0f});
            return body;
        };
        const std::array<BodyId, 2> bodies{add({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}), add({-3.0, 0.0, 0.0}, {400.0, 0.0, 0.0})};
        const ContinuousCounts counts = world.step(kDt).continuous;
        EXPECT_GT(counts.stopped, 0u);
        EXPECT_EQ(counts.carried, is_flat ? 0u : 2u);
        EXPECT_EQ(counts.crushed, is_flat ? 2u : 0u);
        for (const BodyId body : bodies) {
            const dvec3 at = world.pose(body).position, velocity = world.linear_velocity(body);
            EXPECT_EQ(inverse_transform_point(world.pose(door), at).z > 0.0, !is_flat) << "before the door";
            EXPECT_EQ(is_flat ? at.z : at.y, 0.0);
            EXPECT_EQ(is_flat ? velocity.z : velocity.y, 0.0);
            EXPECT_EQ(is_flat ? world.angular_velocity(body).x : 0.0, 0.0);
        }
    }
}

TEST(MovingWalls, WhatIsStoppedGoesAlongAsIfFixedToTheWall) {
    for (const dvec3& turning : {dvec3{0.0}, dvec3{0.0, 12.0, 0.0}, dvec3{7.0, 5.0, 3.0}}) {
        Doorway room;
        room.step(turning);
        EXPECT_EQ(room.counts.stopped, 2u);
        EXPECT_EQ(room.counts.carried, 2u);
        EXPECT_EQ(room.counts.crushed, 0u);
        for (const BodyId body : {room.ball, room.shot}) {
            const SweepExplanation why = room.world.explain_sweep(body, room.door);
            EXPECT_EQ(why.a.stopped, StopCause::Impacts);
            EXPECT_FALSE(why.passage);
            const Pose early = room.before_the_door(body, 0.8), late = room.before_the_door(body, 1.0);
            EXPECT_GT(late.position.z, 0.05);
            EXPECT_LT(late.position.z, 0.08) << "it is at the door";
            EXPECT_LT(glm::length(late.position - early.position), 1e-12);
            EXPECT_NEAR(std::abs(glm::dot(late.orientation, early.orientation)), 1.0, 1e-14);
            EXPECT_EQ(room.world.pose_within_step(body, 1.0).position, room.world.pose(body).position);
            // It has the door's velocity where it is, across the door, and never more; the two push each other besides.
            const Pose door = room.world.pose(room.door);
            const dvec3 out = rotate(door.orientation, dvec3{0.0, 0.0, 1.0});
            const dvec3 there = room.world.linear_velocity(room.door) + glm::cross(turning, room.world.pose(body).position - door.position);
            if (turning == dvec3{0.0}) {
                EXPECT_NEAR(glm::dot(out, room.world.linear_velocity(body) - there), 0.0, 1e-9);
            }
            EXPECT_LT(glm::dot(out, room.world.linear_velocity(body) - there), 1e-9);
        }
        room.world.step(kDt);
        EXPECT_GT(room.before_the_door(room.ball, 1.0).position.z, 0.05) << "and so on";
    }
}

TEST(MovingWalls, WhatIsCarriedTakesAlongWhatItComesUpon) {
    Doorway room({.record_paths = true, .continuous = {.most_impacts = 1}, .sleep = {.enabled = true}});
    const BodyId sleeper = room.world.create_body({.position = {0.0, 0.0, 0.25}});
    room.world.add_shape(sleeper, Box{{0.05f, 0.05f, 0.05f}});
    room.world.add_shape(room.world.create_body({.type = BodyType::Static, .position = {0.0, -0.1, 0.25}}),
                         Box{{0.5f, 0.05f, 0.05f}});  // to sleep on
    for (int k = 0; k < 120; ++k) room.world.step(kDt);
    ASSERT_FALSE(room.world.is_awake(sleeper));
    room.step();
    EXPECT_TRUE(room.world.is_awake(sleeper));
    EXPECT_EQ(room.counts.carried, 3u);
    EXPECT_GT(room.world.pose(sleeper).position.z, room.world.pose(room.ball).position.z + 0.099);
    EXPECT_NEAR(room.world.pose(room.ball).position.z, room.world.pose(room.door).position.z + 0.06, 1e-4);
    EXPECT_EQ(room.world.explain_sweep(sleeper, room.ball).a.stopped, StopCause::Partner);
}

// Between a wall that goes on and one that stands no place is left: the one that stands is the one that holds, and it is said so.
TEST(MovingWalls, WhatIsCrushedStaysBeforeTheWallThatStands) {
    for (const BodyType type : {BodyType::Static, BodyType::Kinematic}) {
        Doorway room;
        const BodyId stands = room.world.create_body({.type = type, .position = {0.0, 0.0, 0.3}});
        room.world.add_shape(stands, Box{{3.0f, 3.0f, 0.01f}});
        room.step();
        EXPECT_EQ(room.counts.carried, 2u);
        EXPECT_EQ(room.counts.crushed, 2u);
        for (const BodyId body : {room.ball, room.shot}) {
            EXPECT_NEAR(room.world.pose(body).position.z, 0.3 - 0.01 - 0.02 * 0.05, 1e-4) << "its middle is before the wall";
            EXPECT_FALSE(room.world.passage(body, stands));
            const SweepExplanation why = room.world.explain_sweep(body, room.door);
            EXPECT_EQ(why.a.stopped, StopCause::Crushed);
            ASSERT_TRUE(why.passage);
            EXPECT_EQ(why.passage->cause, SweepReason::Crushed) << to_string(why.passage->cause);
            EXPECT_NE(why.passage->sentence.find("is kinematic, which nothing stops"), std::string::npos) << why.passage->sentence;
            EXPECT_NE(why.passage->remedy.find("leaves room"), std::string::npos) << why.passage->remedy;
            EXPECT_TRUE(why.disagreements.empty());
        }
    }
}

dvec3 any_vector(Random& random, double most) { return random.range(0.0, most) * random_direction(random); }

// Sway and bend are bounds, the turn is exact, and the velocity against the carrier turns with it.
TEST(MovingWalls, RidesStayWithinTheBoundsOfTheirPaths) {
    using namespace dynamics;
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        Ride ride{{.start = {any_vector(random, 5.0), random_rotation(random)},
                   .translation = any_vector(random, 3.0),
                   .rotation = any_vector(random, i % 3 == 0 ? 40.0 : 0.5)},
                  {any_vector(random, 20.0), random_rotation(random)}};
        const double begin = random.unit() * 0.9, reach = 0.4;
        BodyPath path;
        path.ride(ride, begin, {kDt, reach, 0.01});
        std::vector<std::uint32_t> pieces{BodyPath::kWhole};
        for (std::size_t k = 0; k < pieces.size() && pieces.size() < 40; ++k) {
            if (!path.can_split(pieces[k])) continue;
            const auto [earlier, later] = path.split(pieces[k]);
            EXPECT_LT(path.piece(earlier).sway, path.piece(pieces[k]).sway + 1e-12);
            pieces.push_back(earlier), pieces.push_back(later);
        }
        for (const std::uint32_t number : pieces) {
            const PathPiece piece = path.piece(number);
            for (int k = 0; k <= 16; ++k) {
                const double t = piece.begin + (piece.end - piece.begin) * k / 16.0;
                const Pose is = pose_at(ride.carrier, t) * ride.local, said = pose_at(piece, t);
                EXPECT_LE(glm::length(is.position - said.position), piece.sway + 1e-12);
                const dvec3 tip = reach * random_direction(random);
                EXPECT_LE(glm::length(transform_point(is, tip) - transform_point(said, tip)), piece.bend + 1e-12);
            }
        }
        const BodyState start{pose_at(ride.carrier, begin) * ride.local, any_vector(random, 30.0), any_vector(random, 30.0)};
        const auto against = [&](const BodyState& state, double t) {
            return rotate_inverse(pose_at(ride.carrier, t).orientation, state.velocity - ride.motion(t, kDt).velocity);
        };
        const BodyState end = ride.after(start, begin, 1.0, kDt);
        EXPECT_LT(glm::length(against(end, 1.0) - against(start, begin)), 1e-10);
        EXPECT_NEAR(glm::length(end.spin), glm::length(start.spin), 1e-12);
        // motion() is how the pose changes.
        const double h = 1e-7, t = begin + 0.5 * (1.0 - begin);
        const dvec3 way =
            ((pose_at(ride.carrier, t + h) * ride.local).position - (pose_at(ride.carrier, t - h) * ride.local).position) / (2.0 * h * kDt);
        EXPECT_LT(glm::length(way - ride.motion(t, kDt).velocity), 1e-4 * (1.0 + glm::length(way)));
    }
}

}  // namespace
}  // namespace carom
