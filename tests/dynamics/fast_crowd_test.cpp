// Crowds in a closed box, everybody faster than a step can see: nobody leaves, and the order of events is that of time on any number of threads.
#include "shuffled_executor.hpp"
#include "table.hpp"

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/random.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace carom {
namespace {

using namespace test;

enum class Walls { Stand, Move };

/// n³ balls, boxes and capsules half a metre apart between six walls of 1 mm.
struct Hall {
    static constexpr double kThin = 0.001;
    World world;
    std::vector<BodyId> bodies, walls;
    double half;
    ContinuousCounts sum{};

    Hall(int n, double slowest, double fastest, Walls how, std::uint64_t seed, const WorldDef& def) : world(def), half(0.25 * n + 0.7) {
        Random r(seed);
        for (int k = 0; k < 6; ++k) add_wall(k / 2, k % 2 == 0 ? -1.0 : 1.0, how);
        for (int i = 0; i < n * n * n; ++i) {
            const dvec3 at = 0.5 * dvec3{i % n, i / n % n, i / n / n} - dvec3{0.25 * (n - 1)};
            const BodyId body = world.create_body({.position = at,
                                                   .orientation = random_rotation(r),
                                                   .linear_velocity = r.range(slowest, fastest) * random_direction(r),
                                                   .angular_velocity = r.range(0.0, 300.0) * random_direction(r)});
            const Shape shapes[]{Sphere{0.1f}, Box{vec3{0.1f}}, Capsule{0.05f, 0.1f}};
            world.add_shape(body, shapes[i % 3], {.restitution = 0.7f});
            bodies.push_back(body);
        }
    }
    void add_wall(int axis, double side, Walls how) {
        BodyDef def{.type = BodyType::Static};
        def.position[axis] = side * (half + 0.5 * kThin);
        if (how == Walls::Move && side > 0.0) {
            def.type = BodyType::Kinematic;
            def.linear_velocity[axis] = -3.0;
            if (axis == 0) def.angular_velocity = {0.0, 0.5, 0.0};
        }
        vec3 extents{static_cast<float>(3.0 * half)};
        extents[axis] = static_cast<float>(0.5 * kThin);
        walls.push_back(world.create_body(def));
        world.add_shape(walls.back(), Box{extents}, {.restitution = 0.7f});
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) {
            const ContinuousCounts c = world.step(kDt).continuous;
            sum.followed += c.followed, sum.pairs += c.pairs, sum.impacts += c.impacts, sum.clamped += c.clamped, sum.stopped += c.stopped;
            sum.carried += c.carried, sum.crushed += c.crushed, sum.parted += c.parted, sum.slowed += c.slowed,
                sum.overlapping += c.overlapping;
        }
    }
    [[nodiscard]] std::array<std::size_t, 10> counts() const {
        return {sum.followed, sum.pairs,   sum.impacts, sum.clamped, sum.stopped,
                sum.carried,  sum.crushed, sum.parted,  sum.slowed,  sum.overlapping};
    }
    /// Bodies whose centre is behind some wall.
    [[nodiscard]] std::size_t outside() const {
        return static_cast<std::size_t>(std::count_if(bodies.begin(), bodies.end(), [&](BodyId body) {
            for (std::size_t k = 0; k < walls.size(); ++k) {
                const dvec3 p = inverse_transform_point(world.pose(walls[k]), world.center_of_mass(body));
                if ((k % 2 == 0 ? -1.0 : 1.0) * p[static_cast<int>(k / 2)] > 0.0) return true;
            }
            return false;
        }));
    }
};

constexpr WorldDef kNoGravity{.gravity = dvec3{0.0}};

TEST(FastCrowd, NobodyLeavesAHall) {
    for (const double slowest : {20.0, 50.0}) {
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            Hall hall(5, slowest, 12.0 * slowest, Walls::Stand, seed, kNoGravity);
            hall.run(12);
            EXPECT_EQ(hall.outside(), 0u) << "from " << slowest << " m/s, seed " << seed;
            EXPECT_GT(hall.sum.impacts, 500u);
        }
    }
}

// Of some hundred others in the way of each most are never asked for: an impact changes the way.
TEST(FastCrowd, MostTimesOfImpactAreNeverAskedFor) {
    Hall hall(7, 50.0, 600.0, Walls::Stand, 1, kNoGravity);
    hall.run(2);
    EXPECT_GT(hall.sum.impacts, 500u);
    EXPECT_LT(hall.sum.pairs, 8 * hall.sum.impacts);  // 7.06; of whom has another way since none is asked for
}

