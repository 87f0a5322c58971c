// Google Benchmark of World::step on scenes that have come to rest.
//
//   bench_step --benchmark_filter=pile
#include <carom/scenes/scene.hpp>

#include <benchmark/benchmark.h>

namespace {

using carom::scenes::SceneRun;

// Each iteration is one step; the scene goes on where the last one left it, so that what is timed is a pile at rest.
void step(benchmark::State& state, SceneRun& run) {
    carom::StepReport report;
    for (auto _ : state) {
        report = run.world.step(run.dt);
        benchmark::DoNotOptimize(report.contacts);
    }
    state.counters["contacts"] = static_cast<double>(report.contacts);
    state.counters["bodies"] = static_cast<double>(run.world.body_count());
}

void settle(SceneRun& run, int steps) {
    for (int i = 0; i < steps; ++i) run.world.step(run.dt);
}

void step_pile_boxes(benchmark::State& state) {
    static SceneRun run = [] {
        SceneRun pile = carom::scenes::make_scene("pile_boxes", {.bodies = 1000}).value();
        settle(pile, 300);
        return pile;
    }();
    step(state, run);
}

void step_pyramid(benchmark::State& state) {
    static SceneRun run = [] {
        SceneRun pyramid = carom::scenes::make_scene("pyramid").value();
        settle(pyramid, 60);
        return pyramid;
    }();
    step(state, run);
}

BENCHMARK(step_pile_boxes)->Name("step/pile_boxes/1000")->Unit(benchmark::kMillisecond);
BENCHMARK(step_pyramid)->Name("step/pyramid/40")->Unit(benchmark::kMillisecond);

}  // namespace
