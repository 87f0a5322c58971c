#include <carom/scenes/detail/recipe.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <array>
#include <utility>

namespace carom::scenes::detail {

WorldDef Request::world_def(const dvec3& gravity) const {
    WorldDef def = world;
    def.gravity = gravity;
    return def;
}

ShapeDef scene_matter() { return {.density = 1000.0, .friction = 0.6f, .restitution = 0.0f}; }

BodyId add_body(World& world, const BodyDef& body, Shape shape, const ShapeDef& matter) {
    const BodyId id = world.create_body(body);
    world.add_shape(id, std::move(shape), matter);
    // A shape whose centre of mass is off its origin changed the velocity of that centre when it was added.
    if (body.type == BodyType::Dynamic) world.set_linear_velocity(id, body.linear_velocity);
    return id;
}

BodyId add_static_box(World& world, const dvec3& center, const dvec3& half_extents, const char* name) {
    return add_body(world, {.type = BodyType::Static, .position = center, .name = name}, Box{vec3(half_extents)});
}

void add_room(World& world, double half_width, double height) {
    const double outer = half_width + 1.0;
    const double middle = half_width + 0.5;
    add_static_box(world, {0.0, -0.5, 0.0}, {outer, 0.5, outer}, "floor");
    add_static_box(world, {-middle, 0.5 * height, 0.0}, {0.5, 0.5 * height, outer}, "wall -x");
    add_static_box(world, {middle, 0.5 * height, 0.0}, {0.5, 0.5 * height, outer}, "wall +x");
    add_static_box(world, {0.0, 0.5 * height, -middle}, {outer, 0.5 * height, 0.5}, "wall -z");
    add_static_box(world, {0.0, 0.5 * height, middle}, {outer, 0.5 * height, 0.5}, "wall +z");
}

dvec3 draw_half_extents(Random& random) {
    dvec3 half{0.0};
    for (int axis = 0; axis < 3; ++axis) half[axis] = random.range(0.25, 0.5);
    return half;
}

void draw_yaw_and_spin(Random& random, BodyDef& body) {
    body.orientation = rotation_about({0.0, 1.0, 0.0}, random.range(0.0, 2.0 * kPi));
    for (int axis = 0; axis < 3; ++axis) body.angular_velocity[axis] = random.range(-2.0, 2.0);
}

Shape draw_hull(Random& random, double smallest, double largest) {
    const double radius = random.range(smallest, largest);
    std::array<vec3, 12> points{};
    for (vec3& point : points) {
        dvec3 p{0.0};
        double length = 0.0;
        do {
            for (int axis = 0; axis < 3; ++axis) p[axis] = random.range(-1.0, 1.0);
            length = glm::length(p);
        } while (length > 1.0 || length < 0.1);
        point = vec3(p * (radius / length));
    }
    Result<ConvexHullPtr> hull = ConvexHull::build(points);
    CAROM_ASSERT(hull.has_value());  // twelve random points of a sphere are never coplanar
    return *hull;
}

}  // namespace carom::scenes::detail
