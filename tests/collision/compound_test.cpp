// Compounds: what is refused, bounds, mass, the hierarchy and rays, each against the parts one by one.
#include "support/random_pose.hpp"

#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mass_properties.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace carom {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

std::vector<CompoundPart> random_parts(Random& r, int count, double spread) {
    const std::vector<vec3> corners{{0, 0, 0}, {0.3f, 0, 0}, {0, 0.4f, 0}, {0, 0, 0.5f}};
    const Shape hull = *ConvexHull::build(corners);
    std::vector<CompoundPart> parts;
    for (int i = 0; i < count; ++i) {
        const auto size = [&] { return static_cast<float>(r.range(0.05, 0.3)); };
        const Shape shapes[] = {Sphere{size()}, Box{{size(), size(), size()}}, Capsule{size(), size()}, Cylinder{size(), size()},
                                Cone{size(), size()}, hull};
        CompoundPart& part = parts.emplace_back(CompoundPart{shapes[i % 6], {test::random_direction(r) * r.range(0, spread), test::random_rotation(r)}});
        if (i % 3 == 0) part.material.density = r.range(100, 9000);
    }
    return parts;
}

ErrorCode refused(std::vector<CompoundPart> parts) {
    const Result<CompoundPtr> made = Compound::build(std::move(parts));
    EXPECT_FALSE(made.has_value());
    if (made) return ErrorCode::Io;
    EXPECT_FALSE(made.error().message.empty());
    return made.error().code;
}

