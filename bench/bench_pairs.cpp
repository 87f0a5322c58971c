// Google Benchmark of contacts between simple shapes: a batch of 1,000 pairs against the same pairs one at a time.
//
//   bench_pairs --benchmark_filter=capsule_box
//   CAROM_BENCH_WIDTH=8 bench_pairs             the batches with 8 lanes (AVX2)
//
// Two shapes a pair, of 0.2 to 1 m, as near each other as a broadphase lists them; `touching` is the share of the pairs that have a manifold.
#include <carom/core/executor.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/collide.hpp>

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

namespace {

using namespace carom;

constexpr int kCount = 1000;

dvec3 point(Random& random, double size) { return {random.range(-size, size), random.range(-size, size), random.range(-size, size)}; }

Shape make_shape(ShapeType type, Random& random) {
    const auto size = [&](double low, double high) { return static_cast<float>(random.range(low, high)); };
    switch (type) {
        case ShapeType::Sphere:
            return Sphere{size(0.2, 0.5)};
        case ShapeType::Capsule:
            return Capsule{size(0.1, 0.25), size(0.1, 0.25)};
        case ShapeType::Box:
            return Box{{size(0.1, 0.5), size(0.1, 0.5), size(0.1, 0.5)}};
        default:
            return Plane{{0, 1, 0}, 0};
    }
}

struct Pairs {
    std::vector<Shape> shapes;
    std::vector<const Shape*> placed;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;

    Pairs(ShapeType a, ShapeType b) {
        Random random(0xbe7);
        for (int i = 0; i < kCount; ++i) {
            for (const ShapeType type : {a, b}) {
                shapes.push_back(make_shape(type, random));
                poses.push_back({point(random, 0.35), rotation_from_vector(point(random, 3.0))});
            }
            if (b == ShapeType::Plane) poses.back() = {};
            pairs.push_back({static_cast<std::uint32_t>(2 * i), static_cast<std::uint32_t>(2 * i + 1), 0.01f});
        }
        for (const Shape& shape : shapes) placed.push_back(&shape);
    }
};

void report(benchmark::State& state, std::size_t manifolds) {
    state.counters["touching"] = static_cast<double>(manifolds) / kCount;
    state.counters["ns_a_pair"] =
        benchmark::Counter(1e-9 * kCount, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void batch(benchmark::State& state, ShapeType a, ShapeType b) {
    const Pairs input(a, b);
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> manifolds;
    for (auto _ : state) {
        collide({input.placed, input.poses}, input.pairs, executor, scratch, manifolds);
        benchmark::DoNotOptimize(manifolds.data());
    }
    report(state, manifolds.size());
}

void one_by_one(benchmark::State& state, ShapeType a, ShapeType b) {
    const Pairs input(a, b);
    std::vector<Manifold> manifolds;
    for (auto _ : state) {
        manifolds.clear();
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const NumberedPair& p = input.pairs[i];
            collide({input.placed[p.a], input.placed[p.b], input.poses[p.a], input.poses[p.b], p.margin}, i, manifolds);
        }
        benchmark::DoNotOptimize(manifolds.data());
    }
    report(state, manifolds.size());
}

}  // namespace

int main(int argc, char** argv) {
    if (const char* width = std::getenv("CAROM_BENCH_WIDTH")) set_simd_width(std::atoi(width));
    constexpr ShapeType kTypes[] = {ShapeType::Sphere, ShapeType::Capsule, ShapeType::Box, ShapeType::Plane};
    for (std::size_t i = 0; i < std::size(kTypes); ++i) {
        for (std::size_t j = i; j < std::size(kTypes); ++j) {
            const ShapeType a = kTypes[i], b = kTypes[j];
            if (!can_collide(a, b)) continue;
            const std::string name = std::string(to_string(a)) + '_' + std::string(to_string(b));
            benchmark::RegisterBenchmark((name + "/batch").c_str(), batch, a, b);
            benchmark::RegisterBenchmark((name + "/one_by_one").c_str(), one_by_one, a, b);
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
