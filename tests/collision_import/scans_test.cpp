// Scanned, modelled and deliberately bad meshes: those of CGAL, where Debian's libcgal-demo is installed.
//
// Closed ones: no ray aimed at their seams leaks, crossings are even, and inside stays inside. Bad ones (polygons in any order and
// orientation, holes, degenerate and intersecting triangles, borders): answers agree with a test of every triangle in double.
#include <collision/mesh_rays_cases.hpp>

#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/closest_points.hpp>
#include <carom/collision/import/read_mesh.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <optional>

namespace carom {
namespace {

using test::FloatRay;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kUlp = 0x1p-24;

constexpr const char* kClosed[]{"bunny00", "elephant", "armadillo", "camel", "man", "homer", "triceratops", "knot1", "hand", "cow"};
constexpr const char* kBad[]{"blobby-shuffled",
                             "blobby_3cc",
                             "degtri_sliding",
                             "tetra_intersected_by_triangle",
                             "polygon_mesh",
                             "ChineseDragon-10kv",
                             "boeing",
                             "elephant-with-holes",
                             "fold",
                             "quads_to_stitch",
                             "ALSTOM_TEST4",
                             "cube4-shuffled",
                             "pig",
                             "mech-holes-shark",
                             "holes",
                             "triangular_hole"};

/// A mesh that was read, with its hierarchy.
struct Scan {
    std::string name;
    MeshData mesh;
    StaticBvh bvh;
};

std::optional<Scan> load(const char* name) {
    const std::string path = std::string(CAROM_SCANS) + "/data/meshes/" + name + ".off";
    const Result<MeshData> mesh = read_mesh(path);
    EXPECT_TRUE(mesh) << path << ": " << mesh.error().message;
    if (!mesh) return std::nullopt;
    Result<StaticBvh> bvh = StaticBvh::build(mesh->vertices, mesh->triangles);
    EXPECT_TRUE(bvh) << name;
    if (!bvh) return std::nullopt;
    return Scan{name, *mesh, std::move(*bvh)};
}

class Scans : public testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(std::string(CAROM_SCANS) + "/data/meshes/bunny00.off")) {
            GTEST_SKIP() << "no scans: install libcgal-demo and configure again";
        }
    }
};

// In `grow` times the box; flat ones get some height.
vec3 random_in(const Aabb& box, Random& random, double grow) {
    const dvec3 half = 0.5 * (box.upper - box.lower) + 0.05 * glm::length(box.upper - box.lower), p = test::random_point(random, grow);
    return vec3(0.5 * (box.lower + box.upper) + half * p);
}

// By the number of crossings towards a place that no seam is near. None for points that rounding may put on either side.
std::optional<bool> inside(const Scan& scan, const vec3& point, double size) {
    if (closest_point(scan.bvh, dvec3(point), 1e-4 * size)) return std::nullopt;
    std::vector<MeshHit> hits;
    all_hits(scan.bvh, {point, {0.31f, 0.87f, -0.39f}}, hits);
    return hits.size() % 2 == 1;
}

