// Google Benchmark of primitive tests: one pair at a time against the batch over the same 4,096 items.
//
//   bench_primitives --benchmark_filter=sphere_aabb
//   CAROM_BENCH_WIDTH=8 bench_primitives             the batches with 8 lanes (AVX2)
#include <carom/collision/batch_tests.hpp>
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <vector>

namespace {

using namespace carom;

constexpr std::size_t kCount = 4096;

vec3 point(Random& random, double size) {
    return vec3(dvec3{random.range(-size, size), random.range(-size, size), random.range(-size, size)});
}

// Sizes near one in a cube of 6: of the boxes some 6 % overlap the query, of the triangles some 1 % are hit.
std::vector<geo::Aabb<float>> make_aabbs() {
    Random random(0xbe1);
    std::vector<geo::Aabb<float>> boxes(kCount);
    for (auto& b : boxes) {
        const vec3 p = point(random, 3.0), h = glm::abs(point(random, 0.6));
        b = {p - h, p + h};
    }
    return boxes;
}

std::vector<geo::Triangle<float>> make_triangles() {
    Random random(0xbe2);
    std::vector<geo::Triangle<float>> triangles(kCount);
    for (auto& t : triangles) {
        const vec3 p = point(random, 3.0);
        t = {p, p + point(random, 0.7), p + point(random, 0.7)};
    }
    return triangles;
}

geo::Obb<float> make_obb(Random& random, double spread) {
    const dquat q = rotation_from_vector(dvec3(point(random, 3.0)));
    return {.center = point(random, spread),
            .half_extents = vec3{0.2f} + glm::abs(point(random, 0.6)),
            .axes = mat3(dmat3{rotate(q, dvec3{1, 0, 0}), rotate(q, dvec3{0, 1, 0}), rotate(q, dvec3{0, 0, 1})})};
}

std::vector<geo::Obb<float>> make_obbs(double spread) {
    Random random(0xbe3);
    std::vector<geo::Obb<float>> boxes(kCount);
    for (auto& b : boxes) b = make_obb(random, spread);
    return boxes;
}

const geo::Ray<float> kRay{.origin = {-4.0f, 0.3f, 0.2f}, .direction = {1.0f, -0.05f, 0.02f}};
const geo::Sphere<float> kSphere{.center = {0.1f, 0.2f, 0.3f}, .radius = 0.8f};

void count_items(benchmark::State& state) {
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(kCount));
}

// `one` of each item, into `out`.
template <class Items, class Out, class One>
void scalar(benchmark::State& state, const Items& items, Out out, const One& one) {
    for (auto _ : state) {
        for (std::size_t i = 0; i < kCount; ++i) out[i] = one(items[i]);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count_items(state);
}

template <class Out, class All>
void batch(benchmark::State& state, Out out, const All& all) {
    for (auto _ : state) {
        all(out);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count_items(state);
}

template <class Hit>
float t_of(const Hit& hit) {
    return hit ? hit->t : std::numeric_limits<float>::infinity();
}

void ray_aabb_scalar(benchmark::State& state) {
    scalar(state, make_aabbs(), std::vector<float>(kCount), [](const auto& b) { return t_of(geo::cast_ray(b, kRay)); });
}
void ray_aabb_batch(benchmark::State& state) {
    batch(state, std::vector<float>(kCount), [boxes = make_aabbs()](auto& out) { geo::cast_ray_batch(boxes, kRay, out); });
}
void ray_triangle_scalar(benchmark::State& state) {
    scalar(state, make_triangles(), std::vector<float>(kCount), [](const auto& t) { return t_of(geo::cast_ray(t, kRay)); });
}
void ray_triangle_batch(benchmark::State& state) {
    batch(state, std::vector<float>(kCount), [triangles = make_triangles()](auto& out) { geo::cast_ray_batch(triangles, kRay, out); });
}
void sphere_aabb_scalar(benchmark::State& state) {
    scalar(state, make_aabbs(), std::vector<std::uint8_t>(kCount),
           [](const auto& b) -> std::uint8_t { return geo::overlaps(kSphere, b) ? 1 : 0; });
}
void sphere_aabb_batch(benchmark::State& state) {
    batch(state, std::vector<std::uint8_t>(kCount), [boxes = make_aabbs()](auto& out) { geo::overlaps_batch(boxes, kSphere, out); });
}

// The argument is half the side of the cube that the boxes are spread over: at 1 nearly all overlap, at 6 nearly none.
void obb_obb_scalar(benchmark::State& state) {
    Random random(0xbe4);
    const geo::Obb<float> mine = make_obb(random, 0.1);
    scalar(state, make_obbs(static_cast<double>(state.range(0))), std::vector<std::uint8_t>(kCount),
           [mine](const auto& b) -> std::uint8_t { return geo::overlaps(mine, b) ? 1 : 0; });
}
void obb_obb_batch(benchmark::State& state) {
    Random random(0xbe4);
    const geo::Obb<float> mine = make_obb(random, 0.1);
    batch(state, std::vector<std::uint8_t>(kCount),
          [mine, boxes = make_obbs(static_cast<double>(state.range(0)))](auto& out) { geo::overlaps_batch(boxes, mine, out); });
}
void point_triangle_scalar(benchmark::State& state) {
    scalar(state, make_triangles(), std::vector<geo::ClosestPoints<float>>(kCount),
           [](const auto& t) { return geo::closest_points(kSphere.center, t); });
}
void point_triangle_batch(benchmark::State& state) {
    batch(state, std::vector<geo::ClosestPoints<float>>(kCount),
          [triangles = make_triangles()](auto& out) { geo::closest_points_batch(triangles, kSphere.center, out); });
}

BENCHMARK(ray_aabb_scalar);
BENCHMARK(ray_aabb_batch);
BENCHMARK(ray_triangle_scalar);
BENCHMARK(ray_triangle_batch);
BENCHMARK(sphere_aabb_scalar);
BENCHMARK(sphere_aabb_batch);
BENCHMARK(obb_obb_scalar)->Arg(1)->Arg(3)->Arg(6);
BENCHMARK(obb_obb_batch)->Arg(1)->Arg(3)->Arg(6);
BENCHMARK(point_triangle_scalar);
BENCHMARK(point_triangle_batch);

}  // namespace

int main(int argc, char** argv) {
    if (const char* width = std::getenv("CAROM_BENCH_WIDTH")) set_simd_width(std::atoi(width));
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
