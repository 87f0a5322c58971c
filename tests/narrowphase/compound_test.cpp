// A compound against everything: the manifolds are those of its parts, each placed by itself.
#include "oracle.hpp"
#include "support/grid_mesh.hpp"

#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <gtest/gtest.h>

#include <set>

namespace carom {
namespace {

using namespace test;

Shape random_part(Random& r, int i) {
    const auto size = [&](double low, double high) { return static_cast<float>(r.range(low, high)); };
    switch (i % 6) {
        case 0: return Sphere{size(0.1, 0.3)};
        case 1: return Box{{size(0.1, 0.3), size(0.1, 0.3), size(0.1, 0.3)}};
        case 2: return Capsule{size(0.1, 0.2), size(0.1, 0.3)};
        case 3: return Cylinder{size(0.1, 0.3), size(0.1, 0.3)};
        case 4: return Cone{size(0.1, 0.3), size(0.1, 0.3)};
        default: return random_hull(r, 10, 0.2, 0.3);
    }
}

CompoundPtr random_compound(Random& r, int parts, double spread) {
    std::vector<CompoundPart> list;
    for (int i = 0; i < parts; ++i) list.push_back({random_part(r, i), {random_direction(r) * r.range(0.0, spread), random_rotation(r)}});
    return *Compound::build(std::move(list));
}

TriangleMeshPtr hilly_mesh(Random& r) {
    return grid_mesh(9, [&](float i, float j) { return vec3{0.5f * i - 2.0f, static_cast<float>(r.range(-0.2, 0.2)), 0.5f * j - 2.0f}; });
}

struct Piece {
    Shape shape;
    Pose pose;
    std::uint16_t part = 0;
};

std::vector<Piece> pieces_of(const Shape& shape, const Pose& pose) {
    std::vector<Piece> pieces;
    if (const CompoundPtr* compound = std::get_if<CompoundPtr>(&shape)) {
        std::uint16_t index = 0;
        for (const CompoundPart& part : (*compound)->parts()) pieces.push_back({part.shape, pose * part.pose, index++});
    } else {
        pieces.push_back({shape, pose, 0});
    }
    return pieces;
}

// Those that are not so near to touching that rounding decides.
std::vector<Manifold> decided(const std::vector<Manifold>& all) {
    std::vector<Manifold> out;
    for (const Manifold& m : all) {
        if (least_separation(m) < -1e-5f) out.push_back(m);
    }
    return out;
}

const Manifold* twin_of(const Manifold& m, const std::vector<Manifold>& list) {
    for (const Manifold& c : list) {
        if (c.part_a == m.part_a && c.part_b == m.part_b && glm::length(c.normal - m.normal) < 1e-3f &&
            std::abs(least_separation(c) - least_separation(m)) < 1e-5f) {
            return &c;
        }
    }
    return nullptr;
}

void expect_the_sum_of_parts(const Shape& a, const Pose& pa, const Shape& b, const Pose& pb, int& contacts) {
    std::vector<Manifold> brute;
    for (const Piece& x : pieces_of(a, pa)) {
        for (const Piece& y : pieces_of(b, pb)) {
            for (Manifold m : collide_all(x.shape, x.pose, y.shape, y.pose, 0.0f)) {
                for (ContactPoint& p : m.points) p.position += vec3(x.pose.position - pa.position);
                m.part_a = x.part;
                m.part_b = y.part;
                brute.push_back(m);
            }
        }
    }
    const std::vector<Manifold> made = collide_all(a, pa, b, pb, 0.0f);
    ASSERT_EQ(decided(made).size(), decided(brute).size());
    for (const Manifold& m : decided(brute)) {
        const Manifold* twin = twin_of(m, made);
        ASSERT_NE(twin, nullptr) << m.part_a << " " << m.part_b << " " << least_separation(m);
        ++contacts;
        ASSERT_EQ(twin->pair, 7u);
        // Which points of a region are chosen may differ, where it is does not.
        float nearest = 1.0f;
        for (const ContactPoint& p : twin->used()) {
            for (const ContactPoint& q : m.used()) nearest = std::min(nearest, glm::length(p.position - q.position));
        }
        ASSERT_LT(nearest, 0.05f);
    }
}

TEST(CompoundPairs, AreThePairsOfTheirParts) {
    Random r(2025);
    int contacts[9] = {};
    for (int i = 0; i < 450; ++i) {
        SCOPED_TRACE(i);
        const int kind = i % 9;
        const Shape compound = random_compound(r, 1 + i % 11, 0.8);
        const Shape others[] = {Sphere{0.4f},
                                Box{{0.4f, 0.3f, 0.5f}},
                                Capsule{0.2f, 0.4f},
                                Plane{{0, 1, 0}, 0.0f},
                                random_hull(r, 14, 0.4, 0.6),
                                hilly_mesh(r),
                                Cylinder{0.4f, 0.3f},
                                Cone{0.5f, 0.4f},
                                random_compound(r, 7, 0.8)};
        const Pose pa{random_direction(r) * r.range(0.0, 1.2), random_rotation(r)};
        const Pose pb{{0, 0, 0}, kind == 3 || kind == 5 ? kIdentityRotation : random_rotation(r)};
        expect_the_sum_of_parts(compound, pa, others[kind], pb, contacts[kind]);
        expect_the_sum_of_parts(others[kind], pb, compound, pa, contacts[kind]);
        if (HasFatalFailure()) return;
    }
    for (const int count : contacts) EXPECT_GT(count, 30);
}

TEST(CompoundPairs, EveryPartIsNamedAndEveryPointHasANameOfItsOwn) {
    std::vector<CompoundPart> legs;
    for (int i = 0; i < 4; ++i) legs.push_back({Cylinder{0.1f, 0.5f}, {{i & 1 ? 1.0 : -1.0, 0.0, i & 2 ? 1.0 : -1.0}}});
    const Shape table = *Compound::build(legs), floor = Plane{};
    const std::vector<Manifold> m = collide_all(table, {{0, 0.499, 0}}, floor, {}, 0.01f);
    ASSERT_EQ(m.size(), 4u);
    std::set<int> parts;
    std::set<std::uint64_t> features;
    for (const Manifold& x : m) {
        parts.insert(x.part_a);
        EXPECT_EQ(x.part_b, 0);
        EXPECT_EQ(x.count, 4u);
        for (const ContactPoint& p : x.used()) features.insert(p.feature);
    }
    EXPECT_EQ(parts, (std::set<int>{0, 1, 2, 3}));
    EXPECT_EQ(features.size(), 16u);
    // The same names a step later, and the part is on the other side where the shapes are.
    for (const Manifold& x : collide_all(floor, {}, table, {{0, 0.4989, 0}}, 0.01f)) {
        EXPECT_EQ(x.part_a, 0);
        EXPECT_TRUE(parts.contains(x.part_b));
    }
    const std::vector<Manifold> again = collide_all(table, {{1e-6, 0.4989, 0}}, floor, {}, 0.01f);
    for (const Manifold& x : again) {
        for (const ContactPoint& p : x.used()) EXPECT_TRUE(features.contains(p.feature));
    }
}

}  // namespace
}  // namespace carom