TEST_F(Scans, NoRayAimedAtASeamLeaks) {
    constexpr int kLines = 20'000, kHalfLines = 10'000;
    std::uint64_t seed = 900;
    std::vector<MeshHit> hits;
    for (const char* name : kClosed) {
        const std::optional<Scan> scan = load(name);
        ASSERT_TRUE(scan);
        EXPECT_TRUE(TriangleMesh::build(scan->mesh.vertices, scan->mesh.triangles).value()->is_closed()) << name;
        Random random(seed++);
        const Aabb box = scan->bvh.bounds();
        const double size = glm::length(box.upper - box.lower);
        int odd = 0, missed = 0, crossings = 0;
        for (int i = 0; i < kLines; ++i) {
            const vec3 origin = random_in(box, random, i % 3 == 0 ? 50.0 : 2.0);
            const vec3 direction = test::seam_point(scan->mesh, random) - origin;
            all_hits(scan->bvh, {origin, direction, -kInfinity, kInfinity}, hits);
            odd += static_cast<int>(hits.size() % 2);
            crossings += static_cast<int>(hits.size());
            all_hits(scan->bvh, {origin, direction}, hits);
            missed += hits.empty() == static_cast<bool>(closest_hit(scan->bvh, {origin, direction})) ? 1 : 0;
        }
        EXPECT_EQ(odd, 0) << name;
        EXPECT_EQ(missed, 0) << name << ": a closest hit without all hits, or the other way round";
        EXPECT_GT(crossings, kLines) << name;
        int leaks = 0, within = 0;
        for (int i = 0; i < kHalfLines; ++i) {
            const vec3 origin = random_in(box, random, 1.0);
            const std::optional<bool> is_inside = inside(*scan, origin, size);
            if (!is_inside) continue;
            all_hits(scan->bvh, {origin, test::seam_point(scan->mesh, random) - origin}, hits);
            leaks += hits.size() % 2 != (*is_inside ? 1u : 0u) ? 1 : 0;
            within += *is_inside ? 1 : 0;
        }
        EXPECT_EQ(leaks, 0) << name << ": a point is inside along one ray and outside along another";
        EXPECT_GT(within, kHalfLines / 100) << name;
    }
}

/// A hit by a test of every triangle in double.
struct SlowHit {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = MeshHit::kNone;
};

std::array<dvec3, 3> corners(const MeshData& mesh, std::uint32_t triangle) {
    const auto& t = mesh.triangles[triangle];
    return {dvec3(mesh.vertices[t[0]]), dvec3(mesh.vertices[t[1]]), dvec3(mesh.vertices[t[2]])};
}

SlowHit slow_hit(const MeshData& mesh, const FloatRay& ray) {
    const dvec3 o(ray.origin), d(ray.direction);
    SlowHit best;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = corners(mesh, i);
        const dvec3 p = a - o, q = b - o, r = c - o;
        const double u = glm::dot(d, glm::cross(r, q)), v = glm::dot(d, glm::cross(p, r)), w = glm::dot(d, glm::cross(q, p));
        if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) continue;
        const dvec3 normal = glm::cross(b - a, c - a);
        const double along = glm::dot(normal, d);
        if (along == 0.0) continue;
        const double t = glm::dot(normal, p) / along;
        if (t >= 0.0 && t < best.t) best = {t, i};
    }
    return best;
}

// How far the line of sight passes from the nearest edge of a triangle that is within `radius` of it.
bool passes_an_edge(const Scan& scan, const FloatRay& ray, double reach, double radius) {
    const dvec3 o(ray.origin);
    const geo::Segment<double> sight{o, o + dvec3(ray.direction) * reach};
    for (std::uint32_t i = 0; i < scan.mesh.triangles.size(); ++i) {
        const auto c = corners(scan.mesh, i);
        for (std::size_t k = 0; k < 3; ++k) {
            const geo::Segment<double> edge{c[k], c[(k + 1) % 3]};
            if (geo::closest_points(sight, edge).distance_sq <= radius * radius) return true;
        }
    }
    return false;
}

// The cosine between the ray and the triangle's normal; 0 where there is no normal.
double slope(const MeshData& mesh, std::uint32_t triangle, const vec3& direction) {
    const auto [a, b, c] = corners(mesh, triangle);
    const dvec3 normal = glm::cross(b - a, c - a);
    const double lengths = glm::length(normal) * glm::length(dvec3(direction));
    return lengths > 0.0 ? std::abs(glm::dot(normal, dvec3(direction))) / lengths : 0.0;
}

