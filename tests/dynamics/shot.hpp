// A shot at a wall, as tests of what passes through what begin.
//
//   Shot shot({.gravity = dvec3{0.0}, .record_paths = true});
//   shot.fly(3);
#pragma once

#include "table.hpp"

#include <carom/dynamics/explain_sweep.hpp>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace carom::test {

inline constexpr WorldDef kWatched{.gravity = dvec3{0.0}, .record_paths = true};
inline constexpr WorldDef kDiscrete{.gravity = dvec3{0.0}, .record_paths = true, .continuous = {.enabled = false}};
inline const Shape kWall = Box{{5.0f, 5.0f, 0.005f}};
inline constexpr double kHalf = static_cast<double>(0.005f), kRadius = static_cast<double>(0.05f);

inline bool says(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

/// A ball that flies at a wall across z, at 100 m/s from 4.3 m before it: it comes there in the third step.
struct Shot {
    World world;
    BodyId wall, ball;
    std::vector<Passage> passages;
    SweepExplanation last;

    explicit Shot(const WorldDef& def, const BodyDef& of_ball = {}, const Shape& target = kWall, const ShapeDef& matter = {}) : world(def) {
        wall = world.create_body({.type = BodyType::Static});
        world.add_shape(wall, target);
        BodyDef body = of_ball;
        body.position = {0.1, 0.2, -4.3};
        body.linear_velocity = {0.0, 0.0, 100.0};
        ball = world.create_body(body);
        world.add_shape(ball, Sphere{0.05f}, matter);
    }
    Shot& fly(int steps = 4) {
        for (int i = 0; i < steps; ++i) {
            world.step(kDt);
            last = world.explain_sweep(ball, wall);
            EXPECT_TRUE(last.disagreements.empty()) << last.disagreements.front();
            EXPECT_EQ(world.passage(ball, wall).has_value(), last.passage.has_value());
            if (last.passage) passages.push_back(*last.passage);
        }
        return *this;
    }
};

}  // namespace carom::test
