// A hierarchy that is moved, saved and loaded is the same hierarchy; damaged bytes are told from it.
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/random.hpp>

#include <fuzz/static_bvh_file_check.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

namespace carom {
namespace {

struct Grid {
    std::vector<vec3> vertices;
    std::vector<StaticBvh::Triangle> triangles;
};

/// A wavy square of n x n quads; `phase` moves the waves.
Grid waves(int n, float phase, float height = 0.3f) {
    Grid grid;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            const auto x = static_cast<float>(i), z = static_cast<float>(j);
            grid.vertices.push_back({x, height * (0.25f * x * x - phase * z), z});
        }
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const auto a = static_cast<std::uint32_t>(i * (n + 1) + j), b = a + static_cast<std::uint32_t>(n) + 1;
            grid.triangles.push_back({a, a + 1, b + 1});
            grid.triangles.push_back({a, b + 1, b});
        }
    }
    return grid;
}

std::vector<MeshHit> cast_many(const StaticBvh& bvh, std::uint64_t seed) {
    Random random(seed);
    std::vector<MeshHit> hits;
    const auto within = [&](double size) { return static_cast<float>(random.range(-size, size)); };
    for (int i = 0; i < 400; ++i) {
        geo::Ray<float> ray{.origin = {within(30), 40, within(30)}};
        ray.direction = vec3{5 + within(8), 0, 5 + within(8)} - ray.origin;
        hits.push_back(closest_hit(bvh, ray));
    }
    return hits;
}

bool same(const std::vector<MeshHit>& a, const std::vector<MeshHit>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i].t != b[i].t || a[i].triangle != b[i].triangle || a[i].u != b[i].u || a[i].v != b[i].v) return false;
    }
    return a.size() == b.size();
}

TEST(StaticBvhRefit, AnswersAsABuildOfTheMovedMesh) {
    const Grid before = waves(12, 0.0f), after = waves(12, 0.7f, 0.5f);
    StaticBvh bvh = *StaticBvh::build(before.vertices, before.triangles);
    EXPECT_EQ(bvh.degradation(), 1.0);
    ASSERT_TRUE(bvh.refit(after.vertices, after.triangles));
    const StaticBvh built = *StaticBvh::build(after.vertices, after.triangles);
    EXPECT_TRUE(same(cast_many(bvh, 1), cast_many(built, 1)));
    EXPECT_EQ(bvh.bounds(), built.bounds());
    std::size_t hits = 0;
    for (const MeshHit& hit : cast_many(bvh, 1)) hits += hit ? 1u : 0u;
    EXPECT_GT(hits, 100u);
    ASSERT_TRUE(bvh.refit(before.vertices, before.triangles));
    EXPECT_NEAR(bvh.degradation(), 1.0, 1e-12);
}

TEST(StaticBvhRefit, ShufflingTheVerticesDegradesTheTree) {
    Grid grid = waves(16, 0.0f);
    StaticBvh bvh = *StaticBvh::build(grid.vertices, grid.triangles);
    Random random(3);
    for (std::size_t i = grid.vertices.size(); i-- > 1;) {
        std::swap(grid.vertices[i], grid.vertices[static_cast<std::size_t>(random.range(0.0, 1.0) * static_cast<double>(i))]);
    }
    ASSERT_TRUE(bvh.refit(grid.vertices, grid.triangles));
    EXPECT_GT(bvh.degradation(), 2.0);
}

/// Small triangles all over a cube, each with corners of its own.
Grid specks(std::uint32_t count) {
    Random random(5);
    Grid grid;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto in = [&](double size) { return static_cast<float>(random.range(-size, size)); };
        const vec3 at{in(5), in(5), in(5)};
        for (int k = 0; k < 3; ++k) grid.vertices.push_back(at + vec3{in(0.1), in(0.1), in(0.1)});
        grid.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return grid;
}

// Growing and shrinking change from where rays are moved first, and which coordinates survive scaling.
TEST(StaticBvhRefit, KnowsTheSizeOfTheMovedMesh) {
    const Grid before = waves(8, 0.2f);
    for (const float factor : {0.01f, 100.0f}) {
        StaticBvh bvh = *StaticBvh::build(before.vertices, before.triangles);
        Grid after = before;
        for (vec3& v : after.vertices) v *= factor;
        ASSERT_TRUE(bvh.refit(after.vertices, after.triangles));
        const StaticBvh built = *StaticBvh::build(after.vertices, after.triangles);
        EXPECT_EQ(bvh.wide().far_reach, built.wide().far_reach);
        Random random(6);
        const float size = 8.0f * factor;
        for (int i = 0; i < 500; ++i) {
            const auto in = [&](double s) { return size * static_cast<float>(random.range(-s, s)); };
            const vec3 target{in(0.5) + 0.5f * size, 0, in(0.5) + 0.5f * size}, origin{in(20), size * 30.0f, in(20)};
            const geo::Ray<float> ray{origin, target - origin};
            const MeshHit a = closest_hit(bvh, ray), b = closest_hit(built, ray);
            ASSERT_EQ(a.t, b.t) << i;
            ASSERT_EQ(a.u, b.u) << i;
        }
    }
    // A mesh of size 2^100 is scaled down, and a coordinate of 2^-40 does not survive that.
    Grid huge = before;
    for (vec3& v : huge.vertices) v = vec3{0x1p96f} * (v + 1.0f);
    StaticBvh bvh = *StaticBvh::build(huge.vertices, huge.triangles);
    EXPECT_TRUE(bvh.wide().lossless);
    huge.vertices[0].x = 0x1.234p-40f;
    ASSERT_TRUE(bvh.refit(huge.vertices, huge.triangles));
    EXPECT_FALSE(bvh.wide().lossless);
    huge.vertices[0].x = 0.0f;
    ASSERT_TRUE(bvh.refit(huge.vertices, huge.triangles));
    EXPECT_TRUE(bvh.wide().lossless);
}

