// The studies "rays": casts against meshes whose every answer is known exactly, and against ever finer meshes of a ball.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/ray_problem.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/core/random.hpp>
#include <carom/scenes/bumpy.hpp>

#include <fmt/format.h>

#include <glm/geometric.hpp>

#include <cmath>

namespace carom::accuracy {
namespace {

constexpr const char* kStage = "primitive and ray tests";
constexpr const char* kError = "share of wrong verdicts, and the mean relative error of the distance otherwise";

// Casts every ray of the problem.
Candidate candidate(const RayCaster& caster, std::shared_ptr<const RayProblem> problem) {
    std::vector<RayCaster::Cast> casts;
    for (const RayCases& part : problem->parts) {
        casts.push_back(caster.prepare(part));
    }
    return {caster.who, caster.settings, [problem, casts] {
                std::vector<RayAnswers> answers(problem->parts.size());
                for (std::size_t p = 0; p < answers.size(); ++p) {
                    answers[p].resize(problem->parts[p].rays.size());
                }
                const Stopwatch watch;
                for (std::size_t p = 0; p < answers.size(); ++p) {
                    const std::vector<Ray>& rays = problem->parts[p].rays;
                    for (std::size_t i = 0; i < rays.size(); ++i) {
                        answers[p][i] = casts[p](rays[i]);
                    }
                }
                return judge(*problem, answers, watch.seconds());
            }};
}

std::optional<double> distance(const std::optional<RayHit>& hit) {
    return hit ? std::optional<double>(hit->distance) : std::nullopt;
}

dvec3 to_float(const dvec3& v) { return dvec3(vec3(v)); }

std::shared_ptr<const StaticBvh> tree_of(const RayCases& part) {
    Result<StaticBvh> built = StaticBvh::build(part.mesh->vertices(), part.mesh->triangles());
    return std::make_shared<const StaticBvh>(std::move(*built));
}

// Closest hit of a ray relative to the tree, in float.
std::optional<double> wide_distance(const StaticBvh& bvh, const dvec3& origin, const dvec3& direction) {
    const vec3 d(direction);
    const MeshHit hit = closest_hit(bvh, {.origin = vec3(origin), .direction = d});
    return hit ? std::optional<double>(static_cast<double>(hit.t) * glm::length(dvec3(d))) : std::nullopt;
}

// The knobs of Carom: the precision in which poses and rays reach the query, and the two hierarchies, binary with triangles in double and
// 16 wide in float.
std::vector<RayCaster> carom_casters() {
    const auto in_double = [](const RayCases& part) {
        return [shape = Shape(part.mesh), pose = Pose{.position = part.offset}](const Ray& ray) {
            return distance(cast_ray(shape, pose, ray));
        };
    };
    const auto in_float_world = [](const RayCases& part) {
        return [shape = Shape(part.mesh), pose = Pose{.position = to_float(part.offset)}](const Ray& ray) {
            return distance(cast_ray(shape, pose, {.origin = to_float(ray.origin), .direction = to_float(ray.direction)}));
        };
    };
    const auto in_float_tree = [](const RayCases& part) {
        return [bvh = tree_of(part), offset = part.offset](const Ray& ray) {
            return wide_distance(*bvh, ray.origin - offset, ray.direction);
        };
    };
    const auto all_in_float = [](const RayCases& part) {
        return [bvh = tree_of(part), offset = vec3(part.offset)](const Ray& ray) {
            return wide_distance(*bvh, dvec3(vec3(ray.origin) - offset), ray.direction);
        };
    };
    return {{"carom", {{"world", "double"}, {"test", "double"}, {"width", 2.0}}, in_double},
            {"carom", {{"world", "float"}, {"test", "double"}, {"width", 2.0}}, in_float_world},
            {"carom", {{"world", "double"}, {"test", "float"}, {"width", 16.0}}, in_float_tree},
            {"carom", {{"world", "float"}, {"test", "float"}, {"width", 16.0}}, all_in_float}};
}

Study study_of(const std::shared_ptr<const RayProblem>& problem, const std::vector<RayCaster>& casters) {
    Study study{.name = problem->name,
                .stage = kStage,
                .error = kError,
                .unit = "1",
                .oracle = fmt::format("first hit in exact integer arithmetic; {} rays: {}", problem->ray_count(), problem->summary),
                .candidates = {}};
    for (const RayCaster& caster : casters) {
        study.candidates.push_back(candidate(caster, problem));
    }
    return study;
}

// Rays at a ball of radius 1 from three radii away, with the distance by the quadratic in long double.
std::shared_ptr<const RayProblem> ball_problem(std::size_t count) {
    RayProblem problem{"rays_ball", "rays at 0.95 of a ball of radius 1 from three radii away", {}};
    RayCases& cases = problem.parts.emplace_back();
    Random random(3302);
    while (cases.rays.size() < count) {
        const auto cube = [&](double half) {
            const double x = random.range(-half, half), y = random.range(-half, half);
            return dvec3{x, y, random.range(-half, half)};
        };
        const dvec3 from = cube(1.0), to = cube(0.95);
        if (glm::length(from) < 0.1 || glm::length(to) > 0.95) continue;
        const Ray ray{.origin = from * (3.0 / glm::length(from)), .direction = to - from * (3.0 / glm::length(from))};
        const glm::vec<3, long double> o(ray.origin), d(ray.direction);
        const long double dd = glm::dot(d, d), od = glm::dot(o, d), c = glm::dot(o, o) - 1.0L;
        const long double root = std::sqrt(od * od - dd * c);
        cases.rays.push_back(ray);
        cases.exact.push_back(static_cast<double>(c / (root - od) * std::sqrt(dd)));
    }
    return std::make_shared<const RayProblem>(std::move(problem));
}

MeshData ball_mesh(int n) {
    MeshData data = weld(scenes::bumpy(n));
    for (vec3& v : data.vertices) {
        v = vec3(glm::normalize(dvec3(v)));
    }
    return data;
}

Study ball_study(const StudyOptions& options) {
    const std::shared_ptr<const RayProblem> problem = ball_problem(options.quick ? 500 : 5000);
    Study study{.name = problem->name,
                .stage = kStage,
                .error = kError,
                .unit = "1",
                .oracle = fmt::format("quadratic in long double; {} {}", problem->ray_count(), problem->summary),
                .candidates = {}};
    const auto add = [&](Settings settings, const Shape& shape) {
        const auto prepare = [&](const RayCases&) { return [shape](const Ray& ray) { return distance(cast_ray(shape, ray)); }; };
        study.candidates.push_back(candidate({"carom", std::move(settings), prepare}, problem));
    };
    add({{"shape", "sphere"}}, Sphere{1.0f});
    for (const int n : {1, 2, 4, 8}) {
        const MeshData data = ball_mesh(n);
        add({{"shape", "convex_hull"}, {"vertices", static_cast<double>(data.vertices.size())}}, *ConvexHull::build(data.vertices));
    }
    for (const int n : {2, 4, 8, 16, 32, 64, 128}) {
        if (options.quick && n > 32) continue;
        const MeshData data = ball_mesh(n);
        add({{"shape", "triangle_mesh"}, {"triangles", static_cast<double>(data.triangles.size())}},
            *TriangleMesh::build(data.vertices, data.triangles));
    }
    return study;
}

}  // namespace

std::vector<Study> ray_studies(const StudyOptions& options) {
    std::vector<RayCaster> casters = carom_casters();
    casters.insert(casters.end(), options.ray_peers.begin(), options.ray_peers.end());
    std::vector<Study> studies;
    for (const std::shared_ptr<const RayProblem>& problem : ray_problems(options.quick)) {
        studies.push_back(study_of(problem, casters));
    }
    studies.push_back(ball_study(options));
    return studies;
}

}  // namespace carom::accuracy
