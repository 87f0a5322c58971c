// Every pair of types: the table, swapping, moving, odd cases, misuse, and the batch.
#include "oracle.hpp"

#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <thread>

namespace carom {
namespace {

using namespace test;

constexpr int kTypes = kShapeTypeCount;

Shape sample(ShapeType type, Random& r) {
    const auto size = [&](double low, double high) { return static_cast<float>(r.range(low, high)); };
    switch (type) {
        case ShapeType::Sphere: return Sphere{size(0.2, 0.6)};
        case ShapeType::Capsule: return Capsule{size(0.1, 0.3), size(0.1, 0.6)};
        case ShapeType::Box: return Box{{size(0.2, 0.7), size(0.2, 0.7), size(0.2, 0.7)}};
        case ShapeType::Plane: return Plane{vec3(random_direction(r)), size(-0.2, 0.2)};
        case ShapeType::ConvexHull: return random_hull(r, 12, 0.3, 0.7);
        case ShapeType::Cylinder: return Cylinder{size(0.2, 0.6), size(0.1, 0.6)};
        case ShapeType::Cone: return Cone{size(0.2, 0.6), size(0.2, 0.6)};
        case ShapeType::Compound: {
            std::vector<CompoundPart> parts;
            for (const ShapeType part : {ShapeType::Sphere, ShapeType::Box, ShapeType::Cylinder, ShapeType::ConvexHull, ShapeType::Cone,
                                         ShapeType::Capsule, ShapeType::Box}) {
                parts.push_back({sample(part, r), {random_direction(r) * r.range(0.0, 0.5), random_rotation(r)}});
            }
            return *Compound::build(std::move(parts));
        }
        case ShapeType::TriangleMesh: break;
    }
    const ConvexHullPtr hull = random_hull(r, 30, 0.5, 0.8);
    std::vector<TriangleMesh::Triangle> triangles;
    for (const ConvexHull::Face& face : hull->faces()) {
        const auto& e = hull->edges();
        const std::uint32_t a = face.first_edge;
        for (std::uint32_t b = e[a].next; e[b].next != a; b = e[b].next) {
            triangles.push_back({e[a].origin, e[b].origin, e[e[b].next].origin});
        }
    }
    return *TriangleMesh::build(hull->vertices(), triangles);
}

struct Sampled {
    Shape a, b;
    Pose pa, pb;
};

Sampled sample_pair(ShapeType ta, ShapeType tb, Random& r) {
    const Pose pa{random_direction(r), random_rotation(r)};
    const Pose pb{pa.position + random_direction(r) * r.range(0.0, 1.2), random_rotation(r)};
    return {sample(ta, r), sample(tb, r), pa, pb};
}

template <class Body>
void for_each_pair(std::uint64_t seed, int count, const Body& body) {
    Random r(seed), of_surfaces(seed + 100);  // two streams: pairs of meshes and planes leave the others' samples as they are
    const auto surface = [](ShapeType t) { return t == ShapeType::Plane || t == ShapeType::TriangleMesh; };
    for (int a = 0; a < kTypes; ++a) {
        for (int b = 0; b < kTypes; ++b) {
            const auto ta = static_cast<ShapeType>(a), tb = static_cast<ShapeType>(b);
            if (!can_collide(ta, tb)) continue;
            for (int i = 0; i < count; ++i) {
                SCOPED_TRACE(testing::Message() << to_string(ta) << " " << to_string(tb) << " " << i);
                body(sample_pair(ta, tb, surface(ta) && surface(tb) ? of_surfaces : r));
            }
        }
    }
}

bool finite(const Manifold& m) {
    if (m.count < 1 || m.count > 4 || std::abs(glm::dot(dvec3(m.normal), dvec3(m.normal)) - 1.0) > 1e-6) return false;
    for (const ContactPoint& p : m.used()) {
        if (!is_finite(p.position) || !is_finite(p.separation)) return false;
    }
    return true;
}

int g_reports = 0;
ErrorCode g_code{};
void count_report(const Error& error) {
    ++g_reports;
    g_code = error.code;
}

// The direction of a smooth contact of a cylinder or cone is found by search: see penetration().
double normal_tolerance(const Sampled& s) {
    const auto searched = [](const Shape& x) { return type_of(x) >= ShapeType::Cylinder; };
    return searched(s.a) || searched(s.b) ? 5e-5 : 1e-5;
}

// A pair of which both have surfaces that are not those of one convex solid.
bool has_patches(const Sampled& s) {
    const auto many = [](const Shape& x) { return std::holds_alternative<TriangleMeshPtr>(x) || std::holds_alternative<CompoundPtr>(x); };
    return many(s.a) || many(s.b);
}

TEST(AllPairs, TheTableServesEveryPairButTwoPlanes) {
    Random r(5);
    for (int a = 0; a < kTypes; ++a) {
        for (int b = 0; b < kTypes; ++b) {
            const auto ta = static_cast<ShapeType>(a), tb = static_cast<ShapeType>(b);
            EXPECT_EQ(can_collide(ta, tb), ta != ShapeType::Plane || tb != ShapeType::Plane) << to_string(ta) << " " << to_string(tb);
            if (!can_collide(ta, tb)) continue;
            // Each gives a contact somewhere and none far away.
            const Sampled s = sample_pair(ta, tb, r);
            int hits = 0;
            for (int i = 0; i < 40; ++i) {
                hits += collide_all(s.a, s.pa, s.b, {s.pa.position + random_direction(r) * 0.5, random_rotation(r)}, 0.05f).empty() ? 0 : 1;
            }
            EXPECT_GT(hits, 0) << to_string(ta) << " " << to_string(tb);
            if (ta == ShapeType::Plane || tb == ShapeType::Plane) continue;
            EXPECT_TRUE(collide_all(s.a, s.pa, s.b, {s.pa.position + dvec3{9, 0, 0}, s.pb.orientation}, 0.05f).empty());
        }
    }
}

TEST(AllPairs, SwappingFlipsTheNormalAndKeepsThePoints) {
    for_each_pair(6, 60, [](const Sampled& s) {
        const std::vector<Manifold> m = collide_all(s.a, s.pa, s.b, s.pb, 0.05f);
        std::vector<Manifold> w = collide_all(s.b, s.pb, s.a, s.pa, 0.05f);
        ASSERT_EQ(m.size(), w.size());
        if (std::holds_alternative<CompoundPtr>(s.a) && std::holds_alternative<CompoundPtr>(s.b)) {
            // Manifolds come in the order of the first compound's parts; two parts that are not meshes have one.
            for (std::size_t i = 0; i < m.size(); ++i) {
                const auto same = [&](const Manifold& x) { return x.part_a == m[i].part_b && x.part_b == m[i].part_a; };
                const auto found = std::find_if(w.begin() + static_cast<std::ptrdiff_t>(i), w.end(), same);
                ASSERT_NE(found, w.end());
                std::iter_swap(w.begin() + static_cast<std::ptrdiff_t>(i), found);
            }
        }
        const dvec3 shift = s.pa.position - s.pb.position;
        for (std::size_t i = 0; i < m.size(); ++i) {
            ASSERT_LT(glm::length(dvec3(m[i].normal) + dvec3(w[i].normal)), normal_tolerance(s));
            ASSERT_NEAR(least_separation(m[i]), least_separation(w[i]), 2e-6f);
            if (s.a.index() == s.b.index()) continue;  // the same kernel sees the two in the other order
            ASSERT_EQ(m[i].count, w[i].count);
            for (std::size_t k = 0; k < m[i].count; ++k) {
                const ContactPoint &p = m[i].points[k], &q = w[i].points[k];
                ASSERT_LT(glm::length(dvec3(p.position) + shift - dvec3(q.position)), 1e-6);
                ASSERT_EQ(p.separation, q.separation);
                ASSERT_EQ(p.feature, q.feature);
            }
        }
    });
}

TEST(AllPairs, FarFromTheOriginNothingChanges) {
    const dvec3 far{3e6, -1e7, 5e5};  // multiples of 2^-20 stay exact there, so the relative pose does
    for_each_pair(7, 30, [&](Sampled s) {
        const auto snap = [](dvec3& v) { v = glm::round(v * 0x1p20) * 0x1p-20; };
        snap(s.pa.position);
        snap(s.pb.position);
        const std::vector<Manifold> near = collide_all(s.a, s.pa, s.b, s.pb, 0.05f);
        s.pa.position += far;
        s.pb.position += far;
        const std::vector<Manifold> moved = collide_all(s.a, s.pa, s.b, s.pb, 0.05f);
        ASSERT_EQ(near.size(), moved.size());
        ASSERT_TRUE(near.empty() || std::memcmp(near.data(), moved.data(), near.size() * sizeof(Manifold)) == 0);
    });
}

TEST(AllPairs, TurningTheWorldTurnsTheContacts) {
    Random r(8);
    for_each_pair(9, 30, [&](const Sampled& s) {
        const Pose turn{{0.0, 0.0, 0.0}, random_rotation(r)};
        const std::vector<Manifold> m = collide_all(s.a, s.pa, s.b, s.pb, 0.05f);
        const std::vector<Manifold> t = collide_all(s.a, turn * s.pa, s.b, turn * s.pb, 0.05f);
        ASSERT_EQ(m.size(), t.size());
        for (std::size_t i = 0; i < m.size(); ++i) {
            ASSERT_LT(glm::length(rotate(turn.orientation, dvec3(m[i].normal)) - dvec3(t[i].normal)), normal_tolerance(s));
            ASSERT_NEAR(least_separation(m[i]), least_separation(t[i]), 2e-6f);
        }
    });
}

TEST(AllPairs, ConcentricAlignedAndNestedShapesHaveAUnitNormal) {
    for_each_pair(10, 20, [](Sampled s) {
        s.pb = s.pa;
        for (const Manifold& m : collide_all(s.a, s.pa, s.b, s.pb, 0.05f)) ASSERT_TRUE(finite(m));
        s.pa.orientation = s.pb.orientation = kIdentityRotation;
        const std::vector<Manifold> m = collide_all(s.a, s.pa, s.b, s.pb, 0.05f);
        for (const Manifold& x : m) ASSERT_TRUE(finite(x));
        // A mesh is a surface: what is inside touches nothing. A compound has a manifold for each part. Everything else overlaps.
        if (!has_patches(s) && !std::holds_alternative<Plane>(s.a) && !std::holds_alternative<Plane>(s.b)) {
            ASSERT_EQ(m.size(), 1u);
            ASSERT_LT(least_separation(m[0]), 0.0f);
        }
    });
}

TEST(AllPairs, MovingOutByTheDepthPartsTheShapes) {
    for_each_pair(11, 40, [](const Sampled& s) {
        // A deep shape may touch more of a mesh or compound on its way out.
        if (has_patches(s)) return;
        const std::vector<Manifold> m = collide_all(s.a, s.pa, s.b, s.pb, 0.05f);
        if (m.size() != 1) return;
        const double depth = -static_cast<double>(least_separation(m[0]));
        Pose out = s.pb;
        out.position += dvec3(m[0].normal) * (depth + 1e-3);
        for (const Manifold& x : collide_all(s.a, s.pa, s.b, out, 0.05f)) ASSERT_GT(least_separation(x), 0.9e-3f);
        out.position -= dvec3(m[0].normal) * 2e-3;
        const std::vector<Manifold> back = collide_all(s.a, s.pa, s.b, out, 0.05f);
        ASSERT_FALSE(back.empty());
    });
}

TEST(AllPairs, MisuseIsReportedAndAppendsNothing) {
    const ErrorHandler before = set_error_handler(count_report);
    const Shape ball = Sphere{0.5f}, plane = Plane{};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refused = [&](const ShapePair& pair, ErrorCode code) {
        g_reports = 0;
        std::vector<Manifold> out(3);
        collide(pair, 0, out);
        EXPECT_EQ(g_reports, 1);
        EXPECT_EQ(g_code, code);
        EXPECT_EQ(out.size(), 3u);
        SerialExecutor serial;
        CollideScratch scratch;
        collide(std::span<const ShapePair>(&pair, 1), serial, scratch, out);
        EXPECT_EQ(g_reports, 2);
        EXPECT_EQ(out.size(), 3u);
    };
    refused({nullptr, &ball, {}, {}, 0.0f}, ErrorCode::InvalidArgument);
    refused({&ball, nullptr, {}, {}, 0.0f}, ErrorCode::InvalidArgument);
    refused({&ball, &ball, {{nan, 0, 0}, kIdentityRotation}, {}, 0.0f}, ErrorCode::NotFinite);
    refused({&ball, &ball, {}, {{0, 0, 0}, {1, nan, 0, 0}}, 0.0f}, ErrorCode::NotFinite);
    refused({&ball, &ball, {}, {}, -1e-9f}, ErrorCode::InvalidArgument);
    refused({&ball, &ball, {}, {}, std::numeric_limits<float>::quiet_NaN()}, ErrorCode::NotFinite);
    refused({&plane, &plane, {}, {}, 0.0f}, ErrorCode::WrongType);
    set_error_handler(before);
}

TEST(AllPairs, MisuseOfNumberedPairsIsReportedAndChangesNothing) {
    const ErrorHandler before = set_error_handler(count_report);
    const Shape ball = Sphere{0.5f}, plane = Plane{};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    SerialExecutor serial;
    CollideScratch scratch;
    std::vector<Manifold> out(3);
    const auto refused = [&](std::vector<const Shape*> shapes, std::vector<Pose> poses, NumberedPair pair, ErrorCode code) {
        g_reports = 0;
        collide({shapes, poses}, {&pair, 1}, serial, scratch, out);
        EXPECT_EQ(g_reports, 1);
        EXPECT_EQ(g_code, code);
        EXPECT_EQ(out.size(), 3u);
    };
    const Pose gone{{nan, 0, 0}, kIdentityRotation};
    refused({&ball, &ball}, {{}}, {0, 1, 0.0f}, ErrorCode::InvalidArgument);
    refused({&ball, &ball}, {{}, {}}, {0, 2, 0.0f}, ErrorCode::InvalidArgument);
    refused({&ball, &ball}, {{}, {}}, {4'000'000'000u, 1, 0.0f}, ErrorCode::InvalidArgument);
    refused({&ball, nullptr}, {{}, {}}, {0, 1, 0.0f}, ErrorCode::InvalidArgument);
    refused({&ball, &ball}, {{}, gone}, {0, 1, 0.0f}, ErrorCode::NotFinite);
    refused({&ball, &ball}, {{}, {}}, {0, 1, -1e-9f}, ErrorCode::InvalidArgument);
    refused({&ball, &ball}, {{}, {}}, {0, 1, std::numeric_limits<float>::infinity()}, ErrorCode::NotFinite);
    refused({&plane, &plane}, {{}, {}}, {0, 1, 0.0f}, ErrorCode::WrongType);
    set_error_handler(before);
    // What no pair names may be nothing at all.
    const std::vector<const Shape*> shapes{nullptr, &ball, &ball};
    const std::vector<Pose> poses{gone, {}, {{0.5, 0, 0}, kIdentityRotation}};
    const NumberedPair pair{1, 2, 0.0f};
    collide({shapes, poses}, {&pair, 1}, serial, scratch, out);
    ASSERT_EQ(out.size(), 1u);
    EXPECT_EQ(out[0].pair, 0u);
    collide({shapes, poses}, {}, serial, scratch, out);
    EXPECT_TRUE(out.empty());
}

TEST(AllPairs, PositionsAtTheEndOfTheRangeGiveNoContact) {
    for_each_pair(12, 2, [](Sampled s) {
        if (std::holds_alternative<Plane>(s.a) || std::holds_alternative<Plane>(s.b)) return;
        s.pa.position = dvec3{1.7e308, -1.7e308, 1e300};
        s.pb.position = dvec3{-1.7e308, 1.7e308, -1e300};
        ASSERT_TRUE(collide_all(s.a, s.pa, s.b, s.pb, 0.05f).empty());
        s.pa.position = dvec3{1e200, 0, 0};
        ASSERT_TRUE(collide_all(s.a, s.pa, s.b, {}, 0.05f).empty());
    });
}

// Runs ranges on several threads at once, cut as small as the grain allows.
class ManyThreads final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 3; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        std::vector<std::thread> threads;
        for (std::size_t t = 0; t < 3; ++t) {
            threads.emplace_back([=] {
                for (std::size_t begin = t * grain; begin < count; begin += 3 * grain) body(begin, std::min(count, begin + grain));
            });
        }
        for (std::thread& thread : threads) thread.join();
    }
};

TEST(AllPairs, TheBatchGivesTheBitsOfSingleCallsOnAnyNumberOfThreadsAtEveryWidth) {
    std::vector<Sampled> samples;
    for_each_pair(13, 60, [&](const Sampled& s) { samples.push_back(s); });
    Random r(14);
    for (std::size_t i = samples.size(); i > 1; --i) {
        std::swap(samples[i - 1], samples[static_cast<std::size_t>(r.range(0, static_cast<double>(i)))]);
    }
    std::vector<ShapePair> pairs;
    std::vector<Manifold> single;
    for (const Sampled& s : samples) {
        pairs.push_back({&s.a, &s.b, s.pa, s.pb, 0.05f});
        collide(pairs.back(), static_cast<std::uint32_t>(pairs.size() - 1), single);
    }
    SerialExecutor serial;
    ManyThreads threads;
    CollideScratch scratch;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        std::vector<Manifold> narrow;
        collide(pairs, serial, scratch, narrow);
        ASSERT_EQ(narrow.size(), single.size()) << width;
        EXPECT_EQ(std::memcmp(narrow.data(), single.data(), narrow.size() * sizeof(Manifold)), 0) << width;
    }
    set_simd_width(0);
    for (Executor* executor : {static_cast<Executor*>(&serial), static_cast<Executor*>(&threads)}) {
        for (int repeat = 0; repeat < 2; ++repeat) {
            std::vector<Manifold> batch(7);
            collide(pairs, *executor, scratch, batch);
            ASSERT_EQ(batch.size(), single.size());
            ASSERT_EQ(std::memcmp(batch.data(), single.data(), batch.size() * sizeof(Manifold)), 0);
        }
    }
    std::vector<Manifold> none(2);
    collide(std::span<const ShapePair>{}, serial, scratch, none);
    EXPECT_TRUE(none.empty());

