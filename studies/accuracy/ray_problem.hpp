// The cases of the studies of rays: meshes, rays, and the exact answers.
//
//   auto problem = std::make_shared<const RayProblem>(far_rays({.quick = true}));
//   Sample sample = judge(*problem, answers, seconds);
#pragma once

#include <carom/collision/ray_cast.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/pose.hpp>
#include <carom/studies/accuracy/study.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace carom::accuracy {

/// Rays against one mesh. Every number of them is a float, so that float and double are asked the same question, unless the family
/// says otherwise.
struct RayCases {
    TriangleMeshPtr mesh;
    dvec3 offset{0.0};                          ///< where the mesh stands; it is not turned [m]
    std::vector<Ray> rays;                      ///< in the frame of `offset`, without limit
    std::vector<std::optional<double>> exact;   ///< (rays,) the distance along the normalised direction; none: a miss [m]
};

/// One way to cast rays: of Carom at a setting of its knobs, or of a peer. All are called through the same kind of function, so that none
/// has an advantage.
struct RayCaster {
    using Cast = std::function<std::optional<double>(const Ray&)>;  ///< the distance along the normalised direction; none: a miss [m]
    std::string who;
    Settings settings;
    std::function<Cast(const RayCases&)> prepare;  ///< builds what casts need; not timed
};

/// What all candidates of one study are asked.
struct RayProblem {
    std::string name;     ///< of the study
    std::string summary;  ///< which rays, on what
    std::vector<RayCases> parts;
    [[nodiscard]] std::size_t ray_count() const;
};

/// The answers to one part of a problem: (rays,) distances, none for a miss.
using RayAnswers = std::vector<std::optional<double>>;

/// Compares answers with the exact ones: the error is the mean over all rays of |t - t*| / t*, where a wrong verdict (a hit for a
/// miss, a miss for a hit) counts 1. So it is the share of wrong verdicts and the mean relative error of the others in one number.
/// Answers that are not finite, or negative, are failures.
/// @param answers  one for each part.
[[nodiscard]] Sample judge(const RayProblem& problem, const std::vector<RayAnswers>& answers, double time_s);

/// @return problems with exact answers: "rays" (the parts of all families below), "rays_near", "rays_edges", "rays_far", "rays_world"
/// and "rays_tiny". docs/accuracy.md describes the families. Always the same cases.
/// @param quick  fewer rays on a smaller mesh.
[[nodiscard]] std::vector<std::shared_ptr<const RayProblem>> ray_problems(bool quick);

}  // namespace carom::accuracy
