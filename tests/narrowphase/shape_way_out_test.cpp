// Long shapes through the thin walls of meshes that bound no convex solid: what is said leads out, and about as short a way as there is.
#include "oracle.hpp"

#include <support/box_mesh.hpp>

#include <carom/collision/triangle_mesh.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

using namespace test;

constexpr float kWall = 0.03f;

/// A bin of walls, as one closed surface, and the boxes that fill the walls.
struct Bin {
    Shape surface;
    std::vector<Shape> walls;
    std::vector<ConvexHullPtr> hulls;

    explicit Bin(int open_sides) {
        const std::array<float, 4> x{-0.5f, -0.5f + kWall, 0.5f - kWall, 0.5f};
        const auto full = [&](int i, int j, int k) {
            if (std::min({i, j, k}) < 0 || std::max({i, j, k}) > 2) return false;
            const bool solid = i == 0 || j == 0 || k == 0 || (i == 2 && open_sides < 3) || (k == 2 && open_sides < 2);
            return solid && !(j == 2 && i == 1 && k == 1);
        };
        std::vector<vec3> vertices;
        for (int n = 0; n < 64; ++n) {
            vertices.push_back(
                {x[static_cast<std::size_t>(n / 16)], x[static_cast<std::size_t>(n / 4 % 4)], x[static_cast<std::size_t>(n % 4)]});
        }
        std::vector<TriangleMesh::Triangle> triangles;
        for (int n = 0; n < 27; ++n) {
            const std::array<int, 3> cell{n / 9, n / 3 % 3, n % 3};
            if (!full(cell[0], cell[1], cell[2])) continue;
            add_wall(vertices, cell);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                for (const int side : {0, 1}) {
                    std::array<int, 3> next = cell;
                    next[axis] += side == 0 ? -1 : 1;
                    if (!full(next[0], next[1], next[2])) add_side(cell, axis, side, triangles);
                }
            }
        }
        surface = *TriangleMesh::build(vertices, triangles);
    }

private:
    static std::uint32_t number(const std::array<int, 3>& c) { return static_cast<std::uint32_t>(16 * c[0] + 4 * c[1] + c[2]); }

    void add_wall(const std::vector<vec3>& vertices, const std::array<int, 3>& cell) {
        std::vector<vec3> corners;
        for (int n = 0; n < 8; ++n) corners.push_back(vertices[number({cell[0] + (n & 1), cell[1] + (n >> 1 & 1), cell[2] + (n >> 2)})]);
        hulls.push_back(hull_of(corners));
        walls.push_back(hulls.back());
    }

    static void add_side(const std::array<int, 3>& cell, std::size_t axis, int side, std::vector<TriangleMesh::Triangle>& triangles) {
        std::array<std::array<int, 3>, 4> q{cell, cell, cell, cell};
        for (auto& c : q) c[axis] += side;
        const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
        ++q[1][u], ++q[2][u], ++q[2][w], ++q[3][w];
        if (side == 0) std::swap(q[1], q[3]);
        triangles.push_back({number(q[0]), number(q[1]), number(q[2])});
        triangles.push_back({number(q[0]), number(q[2]), number(q[3])});
    }
};

/// How deep the shape, moved by `motion`, is in the wall in which it is deepest, by the kernels for convex shapes.
double deepest_in(const Bin& bin, const Shape& shape, Pose at, const dvec3& motion) {
    at.position += motion;
    double deepest = 0.0;
    for (const Shape& wall : bin.walls) {
        for (const Manifold& m : collide_all(shape, at, wall, {}, 0.0f))
            deepest = std::max(deepest, -static_cast<double>(least_separation(m)));
    }
    return deepest;
}

dvec3 motion_of(const std::vector<Manifold>& manifolds) {
    dvec3 motion{0.0};
    for (int round = 0; round < 32; ++round) {
        for (const Manifold& m : manifolds) {
            const double left = static_cast<double>(least_separation(m)) - 1e-6 - glm::dot(motion, dvec3(m.normal));
            if (left < 0.0) motion += left * dvec3(m.normal);
        }
    }
    return motion;
}