    // Pair by pair, as many as there are blocks of.
    std::vector<const Shape*> shapes;
    std::vector<Pose> poses;
    std::vector<NumberedPair> numbered;
    for (const ShapePair& pair : pairs) {
        const auto a = static_cast<std::uint32_t>(shapes.size());
        shapes.insert(shapes.end(), {pair.a, pair.b}), poses.insert(poses.end(), {pair.pose_a, pair.pose_b});
        numbered.push_back({a, a + 1, pair.margin});
    }
    const PlacedShapes placed{shapes, poses};
    std::vector<Manifold> all;
    const CollideCounts want = collide(placed, numbered, serial, scratch, all);
    for (Executor* executor : {static_cast<Executor*>(&serial), static_cast<Executor*>(&threads)}) {
        std::size_t next = 0, taken = 0;
        const CollideCounts counts = collide(placed, numbered, *executor, scratch, [&](std::size_t pair, std::span<const Manifold> manifolds) {
            ASSERT_EQ(pair, next++);
            for (const Manifold& manifold : manifolds) {
                ASSERT_EQ(manifold.pair, pair);
                ASSERT_EQ(std::memcmp(&manifold, &single[taken++], sizeof(Manifold)), 0);
            }
        });
        EXPECT_EQ(next, pairs.size());
        EXPECT_EQ(taken, single.size());
        EXPECT_EQ(counts.undecided, want.undecided);
    }
    numbered.back().margin = -1.0f;
    EXPECT_THROW(collide(placed, numbered, serial, scratch, [](std::size_t, std::span<const Manifold>) { FAIL() << "nothing is looked at"; }), MisuseError);
}

}  // namespace
}  // namespace carom
