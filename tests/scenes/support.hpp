// What several tests of scenes need.
#pragma once

#include <carom/core/random.hpp>
#include <carom/scenes/scene.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace carom::test {

/// The scene, or a failed test that says why.
inline scenes::SceneRun scene(const std::string& name, const scenes::SceneOptions& options = {}) {
    Result<scenes::SceneRun> run = scenes::make_scene(name, options);
    if (!run) throw std::runtime_error(name + ": " + run.error().message);
    return std::move(run).value();
}

inline std::vector<BodyId> dynamic_bodies(const World& world) {
    std::vector<BodyId> found;
    for (const BodyId body : world.bodies()) {
        if (world.type(body) == BodyType::Dynamic) found.push_back(body);
    }
    return found;
}

inline const Shape& first_shape(const World& world, BodyId body) { return world.shape(world.shapes(body)[0]); }

inline void step(scenes::SceneRun& run, int steps) {
    for (int i = 0; i < steps; ++i) {
        run.before_step(i);
        run.world.step(run.dt);
    }
}

/// A rotation drawn uniformly: a point of the 4-ball, normalised.
inline dquat draw_rotation(Random& random) {
    for (;;) {
        const dquat q{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        const double length = glm::length(q);
        if (length > 0.1 && length <= 1.0) return q / length;
    }
}

inline dvec3 draw_vector(Random& random, double size) {
    dvec3 v{0.0};
    for (int axis = 0; axis < 3; ++axis) v[axis] = random.range(-size, size);
    return v;
}

inline void expect_near(const dvec3& a, const dvec3& b, double tolerance) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance) << "axis " << axis;
}

}  // namespace carom::test
