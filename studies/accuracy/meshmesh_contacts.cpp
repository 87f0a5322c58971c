// The studies "meshmesh_depth" and "meshmesh_normal": how true the contacts of closed meshes are whose least overlap is known.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/surface_cases.hpp>

#include <fmt/format.h>

#include <functional>
#include <utility>

namespace carom::accuracy {
namespace {

constexpr std::size_t kTimedPairs = 500;  // a pass goes round until it has timed so many

using Measure = std::function<double(const ManifoldCases&, std::span<const Manifold>)>;

/// @param solids  the same pairs as solids, which the measure takes.
Candidate candidate(ManifoldCasesPtr cases, ManifoldCasesPtr solids, Settings settings, Measure measure) {
    return {"carom", std::move(settings), [cases = std::move(cases), solids = std::move(solids), measure = std::move(measure)] {
                std::vector<Manifold> manifolds;
                const std::size_t rounds = 1 + kTimedPairs / cases->count();
                const ThreadStopwatch watch;
                for (std::size_t round = 0; round < rounds; ++round) {
                    manifolds.clear();
                    for (std::uint32_t k = 0; k < cases->count(); ++k) collide(cases->pair(k), k, manifolds);
                }
                Sample sample;
                sample.time_s = watch.seconds() / static_cast<double>(rounds * cases->count());
                sample.error = measure(*solids, manifolds);
                return sample;
            }};
}

struct Kind {
    std::string name, error;
    Measure measure;
};

const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all{
        {"meshmesh_depth", "largest error of the deepest point, of the size; a missing contact counts 1", depth_error},
        {"meshmesh_depth_mean", "mean error of the deepest point, of the size; a missing contact counts 1", mean_depth_error},
        {"meshmesh_normal", "largest excess of the overlap along the reported normal over the least, of the size", normal_error}};
    return all;
}

Study study_of(const std::string& name, const std::string& error, const std::string& pairs) {
    return {.name = name,
            .stage = "mesh against mesh",
            .error = error,
            .unit = "1",
            .oracle = "least overlap of the solids along all normals of faces and products of edges, in long double; " + pairs,
            .time = "collide() of one pair, of the processor",
            .candidates = {}};
}

void add_hulls(const std::string& suffix, const DepthRange& range, std::size_t count, std::uint64_t seed, std::vector<Study>& studies) {
    const ManifoldCasesPtr hulls = solid_cases(Solids::Hulls, count, range, seed);
    const ManifoldCasesPtr meshes = as_surfaces(*hulls, {}), one = as_surfaces(*hulls, {.first = false});
    const ManifoldCasesPtr seeded = as_surfaces(*hulls, {.seeded = true}),
                           one_seeded = as_surfaces(*hulls, {.first = false, .seeded = true});
    const std::string pairs =
        fmt::format("{} pairs of hulls of 32 points, {:g} to {:g} of the least extent deep", count, range.least, range.most);
    for (const Kind& kind : kinds()) {
        Study study = study_of(kind.name + suffix, kind.error, pairs);
        study.candidates.push_back(candidate(meshes, hulls, {{"shapes", std::string("meshes")}}, kind.measure));
        study.candidates.push_back(candidate(one, hulls, {{"shapes", std::string("hull and mesh")}}, kind.measure));
        study.candidates.push_back(candidate(hulls, hulls, {{"shapes", std::string("hulls")}}, kind.measure));
        study.candidates.push_back(candidate(seeded, hulls, {{"shapes", std::string("seeded meshes")}}, kind.measure));
        study.candidates.push_back(candidate(one_seeded, hulls, {{"shapes", std::string("hull and seeded mesh")}}, kind.measure));
        studies.push_back(std::move(study));
    }
}

void add_boxes(std::size_t count, std::vector<Study>& studies) {
    const DepthRange range{0.0, 0.05};
    const ManifoldCasesPtr boxes = solid_cases(Solids::Boxes, count, range, 73);
    const std::string pairs = fmt::format("{} pairs of boxes, up to {:g} of the least extent deep", count, range.most);
    for (const Kind& kind : kinds()) {
        Study study = study_of(kind.name + "_boxes", kind.error, pairs);
        for (const int quads : {1, 4, 16}) {
            const ManifoldCasesPtr meshes = as_surfaces(*boxes, {.quads = quads});
            study.candidates.push_back(candidate(meshes, boxes, {{"quads along an edge", static_cast<double>(quads)}}, kind.measure));
        }
        studies.push_back(std::move(study));
    }
}

// Of plates in four by four quads a side, and of plates that are not taken for solids.
void add_pierced(std::size_t count, std::vector<Study>& studies) {
    const ManifoldCasesPtr bars = pierced_cases(count, 74);
    const std::string pairs = fmt::format("{} bars of 2 m through plates of 0.4 to 1 m", count);
    for (const Kind& kind : kinds()) {
        Study study = study_of(kind.name + "_pierced", kind.error, pairs);
        const auto add = [&](const char* name, const SurfaceSettings& settings) {
            study.candidates.push_back(candidate(as_surfaces(*bars, settings), bars, {{"shapes", std::string(name)}}, kind.measure));
        };
        add("meshes", {.quads = 4});
        add("box and mesh", {.first = false, .quads = 4});
        add("box and seeded mesh", {.first = false, .seeded = true});
        studies.push_back(std::move(study));
    }
}

}  // namespace

std::vector<Study> meshmesh_contact_studies(const StudyOptions& options) {
    const std::size_t count = options.quick ? 40 : 400;
    std::vector<Study> studies;
    add_hulls("", {0.0, 0.01}, count, 71, studies);
    add_hulls("_deep", {0.01, 0.2}, count, 72, studies);
    add_boxes(count, studies);
    add_pierced(count, studies);
    return studies;
}

}  // namespace carom::accuracy