// Every vertex may move by `bound`: then an edge passes the ray, and the distance changes by `bound` over the slope.
bool agree(const Scan& scan, const FloatRay& ray, const MeshHit& hit, const SlowHit& slow, double bound, double reach) {
    if (hit && slow.triangle != MeshHit::kNone) {
        const double least = std::min(slope(scan.mesh, hit.triangle, ray.direction), slope(scan.mesh, slow.triangle, ray.direction));
        const double apart = std::abs(static_cast<double>(hit.t) - slow.t) * glm::length(dvec3(ray.direction));
        if (apart * least <= bound) return true;
    } else if (!hit && slow.triangle == MeshHit::kNone) {
        return true;
    }
    return passes_an_edge(scan, ray, reach, bound);
}

TEST_F(Scans, RaysAtBadMeshesAgreeWithATestOfEveryTriangle) {
    std::uint64_t seed = 940;
    for (const char* name : kBad) {
        const std::optional<Scan> scan = load(name);
        ASSERT_TRUE(scan);
        Random random(seed++);
        const Aabb box = scan->bvh.bounds();
        const double size = glm::length(box.upper - box.lower);
        const auto rays = static_cast<int>(std::min<std::size_t>(2000, 4'000'000 / scan->mesh.triangles.size()));
        int hits = 0, wrong = 0;
        for (int i = 0; i < rays; ++i) {
            const vec3 origin = random_in(box, random, 1.5);
            const vec3 target = i % 2 == 0 ? random_in(box, random, 1.0) : test::seam_point(scan->mesh, random);
            const FloatRay ray{origin, target - origin};
            const MeshHit hit = closest_hit(scan->bvh, ray);
            hits += hit ? 1 : 0;
            // mesh_rays.hpp: a vertex is where it should be within 8 u (D + |o|) along each axis, and depths within twice that.
            const double bound = 32.0 * kUlp * (2.0 * size + glm::length(dvec3(origin)));
            wrong += agree(*scan, ray, hit, slow_hit(scan->mesh, ray), bound, 4.0 * size / glm::length(dvec3(ray.direction))) ? 0 : 1;
        }
        EXPECT_EQ(wrong, 0) << name << " of " << rays;
        EXPECT_GT(hits, rays / 50) << name;
    }
}

// The closest hit does not depend on the tree, so that trees of one mesh give the same bits however they came to be.
void expect_equal(const StaticBvh& a, const StaticBvh& b, const std::string& name) {
    Random random(77);
    const Aabb box = a.bounds();
    for (int i = 0; i < 300; ++i) {
        const vec3 origin = random_in(box, random, 2.0);
        const FloatRay ray{origin, random_in(box, random, 1.0) - origin};
        const MeshHit first = closest_hit(a, ray), second = closest_hit(b, ray);
        ASSERT_TRUE(first.triangle == second.triangle && first.t == second.t) << name << " ray " << i;
    }
}

TEST_F(Scans, EveryMeshIsBuiltRefittedSavedAndLoaded) {
    std::vector<const char*> names(std::begin(kClosed), std::end(kClosed));
    names.insert(names.end(), std::begin(kBad), std::end(kBad));
    for (const char* name : names) {
        std::optional<Scan> scan = load(name);
        ASSERT_TRUE(scan);
        const Result<StaticBvh> loaded = StaticBvh::load(scan->bvh.save());
        ASSERT_TRUE(loaded) << name;
        expect_equal(scan->bvh, *loaded, name);
        // Bent by a function of position, so that what was welded stays together.
        std::vector<vec3> bent = scan->mesh.vertices;
        const Aabb box = scan->bvh.bounds();
        const double size = glm::length(box.upper - box.lower);
        for (vec3& v : bent)
            v += vec3(0.0f, static_cast<float>(0.1 * (dvec3(v).x - box.lower.x) * (dvec3(v).z - box.lower.z) / size), 0.0f);
        ASSERT_TRUE(scan->bvh.refit(bent, scan->mesh.triangles)) << name;
        const Result<StaticBvh> fresh = StaticBvh::build(bent, scan->mesh.triangles);
        ASSERT_TRUE(fresh) << name;
        expect_equal(*fresh, scan->bvh, name);
        EXPECT_LT(scan->bvh.degradation(), 3.0) << name;
    }
}

}  // namespace
}  // namespace carom
