#include <carom/studies/accuracy/ray_problem.hpp>

#include <carom/core/random.hpp>
#include <carom/scenes/bumpy.hpp>
#include <carom/studies/oracle/exact_rays.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::accuracy {
namespace {

constexpr std::uint64_t kSeed = 3301;

dvec3 in_cube(Random& random, double half) {
    const double x = random.range(-half, half), y = random.range(-half, half);
    return {x, y, random.range(-half, half)};
}

dvec3 on_sphere(Random& random, double radius) {
    for (;;) {
        const dvec3 p = in_cube(random, 1.0);
        const double length = glm::length(p);
        if (length > 0.1 && length < 1.0) return p * (radius / length);
    }
}

dvec3 to_float(const dvec3& v) { return dvec3(vec3(v)); }

// A ray between two points, both of its vectors rounded to float.
Ray through(const dvec3& from, const dvec3& to) {
    const dvec3 origin = to_float(from);
    return {.origin = origin, .direction = to_float(to - origin)};
}

// A bumpy ball of about `size` and the means to aim at it.
struct Target {
    double size = 1.0;
    TriangleMeshPtr mesh;

    Target(int n, double scale) : size(scale) {
        MeshData data = weld(scenes::bumpy(n));
        for (vec3& v : data.vertices) {
            v = vec3(scale * dvec3(v));
        }
        mesh = *TriangleMesh::build(data.vertices, data.triangles);
    }
    // A corner, or a point of an edge, of a random triangle.
    [[nodiscard]] dvec3 on_edge(Random& random) const {
        const auto count = static_cast<double>(mesh->triangles().size());
        const auto corners = mesh->corners(static_cast<std::uint32_t>(random.unit() * count));
        const double along = std::max(0.0, random.range(-0.5, 1.0));
        return glm::mix(dvec3(corners[0]), dvec3(corners[1]), along);
    }
};

using Aim = std::function<Ray(Random&, const Target&)>;

RayCases make_cases(const Target& target, const dvec3& offset, std::size_t count, const Aim& aim) {
    RayCases cases{target.mesh, offset, {}, {}};
    Random random(kSeed);
    for (std::size_t i = 0; i < count; ++i) {
        const Ray ray = aim(random, target);
        cases.rays.push_back(ray);
        cases.exact.push_back(oracle::exact_distance(target.mesh->vertices(), target.mesh->triangles(), offset, ray));
    }
    return cases;
}

Ray chord(Random& random, const Target& target) {
    const dvec3 from = on_sphere(random, 2.0 * target.size);
    return through(from, on_sphere(random, 2.0 * target.size));
}

Ray at_edge(Random& random, const Target& target) {
    const dvec3 from = on_sphere(random, 3.0 * target.size);
    return through(from, target.on_edge(random));
}

// From 10^1 .. 10^6 sizes away. The direction is the difference of two points of which only the nearer one matters.
Ray from_afar(Random& random, const Target& target) {
    const double decades = std::floor(random.range(1.0, 7.0));
    const dvec3 from = on_sphere(random, std::pow(10.0, decades) * target.size);
    const dvec3 origin = to_float(from);
    return {.origin = origin, .direction = in_cube(random, target.size) - origin};
}

}  // namespace

std::size_t RayProblem::ray_count() const {
    std::size_t count = 0;
    for (const RayCases& part : parts) {
        count += part.rays.size();
    }
    return count;
}

Sample judge(const RayProblem& problem, const std::vector<RayAnswers>& answers, double time_s) {
    Sample sample{time_s, std::nullopt, 0};
    double sum = 0.0;
    for (std::size_t p = 0; p < problem.parts.size(); ++p) {
        const std::vector<std::optional<double>>& exact = problem.parts[p].exact;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            const std::optional<double>& answer = answers[p][i];
            if (answer && !(is_finite(*answer) && *answer >= 0.0)) {
                ++sample.failures;
            } else if (answer.has_value() != exact[i].has_value()) {
                sum += 1.0;
            } else if (answer && *answer != *exact[i]) {
                sum += std::min(1.0, std::abs(*answer - *exact[i]) / *exact[i]);
            }
        }
    }
    sample.error = sum / static_cast<double>(problem.ray_count());
    return sample;
}

std::vector<std::shared_ptr<const RayProblem>> ray_problems(bool quick) {
    const int n = quick ? 8 : 16;
    const std::size_t count = quick ? 300 : 2000;
    const Target unit(n, 1.0);

    std::vector<RayProblem> families;
    families.push_back({"rays_near", "chords between points two radii from the middle", {make_cases(unit, dvec3{0.0}, count, chord)}});
    families.push_back(
        {"rays_edges", "rays aimed at edges and vertices from three radii", {make_cases(unit, dvec3{0.0}, count, at_edge)}});
    families.push_back(
        {"rays_far", "rays from 1e1 .. 1e6 radii away, directions in double", {make_cases(unit, dvec3{0.0}, count, from_afar)}});
    families.push_back({"rays_world", "chords where mesh and rays stand 1e3 .. 1e6 m from the world's origin", {}});
    for (const double away : {1e3, 1e4, 1e5, 1e6}) {
        const dvec3 offset = away * dvec3{0.6, -0.48, 0.64} + dvec3{0.1, 0.2, 0.3};
        families.back().parts.push_back(make_cases(unit, offset, count / 4, [&](Random& random, const Target& target) {
            Ray ray = chord(random, target);
            ray.origin += offset;
            return ray;
        }));
    }
    families.push_back({"rays_tiny", "chords on balls of 1e-12, 1e-6, 1e6 and 1e12 m", {}});
    for (const double size : {1e-12, 1e-6, 1e6, 1e12}) {
        families.back().parts.push_back(make_cases(Target(n, size), dvec3{0.0}, count / 4, chord));
    }

    RayProblem all{"rays", "equal shares of near, edge, far, world and tiny rays", {}};
    std::vector<std::shared_ptr<const RayProblem>> problems;
    for (RayProblem& family : families) {
        all.parts.insert(all.parts.end(), family.parts.begin(), family.parts.end());
    }
    problems.push_back(std::make_shared<const RayProblem>(std::move(all)));
    for (RayProblem& family : families) {
        problems.push_back(std::make_shared<const RayProblem>(std::move(family)));
    }
    return problems;
}

}  // namespace carom::accuracy
