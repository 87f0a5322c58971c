#include <carom/scenes/meshes.hpp>

#include <carom/collision/teapot.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/scenes/bumpy.hpp>

#include <fmt/format.h>

#include <functional>
#include <vector>

namespace carom::scenes {
namespace {

struct Recipe {
    MeshInfo info;
    std::function<Result<MeshData>()> make;
};

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all{
        {{"teapot", "the Utah teapot, 1 m from handle to spout, within 0.5 mm of its patches; open at rim, handle and spout"},
         [] { return teapot(1.0, 5e-4); }},
        {{"terrain", "fractal hills of 64 x 64 m, 32,768 triangles; open at its border"},
         []() -> Result<MeshData> { return diamond_square({.level = 7, .height = 3.0, .seed = 7}); }},
        {{"bumpy", "a ball of bumps, 69,312 triangles, closed"}, []() -> Result<MeshData> { return bumpy(kBumpy70k); }},
        {{"bumpy1m", "the same with 1,002,252 triangles"}, []() -> Result<MeshData> { return bumpy(kBumpy1m); }},
    };
    return all;
}

}  // namespace

std::span<const MeshInfo> mesh_catalogue() {
    static const std::vector<MeshInfo> infos = [] {
        std::vector<MeshInfo> out;
        for (const Recipe& recipe : recipes()) {
            out.push_back(recipe.info);
        }
        return out;
    }();
    return infos;
}

Result<MeshData> make_mesh(const std::string& name) {
    std::string names;
    for (const Recipe& recipe : recipes()) {
        if (recipe.info.name == name) {
            Result<MeshData> mesh = recipe.make();
            return mesh ? Result<MeshData>(weld(*mesh)) : mesh;
        }
        names += (names.empty() ? "" : ", ") + recipe.info.name;
    }
    return Error{ErrorCode::UnknownName, fmt::format("no mesh is called \"{}\"; there are {}", name, names), "mesh"};
}

}  // namespace carom::scenes