/// Plain search: along each of many directions, how far the shape has to go until it is free of all walls, by all separating axes.
class Exits {
public:
    Exits(const Solid& shape, const Bin& bin, const dvec3& origin) {
        for (const ConvexHullPtr& hull : bin.hulls) {
            const Solid wall = solid_of(*hull, {}, origin);
            std::vector<Axis>& of_wall = axes_.emplace_back();
            const auto add = [&](const RealVec& n) { of_wall.push_back({n, gap_along(shape, wall, n)}); };
            for (const RealVec& n : shape.normals) add(n);
            for (const RealVec& n : wall.normals) add(-n);
            for (const RealVec& e : shape.edges) {
                for (const RealVec& f : wall.edges) {
                    const RealVec n = glm::cross(e, f);
                    if (!(length_of(n) > Real(1e-9))) continue;
                    add(n / length_of(n));
                    add(-n / length_of(n));
                }
            }
        }
    }

    [[nodiscard]] double along(const RealVec& way) const {
        std::vector<std::array<Real, 2>> meeting;
        for (const std::vector<Axis>& of_wall : axes_) {
            Real from = -oracle::kInfinite, to = oracle::kInfinite;
            for (const Axis& axis : of_wall) {
                const Real rate = glm::dot(axis.normal, way);  // the gap shrinks by it
                if (std::abs(rate) < Real(1e-12)) {
                    if (axis.gap >= 0) to = from;
                } else if (rate > 0) {
                    from = std::max(from, axis.gap / rate);
                } else {
                    to = std::min(to, axis.gap / rate);
                }
            }
            if (from < to && to > 0) meeting.push_back({from, to});
        }
        std::ranges::sort(meeting);
        Real length = 0;
        for (const auto& [from, to] : meeting) {
            if (from > length) break;
            length = std::max(length, to);
        }
        return static_cast<double>(length);
    }

    [[nodiscard]] double least(Random& r) const {
        double least = 1e9;
        for (const std::vector<Axis>& of_wall : axes_) {
            for (const Axis& axis : of_wall) least = std::min(least, along(axis.normal));
        }
        for (int i = 0; i < 100; ++i) least = std::min(least, along(real(random_direction(r))));
        return least;
    }

private:
    struct Axis {
        RealVec normal;
        Real gap = 0;
    };
    std::vector<std::vector<Axis>> axes_;
};

Shape rod_of(int kind, float half) {
    switch (kind) {
        case 0:
            return Box{{0.015f, half, 0.015f}};
        case 1:
            return Capsule{0.015f, half};
        case 2:
            return Cylinder{0.015f, half};
        case 3:
            return Cone{0.03f, half};
        default:
            return hull_of(corners_of(Box{{0.02f, half, 0.0125f}}));
    }
}

struct Found {
    int met = 0, held = 0, held_unsaid = 0;
};

// What is said leads out of all walls, to 2 mm, or is said to be undecided.
TEST(ShapeWayOut, RodsThroughWallsAreLedOut) {
    for (int kind = 0; kind < 5; ++kind) {
        Found found;
        for (const int open : {1, 2, 3}) {
            const Bin bin(open);
            Random r(1300 + static_cast<std::uint64_t>(10 * kind + open));
            for (int i = 0; i < 200; ++i) {
                const Shape rod = rod_of(kind, i % 2 == 0 ? 0.15f : 0.5f);
                const Pose at{{r.range(-0.6, 0.6), r.range(-0.6, 0.6), r.range(-0.6, 0.6)}, random_rotation(r)};
                if (deepest_in(bin, rod, at, dvec3{0.0}) < 1e-4) continue;
                ++found.met;
                std::vector<Manifold> m;
                const CollideStatus status = collide({&rod, &bin.surface, at, {}, 0.0f}, 0, m);
                ASSERT_FALSE(m.empty()) << kind << " " << i;
                for (const Manifold& x : m) ASSERT_NEAR(glm::length(dvec3(x.normal)), 1.0, 1e-6);
                const bool held = deepest_in(bin, rod, at, motion_of(m)) > 2e-3;
                found.held += held;
                found.held_unsaid += held && status == CollideStatus::Ok;
            }
        }
        RecordProperty("held_" + std::to_string(kind), found.held);
        EXPECT_GT(found.met, 250) << kind;
        EXPECT_LT(found.held, found.met * 8 / 100) << kind << ": a fifth to two fifths where each triangle speaks for itself";
        EXPECT_LE(found.held_unsaid, found.met / 100) << kind << ": all of them";
    }
}