TEST(StaticBvhRefit, ATriangleThatStraysDoesNotHideWhatBecameOfTheRest) {
    const Grid before = specks(4000);
    StaticBvh bvh = *StaticBvh::build(before.vertices, before.triangles);
    Grid after = before;
    for (const float far : {100.0f, 1e4f, 1e6f}) {
        after.vertices[0] = vec3{far};
        ASSERT_TRUE(bvh.refit(after.vertices, after.triangles));
        EXPECT_LT(bvh.degradation(), 1.5) << "one triangle is no reason to build";
    }
    // Each triangle takes the place of another.
    const std::size_t count = before.triangles.size();
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 3; ++k) after.vertices[3 * i + k] = before.vertices[3 * ((i * 1117) % count) + k];
    }
    ASSERT_TRUE(bvh.refit(after.vertices, after.triangles));
    EXPECT_GT(bvh.degradation(), 20.0);
    after.vertices[0] = vec3{1e4f};
    ASSERT_TRUE(bvh.refit(after.vertices, after.triangles));
    EXPECT_GT(bvh.degradation(), 20.0);
    EXPECT_GT(StaticBvh::load(bvh.save())->degradation(), 20.0) << "a file keeps it";
    // Neither size nor place of the whole matters.
    for (vec3& v : after.vertices) v = 16.0f * v;
    const double was = bvh.degradation();
    ASSERT_TRUE(bvh.refit(after.vertices, after.triangles));
    EXPECT_EQ(bvh.degradation(), was);
    EXPECT_EQ(StaticBvh::build(after.vertices, after.triangles)->degradation(), 1.0);
}

TEST(StaticBvhRefit, AFlatMeshHasNoDegradationOfItsOwn) {
    Grid flat = waves(20, 0.0f, 0.0f);
    for (vec3& v : flat.vertices) v.y = 0.1f;
    StaticBvh bvh = *StaticBvh::build(flat.vertices, flat.triangles);
    EXPECT_EQ(bvh.degradation(), 1.0);
    ASSERT_TRUE(bvh.refit(flat.vertices, flat.triangles));
    EXPECT_EQ(bvh.degradation(), 1.0);
}

// Which copies of a corner share a leaf must not matter.
TEST(StaticBvhRefit, CornersAtOnePositionStayTogetherWhereverTheyAre) {
    const Grid grid = waves(12, 0.3f);
    Grid soup;
    for (const StaticBvh::Triangle& t : grid.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.vertices.size());
        for (const std::uint32_t v : t) soup.vertices.push_back(grid.vertices[v]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    StaticBvh bvh = *StaticBvh::build(soup.vertices, soup.triangles);
    int shared = 0;
    for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
        const bool alone = std::count(soup.vertices.begin(), soup.vertices.end(), soup.vertices[i]) == 1;
        Grid moved = soup;
        moved.vertices[i].y += 0.5f;
        const Status status = StaticBvh::load(bvh.save())->refit(moved.vertices, moved.triangles);
        ASSERT_EQ(static_cast<bool>(status), alone) << i;
        shared += alone ? 0 : 1;
    }
    EXPECT_GT(shared, 700);
    EXPECT_TRUE(StaticBvh::build(grid.vertices, grid.triangles)->refit(waves(12, 0.9f).vertices, grid.triangles));
    // Corners of their own may meet and part again.
    StaticBvh free = *StaticBvh::build(grid.vertices, grid.triangles);
    std::vector<vec3> collapsed(grid.vertices.size(), vec3{1.0f});
    ASSERT_TRUE(free.refit(collapsed, grid.triangles));
    ASSERT_TRUE(free.refit(grid.vertices, grid.triangles));
    EXPECT_TRUE(same(cast_many(free, 4), cast_many(*StaticBvh::build(grid.vertices, grid.triangles), 4)));
}

