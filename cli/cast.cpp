// carom cast MESH|SCENE|FILE: how fast rays and shapes are, whether any slips through, and a picture of what they see.
#include <carom/cli/build_info.hpp>
#include <carom/cli/cast_rays.hpp>
#include <carom/cli/cast_target.hpp>
#include <carom/cli/choice.hpp>
#include <carom/cli/command.hpp>
#include <carom/cli/make_executor.hpp>
#include <carom/cli/picture_size.hpp>
#include <carom/cli/progress.hpp>
#include <carom/cli/scene_arguments.hpp>

#include <carom/collision/mesh_rays.hpp>
#include <carom/core/hash.hpp>
#include <carom/core/output_file.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/viz/png/png_file.hpp>
#include <carom/viz/ray_picture.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <glm/geometric.hpp>

#include <limits>
#include <memory>
#include <optional>
#include <string>

namespace carom::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostRays = 10'000'000'000;

struct CastOptions {
    std::string target;
    std::optional<int> bodies;
    CastSettings settings;
    std::optional<double> radius;  // of the shape that is cast [m]
    int threads = 1;
    std::optional<std::string> json;
    std::string picture;  // empty: none
    std::string size = "800x500";
    RayView view = RayView::Depth;
};

Result<Image> draw(const CastTarget& target, const PictureSize& size, RayView view, Executor& executor) {
    RayPictureSettings settings{.width = size.width, .height = size.height, .view = view, .executor = &executor};
    settings.camera = camera_for(target, static_cast<double>(size.width) / size.height);
    if (target.scene) return draw_rays(target.scene->rays, settings);
    const MeshTarget& mesh = *target.mesh;
    const auto cast = [&](const Ray& ray) -> std::optional<PixelHit> {
        const MeshHit hit = closest_hit(mesh.bvh, {.origin = vec3(ray.origin), .direction = vec3(ray.direction)});
        if (!hit) return std::nullopt;
        const auto& t = mesh.data.triangles[hit.triangle];
        const dvec3 a(mesh.data.vertices[t[0]]);
        const dvec3 normal = glm::cross(dvec3(mesh.data.vertices[t[1]]) - a, dvec3(mesh.data.vertices[t[2]]) - a);
        const double length = glm::length(normal) * (glm::dot(normal, ray.direction) > 0.0 ? -1.0 : 1.0);
        return PixelHit{static_cast<double>(hit.t), length != 0.0 ? normal / length : -ray.direction, hit.triangle};
    };
    return draw_rays(cast, settings);
}

template <class T>
Json or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json to_json(const CastTarget& target, const CastRecord& record, const CastOptions& options) {
    const bool mesh = target.mesh.has_value();
    return {{"target", target.name},
            {"kind", mesh ? "mesh" : "scene"},
            {"triangles", mesh ? Json(target.mesh->data.triangles.size()) : Json(nullptr)},
            {"closed", mesh ? Json(target.mesh->closed) : Json(nullptr)},
            {"bodies", mesh ? Json(nullptr) : Json(target.scene->run.world.body_count())},
            {"rays", options.settings.rays},
            {"shape", to_string(options.settings.mover)},
            {"radius", record.radius},
            {"aim", options.settings.aim == Aim::Chords ? "chords" : "edges"},
            {"seed", options.settings.seed},
            {"threads", options.threads},
            {"machine", {{"cpu", cpu_model()}, {"cores", cpu_cores()}}},
            {"build", {{"version", version()}, {"compiler", compiler()}, {"type", build_type()}, {"simd_width", simd_width()}}},
            {"build_s", mesh ? Json(target.mesh->build_s) : Json(nullptr)},
            {"time_s", record.time_s},
            {"rays_per_s", record.time_s > 0.0 ? Json(static_cast<double>(options.settings.rays) / record.time_s) : Json(nullptr)},
            {"hits", record.hits},
            {"leaks", or_null(record.leaks)},
            {"late", or_null(record.late)},
            {"answer_hash", to_hex(record.answer_hash)}};
}

std::string counted(std::uint64_t n, const std::string& one, const std::string& many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}
std::string counted(std::uint64_t n, const std::string& one) { return counted(n, one, one + "s"); }

std::string summary(const CastTarget& target, const CastRecord& record, const CastOptions& options) {
    const auto rays = static_cast<double>(options.settings.rays);
    std::string text = fmt::format("{}: ", target.name);
    text += target.mesh ? fmt::format("{}, {}, built in {:.1f} ms\n", counted(target.mesh->data.triangles.size(), "triangle"),
                                      target.mesh->closed ? "closed" : "open", target.mesh->build_s * 1e3)
                        : counted(target.scene->run.world.body_count(), "body", "bodies") + "\n";
    const Mover mover = options.settings.mover;
    if (mover != Mover::Ray) text += fmt::format("cast          {} of radius {:.4g} m\n", to_string(mover), record.radius);
    text += fmt::format("rays          {} {}, seed {}, {}, SIMD width {}\n", options.settings.rays,
                        options.settings.aim == Aim::Chords ? "along chords" : "at edges and corners", options.settings.seed,
                        counted(static_cast<std::uint64_t>(options.threads), "thread"), simd_width());
    text += fmt::format("time          {:.3f} s, {:.3g} million rays a second\n", record.time_s, rays / record.time_s * 1e-6);
    text += fmt::format("hits          {}, {:.2f} %\n", record.hits, 100.0 * static_cast<double>(record.hits) / rays);
    if (record.late) text += fmt::format("late          {}\n", *record.late);
    if (mover == Mover::Ray) text += fmt::format("leaks         {}\n", record.leaks ? fmt::to_string(*record.leaks) : "- (not a closed mesh)");
    return text + fmt::format("answer hash   {}\n", to_hex(record.answer_hash));
}

