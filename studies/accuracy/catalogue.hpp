// The studies by name: what `carom accuracy` lists and runs.
//
//   Result<StudyGroup> group = find_study("rays");
//   for (const Study& study : group->make({.quick = true})) { print(to_table(measure(study))); }
#pragma once

#include <carom/studies/accuracy/engine.hpp>
#include <carom/studies/accuracy/ray_problem.hpp>
#include <carom/studies/accuracy/study.hpp>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace carom::accuracy {

struct StudyOptions {
    bool quick = false;  ///< fewer and smaller cases: seconds in all
    std::vector<RayCaster> ray_peers{};  ///< that join every study of rays against meshes; a build with peers gives them
    std::vector<EngineMaker> engine_peers{};  ///< that join every study of whole worlds
};

/// What the results of a group add up to.
struct Digest {
    struct Picture {
        std::string name;                                       ///< of its file: letters, digits and '_'
        std::function<std::string(const std::string& svg)> script;  ///< gnuplot's, which is to write `svg`
    };
    std::string table{};
    std::vector<Picture> pictures{};
};

/// Studies that run together; the first of them has the group's name.
struct StudyGroup {
    std::string name;
    std::string summary;
    /// Builds the studies with their cases and their exact answers, always the same ones; this can take a while.
    std::function<std::vector<Study>(const StudyOptions&)> make;
    std::function<Digest(std::span<const StudyResult>)> digest{};  ///< empty for most groups
};

/// @return the groups, in the order that lists show them.
[[nodiscard]] std::span<const StudyGroup> study_catalogue();

/// @return the group of that name; UnknownName, with the names there are, for any other.
[[nodiscard]] Result<StudyGroup> find_study(const std::string& name);

/// Casts of rays; ray_problem.hpp has the measure.
[[nodiscard]] std::vector<Study> ray_studies(const StudyOptions& options);
/// Tests of single primitives; primitive_cases.hpp has the measure.
[[nodiscard]] std::vector<Study> primitive_studies(const StudyOptions& options);
/// Broadphase methods; box_crowd.hpp has the cases, winner_map.hpp what they add up to.
[[nodiscard]] std::vector<Study> broadphase_studies(const StudyOptions& options);
/// Pairs of triangles of two meshes, and their contacts; surface_cases.hpp has the cases of these.
[[nodiscard]] std::vector<Study> meshmesh_studies(const StudyOptions& options);
[[nodiscard]] std::vector<Study> meshmesh_contact_studies(const StudyOptions& options);
/// Ways out of thin walls; studies/oracle/walls.hpp has the rooms.
[[nodiscard]] std::vector<Study> meshmesh_wall_studies(const StudyOptions& options);
/// Boxes, and hulls, in pairs; convex_cases.hpp has the cases.
[[nodiscard]] std::vector<Study> sat_studies(const StudyOptions& options);
[[nodiscard]] std::vector<Study> gjk_studies(const StudyOptions& options);
/// Contact manifolds; manifold_cases.hpp has the measures.
[[nodiscard]] std::vector<Study> manifold_studies(const StudyOptions& options);
/// Wheels of rays against the wheels themselves.
[[nodiscard]] std::vector<Study> probe_studies(const StudyOptions& options);
/// Free bodies; integrator_cases.hpp has the measures, integrator_digest.hpp what they add up to.
[[nodiscard]] std::vector<Study> integrator_studies(const StudyOptions& options);
/// Resting bodies; solver_cases.hpp has the problems, contact_forces.hpp of the oracles the measure.
[[nodiscard]] std::vector<Study> solver_studies(const StudyOptions& options);
/// Whole scenes; pipeline_cases.hpp has the measures.
[[nodiscard]] std::vector<Study> pipeline_studies(const StudyOptions& options);
/// Deforming triangles: contacts missed and made up.
[[nodiscard]] std::vector<Study> ccd_studies(const StudyOptions& options);
/// Times of impact of turning shapes, and sweeps in closed form.
[[nodiscard]] std::vector<Study> toi_studies(const StudyOptions& options);
[[nodiscard]] std::vector<Study> sweep_studies(const StudyOptions& options);

}  // namespace carom::accuracy