TEST(StaticBvhRefit, RefusesWhatOnlyABuildCanDo) {
    // Soup: two triangles share an edge by position alone.
    std::vector<vec3> v = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<StaticBvh::Triangle> t = {{0, 1, 2}, {3, 4, 5}};
    StaticBvh bvh = *StaticBvh::build(v, t);
    const std::vector<std::byte> before = bvh.save();
    auto apart = v;
    apart[3] = {1, 0, 0.5f};
    EXPECT_EQ(bvh.refit(apart, t).error().code, ErrorCode::WrongType);
    auto huge = v;
    for (vec3& p : huge) p *= 1e9f;
    EXPECT_EQ(bvh.refit(huge, t).error().code, ErrorCode::WrongType);
    auto broken = v;
    broken[2].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(bvh.refit(broken, t).error().code, ErrorCode::NotFinite);
    EXPECT_EQ(bvh.refit(v, std::span(t).first(1)).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(bvh.refit(std::span(v).first(5), t).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(bvh.refit({}, {}).error().code, ErrorCode::Empty);
    EXPECT_EQ(bvh.save(), before);
    for (vec3& p : v) p += vec3{1, 2, 3};
    EXPECT_TRUE(bvh.refit(v, t)) << "what was at one position still is";
}

TEST(StaticBvhFile, RoundTripsToTheBit) {
    for (const float scale : {1.0f, 1e-12f}) {
        Grid grid = waves(14, 0.4f);
        for (vec3& v : grid.vertices) v *= scale;
        const StaticBvh bvh = *StaticBvh::build(grid.vertices, grid.triangles);
        const std::vector<std::byte> bytes = bvh.save();
        const Result<StaticBvh> loaded = StaticBvh::load(bytes);
        ASSERT_TRUE(loaded) << loaded.error().message;
        EXPECT_EQ(loaded->save(), bytes);
        EXPECT_TRUE(same(cast_many(*loaded, 2), cast_many(bvh, 2)));
        EXPECT_EQ(loaded->triangle_count(), grid.triangles.size());
        EXPECT_EQ(loaded->sah_cost(), bvh.sah_cost());
        EXPECT_EQ(loaded->degradation(), 1.0);
    }
}

TEST(StaticBvhFile, EveryChangedByteIsSeen) {
    const Grid grid = waves(5, 0.4f);
    std::vector<std::byte> bytes = StaticBvh::build(grid.vertices, grid.triangles)->save();
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] ^= std::byte{0x10};
        const Result<StaticBvh> loaded = StaticBvh::load(bytes);
        ASSERT_FALSE(loaded) << i;
        ASSERT_EQ(loaded.error().code, ErrorCode::Parse) << i;
        bytes[i] ^= std::byte{0x10};
    }
    ASSERT_TRUE(StaticBvh::load(bytes));
}

TEST(StaticBvhFile, EveryOtherLengthIsSeen) {
    const Grid grid = waves(5, 0.4f);
    std::vector<std::byte> bytes = StaticBvh::build(grid.vertices, grid.triangles)->save();
    for (std::size_t i = 0; i < bytes.size(); ++i) ASSERT_FALSE(StaticBvh::load(std::span(bytes).first(i))) << i;
    bytes.push_back(std::byte{0});
    ASSERT_FALSE(StaticBvh::load(bytes));
}

// A forged checksum: every byte set to several values. What is still accepted answers queries without harm (under the sanitizers too).
TEST(StaticBvhFile, ForgedBytesAreRefusedOrHarmless) {
    const Grid grid = waves(4, 0.4f);
    const std::vector<std::byte> good = StaticBvh::build(grid.vertices, grid.triangles)->save();
    int refused = 0, accepted = 0;
    for (std::size_t i = 0; i < good.size(); ++i) {
        if (i >= 88 && i < 96) continue;
        for (const int value : {0x00, 0x01, 0x7f, 0x80, 0xff}) {
            std::vector<std::byte> bytes = good;
            const auto byte = static_cast<std::byte>(value);
            if (bytes[i] == byte) continue;
            bytes[i] = byte;
            test::forge_checksum(bytes);
            const Result<StaticBvh> loaded = StaticBvh::load(bytes);
            if (!loaded) {
                ASSERT_EQ(loaded.error().code, ErrorCode::Parse);
                ++refused;
                continue;
            }
            ++accepted;
            ASSERT_EQ(test::fault_of_answers(*loaded), "") << i << ' ' << value;
        }
    }
    EXPECT_GT(refused, 3 * accepted);
    EXPECT_GT(accepted, 0) << "the costs and corners inside of boxes are free";
}

TEST(StaticBvhFile, HugeClaimsTakeNoMemory) {
    const Grid grid = waves(4, 0.4f);
    const std::vector<std::byte> good = StaticBvh::build(grid.vertices, grid.triangles)->save();
    for (const std::size_t field : {16u, 24u, 32u}) {  // nodes, leaves, triangles
        for (const std::uint64_t claim : {std::uint64_t{1} << 26, std::uint64_t{1} << 32, ~std::uint64_t{0}, std::uint64_t{1} << 63}) {
            std::vector<std::byte> bytes = good;
            for (std::size_t k = 0; k < 8; ++k) bytes[field + k] = static_cast<std::byte>(claim >> (8 * k));
            test::forge_checksum(bytes);
            EXPECT_FALSE(StaticBvh::load(bytes)) << field << ' ' << claim;
        }
    }
}

}  // namespace
}  // namespace carom
