#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/integrator_digest.hpp>
#include <carom/studies/accuracy/winner_map.hpp>

#include <fmt/format.h>

namespace carom::accuracy {

std::span<const StudyGroup> study_catalogue() {
    static const std::vector<StudyGroup> groups{
        {"rays", "ray casts: near, at edges, from afar, far from the origin, tiny and huge; and how fine a mesh has to be", ray_studies},
        {"primitives", "rays, distances and overlaps of single primitives in float and double: plain, far, tiny, huge, touching",
         primitive_studies},
        {"broadphase", "pairs of moving boxes by every method, with margins and cells; which is fastest where, and what the chooser takes",
         broadphase_studies, broadphase_digest},
        {"meshmesh", "two meshes: pairs of triangles, crossing, nearly touching, touching, in one plane, coincident, tiny, far; contacts of closed ones",
         meshmesh_studies},
        {"sat", "two boxes: verdicts and depths, by axes, primitives, manifolds and polytope; near, touching, deep, thin, far, tiny", sat_studies},
        {"gjk", "two hulls: verdicts, distances with tolerances and caps, depths; near, touching, deep, thin, far, tiny", gjk_studies},
        {"manifolds", "contacts of boxes, hulls and meshes: depth, normal, the area that few points span, and how steady their names are",
         manifold_studies},
        {"probes", "wheels of rays on terrain, steps and rails: contacts missed against the number of rays", probe_studies},
        {"integrator", "free bodies by class of inertia, free fall and the spinning box: orientation, energy, momentum, and the order of each method",
         integrator_studies, integrator_digest},
        {"solver", "the same resting column, heavy box on a light one, pyramid, arch and pile by each contact method: forces that are left unbalanced",
         solver_studies},
        {"pipeline", "whole scenes by method, step and substeps: slide, bounce, top, creep, column, pyramid and pile; course, overlap and jitter",
         pipeline_studies},
        {"ccd", "vertices against faces and edges against edges in motion: contacts made up and missed, against tolerance and cap",
         ccd_studies},
        {"toi", "convex shapes that move and turn: contacts missed, and how early they are found, against tolerance and cap", toi_studies},
        {"sweeps", "moving spheres and capsules against primitives in closed form: how early contacts are, in float and double", sweep_studies},
    };
    return groups;
}

Result<StudyGroup> find_study(const std::string& name) {
    std::string names;
    for (const StudyGroup& group : study_catalogue()) {
        if (group.name == name) return group;
        names += (names.empty() ? "" : ", ") + group.name;
    }
    return Error{ErrorCode::UnknownName, fmt::format("no study is called \"{}\"; there are {}", name, names), "study"};
}

}  // namespace carom::accuracy
