// Google Benchmark of World::step on scenes that have come to rest.
//
//   bench_step --benchmark_filter=pile
#include <carom/scenes/scene.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <ctime>
#include <vector>

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

// The first step of wall_fast again and again: all balls are followed, and 21 of them meet the wall.
struct WallStep {
    SceneRun run;
    std::vector<carom::BodyId> balls;
    std::vector<carom::Pose> poses;
    std::vector<carom::dvec3> velocities;

    WallStep(bool followed, double towards) : run(carom::scenes::make_scene("wall_fast", options(followed)).value()) {
        for (const carom::BodyId body : run.world.bodies()) {
            if (run.world.type(body) != carom::BodyType::Dynamic) continue;
            balls.push_back(body);
            poses.push_back(run.world.pose(body));
            velocities.push_back(towards * run.world.linear_velocity(body));
        }
    }
    static carom::scenes::SceneOptions options(bool followed) {
        carom::scenes::SceneOptions options;
        options.world.continuous.enabled = followed;
        return options;
    }
    // In seconds of CPU time.
    double step() {
        for (std::size_t i = 0; i < balls.size(); ++i) {
            run.world.set_pose(balls[i], poses[i]);
            run.world.set_linear_velocity(balls[i], velocities[i]);
            run.world.set_angular_velocity(balls[i], carom::dvec3{0.0});
        }
        const double start = cpu_now();
        benchmark::DoNotOptimize(run.world.step(run.dt).contacts);
        return cpu_now() - start;
    }
    static double cpu_now() {
        timespec now{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }
};

void step_wall_fast(benchmark::State& state, double towards) {
    WallStep followed(true, towards), discrete(false, towards);
    double with = 0.0, without = 0.0;
    for (auto _ : state) {  // in turns
        const double time = followed.step();
        with += time;
        without += discrete.step();
        state.SetIterationTime(time);
    }
    state.counters["times_without"] = with / without;
}

BENCHMARK_CAPTURE(step_wall_fast, at_it, 1.0)->Name("step/wall_fast/200")->UseManualTime()->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step_wall_fast, away, -1.0)->Name("step/wall_fast_away/200")->UseManualTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(step_pile_boxes)->Name("step/pile_boxes/1000")->Unit(benchmark::kMillisecond);
BENCHMARK(step_pyramid)->Name("step/pyramid/40")->Unit(benchmark::kMillisecond);

}  // namespace
