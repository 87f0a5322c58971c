// How a scene of the catalogue is built: its entry and its builder, and the pieces that builders share.
#pragma once

#include <carom/core/random.hpp>
#include <carom/scenes/scene.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace carom::scenes::detail {

/// What a builder gets: numbers that are in range and complete, so that it need not ask again.
struct Request {
    int bodies = 0;
    bool bodies_given = false;  ///< the user said `bodies`, as opposed to the default
    std::uint64_t seed = 0;
    std::map<std::string, double> values;  ///< one for each declared parameter
    std::map<std::string, bool> given;     ///< the parameters the user set
    WorldDef world{};

    [[nodiscard]] double value(const std::string& parameter) const { return values.at(parameter); }
    /// @return the settings with the scene's own gravity.
    [[nodiscard]] WorldDef world_def(const dvec3& gravity = {0.0, -9.81, 0.0}) const;
};

using Builder = Result<SceneRun> (*)(const Request&);

/// One row of the catalogue.
struct Recipe {
    SceneInfo info;
    std::uint64_t seed = 0;  ///< the default; 0 where nothing is drawn
    int fewest_bodies = 0;
    int most_bodies = kMaxSceneBodies;
    Builder build = nullptr;
};

// One family a file.
[[nodiscard]] std::vector<Recipe> stack_recipes();  // pyramid, tall_stack, mass_ratio
[[nodiscard]] std::vector<Recipe> pile_recipes();   // pile_boxes, pile_mixed
[[nodiscard]] Recipe mesh_bowl_recipe();
[[nodiscard]] std::vector<Recipe> free_recipes();  // wall_fast, single_body_spin
[[nodiscard]] std::vector<Recipe> teapots_recipes();  // teapots, teapot_meshes
[[nodiscard]] Recipe fountain_recipe();
[[nodiscard]] Recipe dominoes_recipe();

/// The matter of every scene: 1000 kg/m³, friction 0.6, restitution 0.
[[nodiscard]] ShapeDef scene_matter();

/// Adds a static box.
BodyId add_static_box(World& world, const dvec3& center, const dvec3& half_extents, const char* name);

/// Adds a body with one shape; `body.linear_velocity` is that of the centre of mass.
BodyId add_body(World& world, const BodyDef& body, Shape shape, const ShapeDef& matter = scene_matter());

/// Floor and four walls, 1 m thick, round the space |x|, |z| <= half_width, y from 0 to `height`.
void add_room(World& world, double half_width, double height);

/// Draws half extents in [.25, .5), one after the other.
[[nodiscard]] dvec3 draw_half_extents(Random& random);

/// Draws the yaw, then the angular velocity, into `body`.
void draw_yaw_and_spin(Random& random, BodyDef& body);

/// Draws a hull of 12 points on a sphere: its radius in [smallest, largest), then each point in the cube [-1, 1)³,
/// again while its length is over 1 or under 0.1.
[[nodiscard]] Shape draw_hull(Random& random, double smallest, double largest);

}  // namespace carom::scenes::detail
