// Google Benchmark of moving spheres and capsules: against primitives one pair at a time and the batch over the same 4,096 pairs, and spheres against a mesh of
// 69,312 triangles.
//
//   bench_sweeps --benchmark_enable_random_interleaving=true --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
//   CAROM_BENCH_WIDTH=8 bench_sweeps                 with AVX2, four doubles at a time
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/sweep.hpp>
#include <carom/scenes/bumpy.hpp>

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <vector>

namespace {

using namespace carom;

constexpr std::size_t kCount = 4096;

template <class T>
glm::vec<3, T> point(Random& random, double size) {
    return glm::vec<3, T>(dvec3{random.range(-size, size), random.range(-size, size), random.range(-size, size)});
}

template <class T>
void make(Random& random, geo::Plane<T>& p) {
    p = {point<T>(random, 1.0), T(random.range(-1.0, 0.0))};
}
template <class T>
void make(Random& random, geo::Sphere<T>& s) {
    s = {point<T>(random, 1.0), T(random.range(0.0, 0.4))};
}
template <class T>
void make(Random& random, geo::Capsule<T>& c) {
    c = {{point<T>(random, 1.0), point<T>(random, 1.0)}, T(random.range(0.0, 0.4))};
}
template <class T>
void make(Random& random, geo::Cylinder<T>& c) {
    c = {{point<T>(random, 1.0), point<T>(random, 1.0)}, T(random.range(0.05, 0.4))};
}
template <class T>
void make(Random& random, geo::Aabb<T>& b) {
    const auto p = point<T>(random, 1.0), q = point<T>(random, 1.0);
    b = {glm::min(p, q), glm::max(p, q)};
}
template <class T>
void make(Random& random, geo::Obb<T>& b) {
    const dquat q = rotation_from_vector(point<double>(random, 3.0));
    b = {.center = point<T>(random, 1.0),
         .half_extents = glm::abs(point<T>(random, 0.7)),
         .axes = glm::mat<3, 3, T>(dmat3{rotate(q, dvec3{1, 0, 0}), rotate(q, dvec3{0, 1, 0}), rotate(q, dvec3{0, 0, 1})})};
}
template <class T>
void make(Random& random, geo::Triangle<T>& t) {
    t = {point<T>(random, 1.0), point<T>(random, 1.0), point<T>(random, 1.0)};
}

template <class T>
void move(geo::Sphere<T>& s, const glm::vec<3, T>& by) {
    s.center += by;
}
template <class T>
void move(geo::Capsule<T>& c, const glm::vec<3, T>& by) {
    c.axis.a += by, c.axis.b += by;
}

// Ways of up to 8 m through the middle of a cube of 2 m with sizes near one in it: `hits` says which part touches.
template <class A, class B, class T>
struct Pairs {
    std::vector<A> a{kCount};
    std::vector<glm::vec<3, T>> motions{kCount};
    std::vector<B> b{kCount};
    std::vector<BasicImpact<T>> out{kCount};

    Pairs() {
        Random random(0x5eeb);
        for (std::size_t i = 0; i < kCount; ++i) {
            make(random, a[i]), make(random, b[i]);
            motions[i] = point<T>(random, i % 4 == 0 ? 1.0 : 5.0);
            move(a[i], T(-0.5) * motions[i]);
        }
    }
    void report(benchmark::State& state) const {
        std::size_t hits = 0;
        for (const BasicImpact<T>& impact : out) hits += may_touch(impact.status) ? 1 : 0;
        state.counters["hits"] = double(hits) / double(kCount);
        state.SetItemsProcessed(state.iterations() * std::int64_t(kCount));
    }
};

template <class A, class B, class T>
void single(benchmark::State& state) {
    Pairs<A, B, T> pairs;
    for (auto _ : state) {
        for (std::size_t i = 0; i < kCount; ++i) pairs.out[i] = geo::sweep(pairs.a[i], pairs.motions[i], pairs.b[i]);
        benchmark::ClobberMemory();
    }
    pairs.report(state);
}
template <class A, class B, class T>
void batch(benchmark::State& state) {
    Pairs<A, B, T> pairs;
    for (auto _ : state) {
        geo::sweep<A, B, T>(pairs.a, pairs.motions, pairs.b, pairs.out);
        benchmark::ClobberMemory();
    }
    pairs.report(state);
}

#define CAROM_BOTH(A, B)                                       \
    BENCHMARK(single<geo::A<double>, geo::B<double>, double>); \
    BENCHMARK(batch<geo::A<double>, geo::B<double>, double>);  \
    BENCHMARK(single<geo::A<float>, geo::B<float>, float>);    \
    BENCHMARK(batch<geo::A<float>, geo::B<float>, float>);
CAROM_BOTH(Sphere, Plane)
CAROM_BOTH(Sphere, Sphere)
CAROM_BOTH(Sphere, Capsule)
CAROM_BOTH(Sphere, Aabb)
CAROM_BOTH(Sphere, Obb)
CAROM_BOTH(Sphere, Triangle)
CAROM_BOTH(Sphere, Cylinder)
CAROM_BOTH(Capsule, Plane)
CAROM_BOTH(Capsule, Sphere)
CAROM_BOTH(Capsule, Capsule)
CAROM_BOTH(Capsule, Aabb)
CAROM_BOTH(Capsule, Obb)
CAROM_BOTH(Capsule, Triangle)
BENCHMARK(single<geo::Capsule<double>, geo::Cylinder<double>, double>);

dvec3 direction(Random& random) {
    for (;;) {
        const dvec3 p = point<double>(random, 1.0);
        const double length = glm::length(p);
        if (length > 0.1 && length < 1.0) return p / length;
    }
}

// From 2 m off the middle of a ball of bumps of about 1 m, through a point in or about it; the argument is the radius in mm.
void mesh(benchmark::State& state) {
    const MeshData data = scenes::bumpy(scenes::kBumpy70k);
    const TriangleMeshPtr onto = *TriangleMesh::build(data.vertices, data.triangles);
    Random random(5);
    std::vector<geo::Sphere<double>> balls;
    std::vector<dvec3> motions;
    for (std::size_t i = 0; i < kCount; ++i) {
        const dvec3 from = 2.0 * direction(random), through = 1.2 * random.unit() * direction(random);
        balls.push_back({from, 1e-3 * double(state.range(0))});
        motions.push_back(2.0 * (through - from));
    }
    std::size_t hits = 0;
    for (auto _ : state) {
        hits = 0;
        for (std::size_t i = 0; i < kCount; ++i) hits += may_touch(geo::sweep(balls[i], motions[i], *onto).status) ? 1 : 0;
    }
    state.counters["hits"] = double(hits) / double(kCount);
    state.SetItemsProcessed(state.iterations() * std::int64_t(kCount));
}
BENCHMARK(mesh)->Arg(0)->Arg(3)->Arg(10)->Arg(50);

}  // namespace

int main(int argc, char** argv) {
    if (const char* width = std::getenv("CAROM_BENCH_WIDTH")) set_simd_width(std::atoi(width));
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