// By 4 mm in the mean, and of none of 20 by more than 5 cm, 42 mm and one in six where each triangle speaks for itself.
TEST(ShapeWayOut, TheWayIsAboutAsShortAsThereIs) {
    double excess = 0.0;
    int met = 0, longer = 0;
    for (const int open : {1, 2, 3}) {
        const Bin bin(open);
        Random r(1350 + static_cast<std::uint64_t>(open));
        for (int i = 0; i < 40; ++i) {
            const Shape rod = rod_of(0, 0.5f);
            const Pose at{{r.range(-0.6, 0.6), r.range(-0.6, 0.6), r.range(-0.6, 0.6)}, random_rotation(r)};
            const Exits exits(solid_of(std::get<Box>(rod), at, at.position), bin, at.position);
            const double least = exits.least(r);
            if (least < 1e-4) continue;
            std::vector<Manifold> m;
            if (collide({&rod, &bin.surface, at, {}, 0.0f}, 0, m) != CollideStatus::Ok) continue;
            const double more = glm::length(motion_of(m)) - least;
            ++met;
            excess += std::max(0.0, more);
            longer += more > 0.05;
        }
    }
    RecordProperty("mean_um", static_cast<int>(1e6 * excess / met));
    RecordProperty("longer", longer);
    EXPECT_GT(met, 60);
    EXPECT_LT(excess / met, 0.01);
    EXPECT_LT(longer, met / 20);
}

// A pole on the floor of a closed room, a hair too long for it, has a short way out through the floor, which is none for what is inside.
TEST(ShapeWayOut, WhatIsWedgedInARoomIsNotLedThroughTheFloor) {
    const TriangleMeshPtr room = box_mesh({2.0f, 2.0f, 2.0f}, 2), beside = box_mesh({0.1f, 0.1f, 0.1f}, 1);
    std::vector<vec3> vertices(room->vertices().begin(), room->vertices().end());
    std::vector<TriangleMesh::Triangle> triangles(room->triangles().begin(), room->triangles().end());
    const auto base = static_cast<std::uint32_t>(vertices.size());
    for (const vec3& v : beside->vertices()) vertices.push_back(v + vec3{5.0f, 0.0f, 0.0f});
    for (const TriangleMesh::Triangle& t : beside->triangles()) triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    const TriangleMeshPtr house = *TriangleMesh::build(vertices, triangles);
    ASSERT_EQ(house->solid(), nullptr);
    for (const float half : {2.001f, 2.02f}) {
        const Shape pole = Box{{half, 0.05f, 0.05f}}, surface = house;
        bool stands = false;
        for (const Manifold& m : collide_all(pole, {{0.0, -1.96, 0.0}}, surface, {}, 0.01f)) {
            EXPECT_LT(m.normal.y, 0.5f) << half;
            stands |= m.normal.y < -0.5f;
        }
        EXPECT_TRUE(stands) << half;
    }
}

// A closed room with walls of 0.1 m, outward and inward faces: from its inside there are short ways through the walls.
TEST(ShapeWayOut, WhatIsDeepInTheWallsOfARoomStaysInTheRoom) {
    const TriangleMeshPtr outer = box_mesh({1.1f, 1.1f, 1.1f}, 2), inner = box_mesh({1.0f, 1.0f, 1.0f}, 2);
    std::vector<vec3> vertices(outer->vertices().begin(), outer->vertices().end());
    std::vector<TriangleMesh::Triangle> triangles(outer->triangles().begin(), outer->triangles().end());
    const auto base = static_cast<std::uint32_t>(vertices.size());
    for (const vec3& v : inner->vertices()) vertices.push_back(v);
    for (const TriangleMesh::Triangle& t : inner->triangles()) triangles.push_back({t[0] + base, t[2] + base, t[1] + base});
    const Shape room = *TriangleMesh::build(vertices, triangles), crate = Box{{0.3f, 0.2f, 0.25f}};
    Random r(1400);
    int deep = 0, out = 0;
    for (int i = 0; i < 2000; ++i) {
        const Pose at{{r.range(-0.99, 0.99), r.range(-0.99, 0.99), r.range(-0.99, 0.99)}, random_rotation(r)};
        const dvec3 to = at.position + motion_of(collide_all(crate, at, room, {}, 0.0f));
        if (glm::length(to - at.position) < 0.05) continue;
        ++deep;
        out += std::max({std::abs(to.x), std::abs(to.y), std::abs(to.z)}) > 1.0 ? 1 : 0;
    }
    RecordProperty("out", out);
    EXPECT_GT(deep, 800);
    EXPECT_LE(out, deep / 100);
}

}  // namespace
}  // namespace carom
