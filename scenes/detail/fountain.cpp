// A fountain: a new body every few steps, and the oldest removed once there are enough.
#include <carom/scenes/detail/recipe.hpp>

#include <carom/core/math.hpp>

#include <deque>
#include <utility>

namespace carom::scenes::detail {
namespace {

constexpr int kPeriod = 4;          // steps between two bodies
constexpr double kHalfWidth = 8.0;  // of the basin [m]
constexpr double kWall = 6.0;       // height of its walls [m]
constexpr double kSpeed = 9.0;  // upwards, at the nozzle [m/s]: 0.6 m between two bodies, which are smaller than that

/// Everything that the fountain remembers from one step to the next.
struct Nozzle {
    Random random;
    int capacity = 0;
    int emitted = 0;
    std::deque<BodyId> alive;

    void operator()(World& world, int step) {
        if (step % kPeriod != 0 || capacity == 0) return;
        if (static_cast<int>(alive.size()) == capacity) {
            world.destroy_body(alive.front());
            alive.pop_front();
        }
        const double size = random.range(0.15, 0.25);
        const double azimuth = random.range(0.0, 2.0 * kPi);
        const double spread = random.range(0.5, 2.5);
        BodyDef body;
        body.position = {0.0, 1.5, 0.0};
        body.linear_velocity = {spread * sin_cos(azimuth).cos, kSpeed, spread * sin_cos(azimuth).sin};
        draw_yaw_and_spin(random, body);
        alive.push_back(add_body(world, body, shape(size)));
        ++emitted;
    }

    [[nodiscard]] Shape shape(double size) const {
        const float s = static_cast<float>(size);
        switch (emitted % 3) {
            case 0:
                return Sphere{s};
            case 1:
                return Box{vec3{s, 0.8f * s, 0.6f * s}};
            default:
                return Capsule{0.6f * s, 0.4f * s};
        }
    }
};

Result<SceneRun> build_fountain(const Request& request) {
    SceneRun run{.name = "fountain", .seed = request.seed, .world = World(request.world_def())};
    run.steps = 1200;
    run.domain = {{-kHalfWidth - 0.5, -0.5, -kHalfWidth - 0.5}, {kHalfWidth + 0.5, 20.0, kHalfWidth + 0.5}};
    add_room(run.world, kHalfWidth, kWall);
    run.emitter = Nozzle{.random = Random(request.seed), .capacity = request.bodies, .emitted = 0, .alive = {}};
    return run;
}

}  // namespace

Recipe fountain_recipe() {
    return {
        .info = {.name = "fountain",
                 .summary = "an emitter: a body every 4 steps, the oldest removed once there are as many as asked for",
                 .bodies = 200,
                 .steps = 1200,
                 .parameters = {}},
        .seed = 2024,
        .build = build_fountain};
}

}  // namespace carom::scenes::detail