TEST(Compound, RefusesWhatIsNoPart) {
    const std::vector<vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}};
    const Shape mesh = *TriangleMesh::build(corners, triangles);
    const Shape ball = *Compound::build({{Sphere{}}});
    EXPECT_EQ(refused({}), ErrorCode::Empty);
    EXPECT_EQ(refused({{mesh}}), ErrorCode::WrongType);
    EXPECT_EQ(refused({{Sphere{}}, {Plane{}}}), ErrorCode::WrongType);
    EXPECT_EQ(refused({{ball}}), ErrorCode::WrongType);
    EXPECT_EQ(refused({{ConvexHullPtr{}}}), ErrorCode::Empty);
    EXPECT_EQ(refused({{Sphere{-1.0f}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{kNanF}}}), ErrorCode::NotFinite);
    EXPECT_EQ(refused({{Cylinder{1, 1e-6f}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {{0, kNan, 0}}}}), ErrorCode::NotFinite);
    EXPECT_EQ(refused({{Sphere{}, {{0, 0, 0}, {2, 0, 0, 0}}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {{0, 0, 0}, {0, 0, 0, 0}}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {{1e16, 0, 0}}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{1e16f}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {}, {.density = 0.0}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {}, {.density = kNan}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {}, {.friction = -1.0f}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {}, {.friction = kNanF}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {}, {.restitution = 1.1f}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused({{Sphere{}, {}, {.restitution = kNanF}}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(refused(std::vector<CompoundPart>(Compound::kMaxParts + 1, {Sphere{}})), ErrorCode::InvalidArgument);
    const Result<CompoundPtr> second = Compound::build({{Sphere{}}, {Sphere{0.0f}}});
    EXPECT_NE(second.error().where.find("part 1"), std::string::npos);
    EXPECT_EQ(validate(Shape{CompoundPtr{}}).error().code, ErrorCode::Empty);
    EXPECT_STREQ(to_string(ShapeType::Compound), "compound");
}

TEST(Compound, BoundsAreThoseOfTheParts) {
    Random r(51);
    for (int i = 0; i < 100; ++i) {
        const std::vector<CompoundPart> parts = random_parts(r, 1 + i, 3.0);
        const Shape shape = *Compound::build(parts);
        const Pose pose{test::random_direction(r) * 50.0, test::random_rotation(r)};
        Aabb all;
        double farthest = 0.0, thinnest = std::numeric_limits<double>::infinity();
        for (const CompoundPart& part : parts) {
            all = merge(all, bounds(part.shape, pose * part.pose));
            farthest = std::max(farthest, glm::length(part.pose.position) + bounding_radius(part.shape));
            thinnest = std::min(thinnest, smallest_extent(part.shape));
        }
        const Aabb box = bounds(shape, pose);
        for (int k = 0; k < 3; ++k) {
            EXPECT_LE(box.lower[k], all.lower[k]);
            EXPECT_GE(box.upper[k], all.upper[k]);
            EXPECT_NEAR(box.lower[k], all.lower[k], 1e-12);
            EXPECT_NEAR(box.upper[k], all.upper[k], 1e-12);
        }
        // A point through both poses one after the other is in it too, to the last bit.
        for (const CompoundPart& part : parts) {
            if (const Box* b = std::get_if<Box>(&part.shape)) {
                const dvec3 p = transform_point(pose, transform_point(part.pose, dvec3(b->half_extents)));
                EXPECT_TRUE(glm::all(glm::lessThanEqual(box.lower, p)) && glm::all(glm::lessThanEqual(p, box.upper)));
            }
        }
        EXPECT_GE(bounding_radius(shape), farthest);
        EXPECT_NEAR(bounding_radius(shape), farthest, 1e-12 * farthest);
        EXPECT_EQ(smallest_extent(shape), thinnest);
    }
}

TEST(Compound, MassIsTheSumOfItsPartsAtTheirOwnDensities) {
    Random r(52);
    const std::vector<CompoundPart> parts = random_parts(r, 20, 2.0);
    std::vector<MassProperties> each;
    for (const CompoundPart& part : parts) {
        each.push_back(transform(*mass_properties(part.shape, part.material.density.value_or(700.0)), part.pose));
    }
    const MassProperties sum = combine(each);
    const Result<MassProperties> whole = mass_properties(*Compound::build(parts), 700.0);
    ASSERT_TRUE(whole.has_value());
    EXPECT_NEAR(whole->mass, sum.mass, 1e-12 * sum.mass);
    EXPECT_LT(glm::length(whole->center - sum.center), 1e-12);
    for (int k = 0; k < 3; ++k) EXPECT_LT(glm::length(whole->inertia[k] - sum.inertia[k]), 1e-9 * sum.inertia[k][k]);
    EXPECT_FALSE(mass_properties(*Compound::build(parts), -1.0).has_value());
    // Two unit cubes side by side are a box of twice the length.
    const Result<MassProperties> pair =
        mass_properties(*Compound::build({{Box{{0.5f, 0.5f, 0.5f}}, {{-0.5, 0, 0}}}, {Box{{0.5f, 0.5f, 0.5f}}, {{0.5, 0, 0}}}}), 10.0);
    const Result<MassProperties> box = mass_properties(Box{{1, 0.5f, 0.5f}}, 10.0);
    EXPECT_NEAR(pair->mass, box->mass, 1e-12);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(pair->inertia[k][k], box->inertia[k][k], 1e-12);
}

TEST(Compound, OverlapFindsThePartsThatBruteForceFindsInOneOrder) {
    Random r(53);
    for (const int count : {1, 2, 6, 40, 700}) {
        const CompoundPtr compound = *Compound::build(random_parts(r, count, 4.0));
        const CompoundPtr again = *Compound::build({compound->parts().begin(), compound->parts().end()});
        int found = 0;
        for (int i = 0; i < 60; ++i) {
            const dvec3 lower = test::random_direction(r) * r.range(0.0, 4.0);
            const Aabb box{lower, lower + dvec3{r.range(0.0, 2.0), r.range(0.0, 2.0), r.range(0.0, 2.0)}};
            std::vector<std::uint32_t> parts, twice;
            compound->overlap(box, [&](std::uint32_t p) { return parts.push_back(p), true; });
            again->overlap(box, [&](std::uint32_t p) { return twice.push_back(p), true; });
            EXPECT_EQ(parts, twice);
            std::set<std::uint32_t> brute;
            for (std::uint32_t p = 0; p < compound->parts().size(); ++p) {
                if (overlaps(bounds(compound->parts()[p].shape, compound->parts()[p].pose), box)) brute.insert(p);
            }
            EXPECT_EQ(std::set<std::uint32_t>(parts.begin(), parts.end()), brute);
            EXPECT_EQ(parts.size(), brute.size()) << "a part comes once";
            found += static_cast<int>(brute.size());
            int visited = 0;
            compound->overlap(box, [&](std::uint32_t) { return ++visited < 1; });
            EXPECT_LE(visited, 1);
        }
        EXPECT_GT(found + (count < 6 ? 1 : 0), 0);
        Aabb root;
        int nodes = 0;
        compound->visit_nodes([&](const Aabb& box, int depth) {
            if (depth == 0) root = box;
            EXPECT_TRUE(overlaps(root, box));
            ++nodes;
        });
        EXPECT_EQ(root, compound->local_bounds());
        EXPECT_LT(nodes, 2 * count);
    }
}

TEST(Compound, RaysHitTheFirstPartAndNameIt) {
    Random r(54);
    int hits = 0, inside = 0;
    for (int i = 0; i < 3000; ++i) {
        static CompoundPtr compound;
        if (i % 100 == 0) compound = *Compound::build(random_parts(r, 1 + i / 20, 3.0));
        const Pose pose{test::random_direction(r) * 5.0, test::random_rotation(r)};
        const Ray ray{pose.position + test::random_direction(r) * r.range(0.0, 6.0), test::random_direction(r), r.range(1.0, 20.0)};
        std::optional<RayHit> best;
        for (std::uint32_t p = 0; p < compound->parts().size(); ++p) {
            const CompoundPart& part = compound->parts()[p];
            std::optional<RayHit> hit = cast_ray(part.shape, pose * part.pose, ray);
            if (hit && (!best || hit->distance < best->distance)) {
                hit->part = p;
                best = hit;
            }
        }
        const std::optional<RayHit> hit = cast_ray(Shape{compound}, pose, ray);
        ASSERT_EQ(hit.has_value(), best.has_value()) << i;
        if (!hit) continue;
        ++hits;
        inside += hit->distance == 0.0;
        ASSERT_NEAR(hit->distance, best->distance, 1e-10);
        ASSERT_EQ(hit->part, best->part);
        ASSERT_LT(glm::length(hit->point - best->point), 1e-10);
        ASSERT_LT(glm::length(hit->normal - best->normal), 1e-7);
    }
    EXPECT_GT(hits, 300);
    EXPECT_GT(inside, 3);
    const Shape one = *Compound::build({{Sphere{1.0f}}});
    EXPECT_FALSE(cast_ray(one, {{kNan, 0, 0}, {1, 0, 0}}).has_value());
    EXPECT_FALSE(cast_ray(one, {{-5, 0, 0}, {1, 0, 0}, 3.9}).has_value());
    EXPECT_FALSE(cast_ray(Shape{CompoundPtr{}}, {{-5, 0, 0}, {1, 0, 0}}).has_value());
}

}  // namespace
}  // namespace carom