// Where little of all that there is moves fast, boxes are asked for and not who is where and when. Balls far away make it little.
TEST(FastCrowd, WhoIsWhereAndWhenTellsWhatBoxesTell) {
    for (const Walls how : {Walls::Stand, Walls::Move}) {
        Hall by_time(5, 50.0, 600.0, how, 11, kNoGravity), by_boxes(5, 50.0, 600.0, how, 11, kNoGravity);
        for (int i = 0; i < 1200; ++i) {
            const BodyId ball =
                by_boxes.world.create_body({.type = BodyType::Static, .position = {1000.0 + 2.0 * (i % 40), 2.0 * (i / 40), 0.0}});
            by_boxes.world.add_shape(ball, Sphere{0.5f});
        }
        by_time.run(6), by_boxes.run(6);
        for (std::size_t i = 0; i < by_time.bodies.size(); ++i) {
            const BodyId a = by_time.bodies[i], b = by_boxes.bodies[i];
            ASSERT_EQ(by_time.world.pose(a), by_boxes.world.pose(b)) << i;
            ASSERT_EQ(by_time.world.linear_velocity(a), by_boxes.world.linear_velocity(b)) << i;
        }
        EXPECT_EQ(by_time.sum.impacts, by_boxes.sum.impacts);
        EXPECT_NE(by_time.sum.pairs, by_boxes.sum.pairs) << "or else both were asked for the same";
    }
}

TEST(FastCrowd, HasTheSameBitsOnAnyNumberOfThreads) {
    ShuffledExecutor two(2), four(4);
    WorldDef few = kNoGravity;
    few.continuous.most_impacts = 4;  // some stop then, and are carried
    for (const Walls how : {Walls::Stand, Walls::Move}) {
        for (const double fastest : {60.0, 600.0}) {  // asked for boxes, and by who is where and when
            Hall alone(5, 0.1 * fastest, fastest, how, 7, few);
            alone.run(4);
            EXPECT_GT(alone.sum.impacts, 100u);
            EXPECT_TRUE(how == Walls::Stand || alone.sum.carried + alone.sum.stopped > 0 || fastest < 100.0);
            for (ShuffledExecutor* threads : {&two, &four}) {
                WorldDef def = few;
                def.executor = threads;
                Hall hall(5, 0.1 * fastest, fastest, how, 7, def);
                hall.run(4);
                EXPECT_EQ(hall.world.state_hash(), alone.world.state_hash())
                    << threads->thread_count() << " threads, up to " << fastest << " m/s";
                EXPECT_EQ(hall.counts(), alone.counts()) << threads->thread_count() << " threads, up to " << fastest << " m/s";
            }
        }
    }
}

// Hulls, meshes and compounds that fly as well: each thread searches among shapes that others search among, and hulls that are made are one thread's.
TEST(FastCrowd, OfAllShapesHasTheSameBitsOnAnyNumberOfThreads) {
    ShuffledExecutor three(3);
    const auto run = [](const WorldDef& def, ContinuousCounts& sum) {
        Hall hall(4, 20.0, 200.0, Walls::Move, 5, def);
        Random r(9);
        const std::vector<vec3> corners{{0, 0, 0}, {0.3f, 0, 0}, {0, 0.3f, 0}, {0, 0, 0.3f}};
        const auto mesh =
            TriangleMesh::build(corners, std::vector<TriangleMesh::Triangle>{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}).value();
        const Shape shapes[]{ConvexHull::build(corners).value(), mesh,
                             Compound::build({{Sphere{0.05f}, {{0.1, 0.0, 0.0}}}, {Box{vec3{0.05f}}, {}}}).value()};
        for (int i = 0; i < 18; ++i) {
            const BodyId body = hall.world.create_body({.position = 0.5 * dvec3{i % 3, i / 3 % 3, 3 * (i / 9)} - dvec3{0.28, 0.28, 0.53},
                                                        .linear_velocity = r.range(20.0, 200.0) * random_direction(r),
                                                        .angular_velocity = r.range(0.0, 100.0) * random_direction(r)});
            hall.world.add_shape(body, shapes[i % 3]);
        }
        hall.run(5);
        sum = hall.sum;
        return hall.world.state_hash();
    };
    ContinuousCounts alone, shared;
    WorldDef def = kNoGravity;
    const std::uint64_t expected = run(def, alone);
    def.executor = &three;
    EXPECT_EQ(run(def, shared), expected);
    EXPECT_EQ(shared.pairs, alone.pairs);
    EXPECT_EQ(shared.impacts, alone.impacts);
    EXPECT_GT(alone.impacts, 100u);
}

}  // namespace
}  // namespace carom
