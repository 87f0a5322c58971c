#include <carom/studies/accuracy/scene_bodies.hpp>

#include <stdexcept>

namespace carom::accuracy {
namespace {

MovingBody read_moving(const World& world, BodyId id) {
    const auto shapes = world.shapes(id);
    if (shapes.size() != 1 || world.shape_def(shapes[0]).local != Pose{}) {
        throw std::invalid_argument("scene_bodies: a dynamic body needs one shape, at the body's origin");
    }
    const MassProperties properties = world.mass_properties(id);
    const PrincipalAxes axes = principal_axes(properties.inertia);
    const Pose mass_in_body{properties.center, axes.orientation};
    const ShapeDef& def = world.shape_def(shapes[0]);
    return {.shape = world.shape(shapes[0]),
            .shape_in_mass = inverse(mass_in_body),
            .pose = world.pose(id) * mass_in_body,
            .mass = properties.mass,
            .moments = axes.moments,
            .linear_velocity = world.linear_velocity(id),
            .angular_velocity = world.angular_velocity(id),
            .friction = def.friction,
            .restitution = def.restitution};
}

}  // namespace

SceneBodies scene_bodies(const World& world) {
    SceneBodies out{.gravity = world.settings().gravity, .fixed = {}, .moving = {}};
    for (const BodyId id : world.bodies()) {
        switch (world.type(id)) {
            case BodyType::Dynamic: out.moving.push_back(read_moving(world, id)); break;
            case BodyType::Static:
                for (const ShapeId shape : world.shapes(id)) {
                    const ShapeDef& def = world.shape_def(shape);
                    out.fixed.push_back({world.shape(shape), world.shape_pose(shape), def.friction, def.restitution});
                }
                break;
            case BodyType::Kinematic: throw std::invalid_argument("scene_bodies: kinematic bodies are not compared");
        }
    }
    return out;
}

std::vector<BodyId> moving_bodies(const World& world) {
    std::vector<BodyId> ids;
    for (const BodyId id : world.bodies()) {
        if (world.type(id) == BodyType::Dynamic) ids.push_back(id);
    }
    return ids;
}

}  // namespace carom::accuracy
