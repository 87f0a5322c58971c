#include <carom/scenes/scene.hpp>

#include <carom/scenes/detail/recipe.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace carom::scenes {
namespace {

using detail::Recipe;
using detail::Request;

/// The one table of scenes.
const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> table = [] {
        std::vector<Recipe> all = detail::teapots_recipes();
        const auto append = [&](std::vector<Recipe> family) {
            for (Recipe& recipe : family) all.push_back(std::move(recipe));
        };
        append(detail::stack_recipes());
        append(detail::pile_recipes());
        append({detail::mesh_bowl_recipe()});
        append(detail::free_recipes());
        append({detail::dominoes_recipe(), detail::fountain_recipe()});
        return all;
    }();
    return table;
}

Result<double> parse_parameter(const SceneParameter& parameter, const std::string& text) {
    const std::string where = "set " + parameter.name;
    double value = 0.0;
    const char* end = text.data() + text.size();
    const std::from_chars_result parsed = std::from_chars(text.data(), end, value);
    if (text.empty() || parsed.ec == std::errc::invalid_argument || parsed.ptr != end) {
        return Error{ErrorCode::WrongType, fmt::format("\"{}\" is not a number", text), where};
    }
    if (parsed.ec != std::errc{} || !is_finite(value)) {
        return Error{ErrorCode::NotFinite, fmt::format("\"{}\" is not a finite number", text), where};
    }
    if (value < parameter.lower || value > parameter.upper) {
        return Error{
            ErrorCode::InvalidArgument,
            fmt::format("{} is outside {}..{} ({})", text, parameter.lower, parameter.upper, parameter.meaning), where};
    }
    return value;
}

Status read_parameters(const Recipe& recipe, const SceneOptions& options, Request& request) {
    for (const SceneParameter& parameter : recipe.info.parameters) {
        request.values[parameter.name] = parameter.value;
        request.given[parameter.name] = false;
    }
    for (const auto& [key, text] : options.set) {
        const auto& declared = recipe.info.parameters;
        const auto found = std::ranges::find(declared, key, &SceneParameter::name);
        if (found == declared.end()) {
            return Error{ErrorCode::UnknownName, fmt::format("{} has no parameter \"{}\"", recipe.info.name, key),
                         "set " + key};
        }
        const Result<double> value = parse_parameter(*found, text);
        if (!value) return value.error();
        request.values[key] = *value;
        request.given[key] = true;
    }
    return {};
}

Result<Request> check(const Recipe& recipe, const SceneOptions& options) {
    Request request;
    request.bodies = options.bodies.value_or(recipe.info.bodies);
    request.bodies_given = options.bodies.has_value();
    if (request.bodies < recipe.fewest_bodies || request.bodies > recipe.most_bodies) {
        return Error{ErrorCode::InvalidArgument,
                     fmt::format("{} can have {}..{} bodies, not {}", recipe.info.name, recipe.fewest_bodies,
                                 recipe.most_bodies, request.bodies),
                     "bodies"};
    }
    request.seed = options.seed.value_or(recipe.seed);
    request.world = options.world;
    request.world.substeps = options.substeps.value_or(options.world.substeps);
    if (request.world.substeps < 1 || request.world.substeps > 1024) {
        return Error{ErrorCode::InvalidArgument, fmt::format("{} is outside 1..1024", request.world.substeps),
                     "substeps"};
    }
    if (Status status = validate(request.world); !status) return status.error();
    const Status parameters = read_parameters(recipe, options, request);
    if (!parameters) return parameters.error();
    return request;
}

}  // namespace

std::span<const SceneInfo> catalogue() {
    static const std::vector<SceneInfo> infos = [] {
        std::vector<SceneInfo> all;
        for (const Recipe& recipe : recipes()) all.push_back(recipe.info);
        return all;
    }();
    return infos;
}

Result<SceneRun> make_scene(const std::string& name, const SceneOptions& options) {
    for (const Recipe& recipe : recipes()) {
        if (recipe.info.name != name) continue;
        const Result<Request> request = check(recipe, options);
        if (!request) return request.error();
        return recipe.build(*request);
    }
    return Error{ErrorCode::UnknownName, fmt::format("no scene is called \"{}\"", name), "scene"};
}

int count_escaped(const World& world, const Aabb& domain) {
    if (is_empty(domain)) return 0;
    int count = 0;
    for (const BodyId body : world.bodies()) {
        if (world.type(body) != BodyType::Dynamic) continue;
        const dvec3 center = world.center_of_mass(body);
        const bool inside =
            glm::all(glm::greaterThanEqual(center, domain.lower)) && glm::all(glm::lessThanEqual(center, domain.upper));
        if (!inside) ++count;
    }
    return count;
}

}  // namespace carom::scenes
