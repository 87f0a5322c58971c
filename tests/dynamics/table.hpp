// A world with a plane for a ground, which most tests of worlds begin with.
//
//   Table table;
//   const BodyId box = table.add({.position = {0, 1, 0}}, Box{});
//   table.run(60);
#pragma once

#include <carom/dynamics/world.hpp>

#include <utility>

namespace carom::test {

inline constexpr double kDt = 1.0 / 60.0;

struct Table {
    World world;
    BodyId ground;
    ShapeId ground_shape;

    explicit Table(const WorldDef& def = {}, float friction = 0.6f) : world(def) {
        ground = world.create_body({.type = BodyType::Static, .name = "ground"});
        ground_shape = world.add_shape(ground, Plane{{0, 1, 0}, 0}, {.friction = friction});
    }
    BodyId add(const BodyDef& body, Shape shape, const ShapeDef& def = {}) {
        const BodyId id = world.create_body(body);
        world.add_shape(id, std::move(shape), def);
        return id;
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) world.step(kDt);
    }
};

}  // namespace carom::test
