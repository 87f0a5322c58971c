#include <carom/cli/cast_target.hpp>

#include <carom/cli/scene_arguments.hpp>

#include <carom/collision/import/read_mesh.hpp>
#include <carom/scenes/meshes.hpp>
#include <carom/studies/accuracy/study.hpp>
#include <carom/viz/layer.hpp>
#include <carom/viz/make_debug_frame.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace carom::cli {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Of a welded mesh: whether each edge is run along once in each direction.
bool is_closed(const MeshData& data) {
    std::vector<Edge> forward, backward;
    for (const auto& t : data.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            forward.emplace_back(t[k], t[(k + 1) % 3]);
            backward.emplace_back(t[(k + 1) % 3], t[k]);
        }
    }
    std::ranges::sort(forward);
    std::ranges::sort(backward);
    return forward == backward && std::ranges::adjacent_find(forward) == forward.end();
}

Result<CastTarget> mesh_target(const std::string& name, Result<MeshData> data, Executor& executor) {
    if (!data) return data.error();
    if (data->triangles.empty()) return Error{ErrorCode::Empty, "has no triangle with three different corners", name};
    const accuracy::Stopwatch watch;
    Result<StaticBvh> bvh = StaticBvh::build(data->vertices, data->triangles, executor);
    const double build_s = watch.seconds();
    if (!bvh) return bvh.error();
    CastTarget target{name, std::nullopt, std::nullopt, bvh->bounds()};
    const bool closed = is_closed(*data);
    target.mesh.emplace(MeshTarget{std::move(*data), std::move(*bvh), build_s, closed});
    return target;
}

Result<CastTarget> scene_target(const std::string& name, std::optional<int> bodies, Executor& executor) {
    scenes::SceneOptions options;
    options.bodies = bodies;
    options.world.executor = &executor;
    Result<scenes::SceneRun> run = is_path(name) ? scenes::read_scene(name, options) : scenes::make_scene(name, options);
    if (!run) return run.error();
    run->before_step(0);
    RayScene rays(run->world);
    if (is_empty(rays.bounds())) return Error{ErrorCode::Empty, "has no bounded shape to cast rays at", name};
    CastTarget target{run->name, std::nullopt, std::nullopt, rays.bounds()};
    target.scene.emplace(SceneTarget{std::move(*run), std::move(rays)});
    return target;
}

// The mesh's vertices as what a camera frames.
DebugFrame frame_of(const MeshTarget& mesh, const Aabb& bounds) {
    DebugFrame frame;
    frame.origin = 0.5 * (bounds.lower + bounds.upper);
    DebugLayer& layer = frame.layers.emplace_back();
    layer.name = to_string(Layer::Shapes);
    for (const vec3& v : mesh.data.vertices) {
        layer.vertices.push_back({vec3(dvec3(v) - frame.origin), {0.0f, 1.0f, 0.0f}});
    }
    return frame;
}

}  // namespace

Result<CastTarget> load_target(const std::string& name, std::optional<int> bodies, Executor& executor) {
    const auto named = [&](const auto& info) { return info.name == name; };
    const bool mesh = std::ranges::any_of(scenes::mesh_catalogue(), named) || mesh_format(name);
    if (mesh && bodies) return Error{ErrorCode::InvalidArgument, "only scenes have bodies", "--bodies"};
    if (std::ranges::any_of(scenes::mesh_catalogue(), named)) return mesh_target(name, scenes::make_mesh(name), executor);
    if (mesh_format(name)) {
        const Result<MeshData> data = read_mesh(name);
        return mesh_target(name, data ? Result<MeshData>(weld(*data)) : data, executor);
    }
    if (is_path(name) || std::ranges::any_of(scenes::catalogue(), named)) return scene_target(name, bodies, executor);
    std::string meshes, scene_names;
    for (const scenes::MeshInfo& info : scenes::mesh_catalogue()) {
        meshes += (meshes.empty() ? "" : ", ") + info.name;
    }
    for (const scenes::SceneInfo& info : scenes::catalogue()) {
        scene_names += (scene_names.empty() ? "" : ", ") + info.name;
    }
    return Error{ErrorCode::UnknownName,
                 fmt::format("no mesh or scene is called \"{}\"; there are the meshes {}, the scenes {}, and files that end in .obj, "
                             ".off, .ply, .stl, .gltf, .glb or .json",
                             name, meshes, scene_names),
                 "MESH|SCENE"};
}

Camera camera_for(const CastTarget& target, double aspect) {
    return automatic_camera(target.mesh ? frame_of(*target.mesh, target.bounds) : make_debug_frame(target.scene->run.world), aspect);
}

}  // namespace carom::cli