// What can be said before anything is loaded.
Status check(const CastOptions& options) {
    if (options.radius && !(*options.radius >= 1e-6 && *options.radius <= 1e6)) {
        return Error{ErrorCode::InvalidArgument, fmt::format("{} m is not within 1e-6 .. 1e6 m", *options.radius), "--radius"};
    }
    if (Result<PictureSize> size = parse_picture_size(options.size); !size) return size.error();
    if (options.picture == "-") return Error{ErrorCode::InvalidArgument, "a picture needs a file", "--picture"};
    if (!options.picture.empty()) {
        if (Status status = check_writable(options.picture); !status) return status;
    }
    return options.json ? check_writable(*options.json) : Status{};
}

ExitCode run(const CastOptions& options) {
    if (Status status = check(options); !status) return fail(ExitCode::BadInput, status.error());
    const Result<std::unique_ptr<Executor>> made = make_executor(options.threads);
    if (!made) return fail(ExitCode::BadInput, made.error());
    SerialExecutor serial;
    Executor& executor = *made ? **made : serial;
    const Result<CastTarget> target = load_target(options.target, options.bodies, executor);
    if (!target) return fail(ExitCode::BadInput, target.error());
    if (options.settings.aim == Aim::Edges && !target->mesh) {
        return fail(ExitCode::BadInput, {ErrorCode::InvalidArgument, "only meshes have edges to aim at", "--aim"});
    }
    if (!options.picture.empty()) {
        const Result<Image> image = draw(*target, *parse_picture_size(options.size), options.view, executor);
        if (!image) return fail(ExitCode::BadInput, image.error());
        if (Status status = write_png(*image, options.picture); !status) return fail(ExitCode::Failed, status.error());
    }
    const CastRecord record = [&] {
        constexpr int kTicks = 1000;
        Progress progress(kTicks);
        CastSettings settings = options.settings;
        settings.radius = options.radius.value_or(0.0);
        settings.progress = [&](std::uint64_t done) {
            progress.show(static_cast<int>(static_cast<double>(done) / static_cast<double>(settings.rays) * kTicks));
        };
        return cast_rays(*target, settings, executor);
    }();
    if (options.json) {
        const std::string text = to_json(*target, record, options).dump(2) + "\n";
        if (Status status = write_text(*options.json, text); !status) return fail(ExitCode::Failed, status.error());
    }
    if (options.json != "-") {
        if (Status status = write_text("-", summary(*target, record, options)); !status) return fail(ExitCode::Failed, status.error());
    }
    if (record.leaks.value_or(0) > 0) {
        return fail(ExitCode::Failed, {ErrorCode::InvalidArgument, counted(*record.leaks, "ray") + " leaked", target->name});
    }
    if (record.late.value_or(0) > 0) {
        return fail(ExitCode::Failed, {ErrorCode::InvalidArgument, counted(*record.late, "cast") + " came late", target->name});
    }
    return ExitCode::Ok;
}

}  // namespace

void add_cast_command(CLI::App& app, Action& action) {
    auto options = std::make_shared<CastOptions>();
    CLI::App* command = app.add_subcommand("cast", "Casts rays or shapes at a mesh or a scene: speed, hits, leaks, and a picture.");
    command->add_option("TARGET", options->target, "a mesh, a mesh file (.obj .off .ply .stl .gltf .glb), a scene (see carom list) or a scene file (.json)")->required();
    command->add_option("--bodies", options->bodies, "dynamic bodies of a scene that has a size")
        ->check(whole_number(0, scenes::kMaxSceneBodies));
    command->add_option("--rays", options->settings.rays, "how many")->check(whole_number(1, kMostRays));
    command->add_option("--seed", options->settings.seed, "seed of the rays")
        ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()));
    add_choice<Aim>(*command, "--aim", options->settings.aim, {{"chords", Aim::Chords}, {"edges", Aim::Edges}},
                    "across the sphere round the target, or at edges and corners of a mesh");
    CLI::Option* shape = add_choice<Mover>(*command, "--shape", options->settings.mover,
                                           {{"ray", Mover::Ray}, {"ball", Mover::Ball}, {"capsule", Mover::Capsule}, {"box", Mover::Box}, {"hull", Mover::Hull}},
                                           "what is cast along the rays");
    command->add_option("--radius", options->radius, "of that shape [m], 1e-6 .. 1e6; without it a hundredth of the target's size")->needs(shape);
    command->add_option("--threads", options->threads, "threads; answers do not depend on it")->check(whole_number(1, 256));
    command->add_option("--json", options->json, "write the report into this file; - prints it, and nothing else");
    CLI::Option* picture = command->add_option("--picture", options->picture, "draw what rays see into this PNG file");
    add_choice<RayView>(*command, "--view", options->view,
                        {{"depth", RayView::Depth}, {"normal", RayView::Normal}, {"id", RayView::Id}}, "what the picture shows")
        ->needs(picture);
    command->add_option("--size", options->size, "of the picture [pixels], WIDTHxHEIGHT")->needs(picture);
    command->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace carom::cli
