// The group `sweeps`: its peers are asked what Carom is asked and answer in the same times, and what is proved of a pair judges all alike.
#include <carom/bench/bullet_convex.hpp>
#include <carom/bench/fcl_convex.hpp>
#include <carom/bench/random_shapes.hpp>
#include <carom/bench/sweeps_group.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>

namespace carom::bench {
namespace {

struct Said {
    bool met = false;
    double t = 1.0;
};
using Ask = Said (*)(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b);

Said by_fcl(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b) {
    const FclImpact said = FclConvex(a).time_of_impact(FclConvex(b), FclMotion(motion_a), FclMotion(motion_b));
    EXPECT_FALSE(said.threw);
    return {said.met, said.t};
}
Said by_bullet(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b) {
    const BulletImpact said = BulletConvex(a).time_of_impact(BulletConvex(b), BulletMotion(motion_a), BulletMotion(motion_b));
    return {said.met, said.t};
}
Said by_bullets_cast(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b) {
    const BulletImpact said = BulletConvex(a).cast(BulletConvex(b), BulletMotion(motion_a), BulletMotion(motion_b));
    return {said.met, said.t};
}

class EachSweepPeer : public testing::TestWithParam<Ask> {};
INSTANTIATE_TEST_SUITE_P(All, EachSweepPeer, testing::Values(by_fcl, by_bullet, by_bullets_cast), [](const auto& made) {
    return std::string(made.index == 0 ? "fcl" : made.index == 1 ? "bullet" : "bullets_cast");
});

constexpr double kNear = 2e-3;  // of the motion: what the peers' own tolerances leave

TEST_P(EachSweepPeer, AnswerInFractionsOfTheMotion) {
    const Shape cube = Box{vec3{0.5f}}, ball = Sphere{0.5f};
    const RigidMotion here{.start = {{-4, 0.2, 0.1}}, .translation = {6, 0, 0}}, stands{};
    const Said cubes = GetParam()(cube, here, cube, stands);
    EXPECT_TRUE(cubes.met);
    EXPECT_NEAR(cubes.t, 0.5, kNear);
    const Said balls = GetParam()(ball, {.start = {{-4, 0, 0}}, .translation = {6, 0, 0}}, ball, {.translation = {-6, 0, 0}});
    EXPECT_TRUE(balls.met);
    EXPECT_NEAR(balls.t, 0.25, kNear) << "B comes as well";
    const Pose turned{{-4, 0.2, 0.1}, rotation_about({0, 0, 1}, std::numbers::pi / 4)};
    const Said edge = GetParam()(cube, {.start = turned, .translation = {6, 0, 0}}, cube, stands);
    EXPECT_TRUE(edge.met);
    EXPECT_NEAR(edge.t, (3.5 - std::sqrt(0.5)) / 6.0, kNear) << "orientations at the start count";
}

TEST_P(EachSweepPeer, PassByWhatIsOutOfTheWay) {
    const Shape cube = Box{vec3{0.5f}};
    EXPECT_FALSE(GetParam()(cube, {.start = {{-4, 1.1, 0}}, .translation = {8, 0, 0}}, cube, {}).met);
    EXPECT_FALSE(GetParam()(cube, {.start = {{-4, 0, 0}}, .translation = {2.5, 0, 0}}, cube, {}).met) << "it ends before";
}

// Bars and cubes that come to each other head on and turn. Bullet's cast keeps the orientations at the start, and what FCL 0.7 says of what turns depends on what
// the process asked before (after the group's row balls/moving it finds none of these, before it all): it is judged by the group alone.
TEST(SweepPeers, BulletFollowsTurnsAndMeetsAtCaromsTime) {
    const Shape bar = Box{{0.2f, 1.0f, 0.3f}}, cube = Box{vec3{0.3f}};
    Random random(5);
    int alike = 0, turned = 0;
    for (int i = 0; i < 100; ++i) {
        const dvec3 way = direction_of(random);
        RigidMotion a{.start = {-4.0 * way, rotation_of(random)}, .translation = 5.0 * way};
        const Impact straight = time_of_impact(bar, a, cube, {});
        a.rotation = 0.7 * direction_of(random);
        const RigidMotion b{
            .start = {dvec3{0.0}, rotation_of(random)}, .translation = 0.1 * direction_of(random), .rotation = 0.3 * direction_of(random)};
        const Impact ours = time_of_impact(bar, a, cube, b);
        ASSERT_EQ(ours.status, ImpactStatus::Touching) << i;
        const Said said = by_bullet(bar, a, cube, b);
        EXPECT_TRUE(said.met) << i;
        alike += std::abs(said.t - ours.t) < 0.005;
        turned += std::abs(straight.t - ours.t) > 0.02;
    }
    EXPECT_GE(alike, 95);
    EXPECT_GE(turned, 40) << "or else turning is not tested";
}

double quality_of(const Quality& quality, const std::string& name) {
    for (const auto& [key, value] : quality) {
        if (key == name) return value;
    }
    ADD_FAILURE() << "no " << name;
    return -1.0;
}

TEST(SweepsGroup, JudgesCaromAndAPeerByWhatIsProved) {
    std::FILE* const table = std::tmpfile();
    const Result<std::vector<Row>> rows = run_sweeps_group({.filter = "balls/moving", .table = table});
    const long written = std::ftell(table);
    std::fclose(table);
    ASSERT_TRUE(rows) << rows.error().message;
    ASSERT_EQ(rows->size(), 2u);
    EXPECT_EQ((*rows)[0].peer, "fcl");
    EXPECT_EQ((*rows)[1].peer, "bullet");
    EXPECT_GT(written, 100) << "rows are printed as they are done";
    for (const Row& row : *rows) {
        EXPECT_EQ(row.bench, "balls/moving");
        EXPECT_FALSE(row.peer_version.empty());
        EXPECT_GT(row.carom_ms, 0.0);
        EXPECT_GT(row.peer_ms, 0.0);
        for (const char* fault : {"missed", "late", "made_up", "no_answer"}) EXPECT_EQ(quality_of(row.carom_quality, fault), 0.0) << fault;
        EXPECT_LT(quality_of(row.carom_quality, "early"), 1e-6);
        EXPECT_GE(quality_of(row.peer_quality, "missed"), 0.0);
    }
}

TEST(SweepsGroup, FiltersByBenchAndPeer) {
    const Result<std::vector<Row>> none = run_sweeps_group({.filter = "balls/turning", .table = stderr});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::UnknownName);
    EXPECT_NE(none.error().message.find("balls/turning"), std::string::npos);
}

}  // namespace
}  // namespace carom::bench
