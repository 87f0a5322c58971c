// The batch allocates nothing once it is warm, and outlives want of memory.
#include "box_crowd.hpp"
#include "oracle.hpp"

#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/executor.hpp>

#include <gtest/gtest.h>
#include <support/count_allocations.hpp>

#include <cstring>

namespace carom {
namespace {

using namespace test;

TEST(Allocation, NoneOnceWarm) {
    Random r(31);
    const std::vector<vec3> v = {{-4, 0, -4}, {-4, 0, 4}, {4, 0.5f, -4}, {4, 0, 4}};
    const std::vector<TriangleMesh::Triangle> t = {{0, 1, 3}, {0, 3, 2}};
    const std::vector<Shape> shapes = {Sphere{0.4f},
                                       Box{{0.4f, 0.3f, 0.5f}},
                                       Capsule{0.2f, 0.4f},
                                       Plane{},
                                       random_hull(r, 20, 0.3, 0.6),
                                       *TriangleMesh::build(v, t),
                                       Cylinder{0.4f, 0.3f},
                                       Cone{0.4f, 0.5f},
                                       *Compound::build({{Sphere{0.3f}, {{0.3, 0, 0}}}, {Box{}}, {Cylinder{}, {{0, 0, 0.4}}}})};
    std::vector<ShapePair> pairs;
    for (int i = 0; i < 40; ++i) {
        for (const Shape& a : shapes) {
            for (const Shape& b : shapes) {
                if (!can_collide(type_of(a), type_of(b))) continue;
                pairs.push_back(
                    {&a, &b, {random_direction(r) * 0.3, random_rotation(r)}, {random_direction(r) * 0.3, random_rotation(r)}, 0.02f});
            }
        }
    }
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> out;
    collide(pairs, executor, scratch, out);
    const std::size_t count = out.size();
    const long before = allocations();
    collide(pairs, executor, scratch, out);
    EXPECT_EQ(allocations() - before, 0);
    EXPECT_EQ(out.size(), count);
    EXPECT_GT(count, pairs.size() / 2);
}

// Manifolds wait for their place by blocks of pairs, so a batch takes little more for a pair than its manifold.
TEST(Allocation, ABatchHoldsNoMoreThanABlockOfItsPairs) {
    const Shape box = Box{vec3{0.5f}};
    const std::vector<const Shape*> shapes = {&box, &box};
    const std::vector<Pose> poses = {{}, {{0.1, 0.99, 0}, kIdentityRotation}};
    SerialExecutor executor;
    const auto held = [&](std::size_t count) {
        const std::vector<NumberedPair> pairs(count, NumberedPair{0, 1, 0.02f});
        std::vector<Manifold> out;
        out.reserve(count);
        const long before = bytes_held();
        CollideScratch scratch;
        collide(PlacedShapes{shapes, poses}, pairs, executor, scratch, out);
        EXPECT_EQ(out.size(), count);
        return bytes_held() - before;
    };
    const long few = held(4'000), many = held(20'000);
    EXPECT_LT(few, 64 * 4'000);
    EXPECT_LT(many - few, 4 * 16'000);
}

// What a thread keeps of a batch that ran out of memory has no part in the next.
TEST(Allocation, WantOfMemoryChangesNoLaterBatch) {
    BoxCrowd crowd(400);
    for (std::size_t i = 3; i < 400; i += 7) {  // on the side of the larger one, which is cut to their neighbourhood
        const double side = static_cast<double>(std::get<Box>(crowd.shapes[2 * i]).half_extents.x);
        crowd.poses[2 * i + 1] = crowd.poses[2 * i] * Pose{{side, 0.0, 0.0}, kIdentityRotation};
    }
    BoxCrowd later(100);  // of boxes of which none is unusual, where unusual ones were
    for (Shape& shape : later.shapes) shape = Box{{0.6f, 0.5f, 0.4f}};
    const std::vector<Manifold> expected = later.singles(100);
    SerialExecutor executor;
    long failed = 0;
    for (bool fails = true; fails; ++failed) {  // at each allocation in turn
        std::vector<Manifold> out;
        {
            CollideScratch scratch;
            fail_allocation(failed + 1);
            try {
                collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, out);
                fails = false;
            } catch (const std::bad_alloc&) {
            }
            g_fails_at = -1;
        }
        CollideScratch scratch;
        collide({later.placed, later.poses}, later.pairs, executor, scratch, out);
        ASSERT_EQ(out.size(), expected.size()) << failed;
        ASSERT_GT(out.size(), 40u);
        EXPECT_EQ(std::memcmp(out.data(), expected.data(), out.size() * sizeof(Manifold)), 0) << failed;
    }
    EXPECT_GT(failed, 4);
}

}  // namespace
}  // namespace carom
