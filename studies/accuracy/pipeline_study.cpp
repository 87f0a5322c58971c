// The studies "pipeline": whole scenes by Carom's methods, steps and substeps, and by other engines.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/pipeline_cases.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace carom::accuracy {
namespace {

using MakeEngine = std::function<std::unique_ptr<Engine>(const PipelineScene&)>;

struct Knobs {
    ContactMethod method = ContactMethod::Automatic;
    int substeps = 8;
    double dt = 1.0 / 60.0;
};

// Steps at 8 substeps, and substeps at 1/60 s.
std::vector<Knobs> knobs_of(bool quick) {
    std::vector<Knobs> all;
    for (const ContactMethod method : {ContactMethod::Automatic, ContactMethod::Soft, ContactMethod::Direct}) {
        for (const double rate : {30.0, 60.0, 120.0, 240.0}) {
            if (!quick || rate == 60.0) all.push_back({method, 8, 1.0 / rate});
        }
    }
    for (const int substeps : {1, 2, 4, 16, 32}) {
        if (!quick || substeps == 2) all.push_back({ContactMethod::Soft, substeps, 1.0 / 60.0});
    }
    return all;
}

/// The mean over scenes; an error beyond 1 counts 1, so that one that falls over does not stand for all.
struct Asked {
    std::vector<PipelineScenePtr> scenes;
    PipelineMeasure measure = PipelineMeasure::Course;
};

Sample one_pass(const Asked& asked, const MakeEngine& make, double dt) {
    Sample sample{0.0, 0.0, 0};
    const auto count = static_cast<double>(asked.scenes.size());
    for (const PipelineScenePtr& scene : asked.scenes) {
        const Track track = follow(*make(*scene), scene->bodies, scene->times, dt);
        sample.time_s += track.seconds / (scene->times.back() * count);
        const std::optional<double> error = error_of(*scene, track, asked.measure);
        if (!error) ++sample.failures;
        *sample.error += (asked.scenes.size() > 1 ? std::min(error.value_or(1.0), 1.0) : error.value_or(1.0)) / count;
    }
    return sample;
}

void add_candidates(const Asked& asked, const StudyOptions& options, Study& study) {
    for (const Knobs& knobs : knobs_of(options.quick)) {
        const WorldDef def{.substeps = knobs.substeps, .contact_method = knobs.method};
        const MakeEngine make = [def](const PipelineScene& scene) { return make_carom(scene.make(def)); };
        study.candidates.push_back(
            {"carom", {{"method", std::string(to_string(knobs.method))}, {"substeps", static_cast<double>(knobs.substeps)}, {"dt", knobs.dt}},
             [asked, make, dt = knobs.dt] { return one_pass(asked, make, dt); }});
    }
    for (const EngineMaker& peer : options.engine_peers) {
        const MakeEngine make = [make = peer.make](const PipelineScene& scene) { return make(scene.bodies); };
        for (const double rate : {30.0, 60.0, 120.0, 240.0, 480.0}) {
            if (options.quick && rate != 60.0) continue;
            study.candidates.push_back({peer.who, {{"dt", 1.0 / rate}}, [asked, make, rate] { return one_pass(asked, make, 1.0 / rate); }});
        }
    }
}

std::string words_of(const Asked& asked) {
    const bool pile = asked.scenes.size() == 1 && asked.scenes[0]->kind == PipelineKind::Pile;
    switch (asked.measure) {
        case PipelineMeasure::Course:
            if (asked.scenes.size() > 1) return "mean over all scenes of the error of each, at most 1";
            return fmt::format("distance of the {} from where it should be, over {} m, the largest over times", pile ? "mean body" : "worst body",
                               asked.scenes[0]->scale);
        case PipelineMeasure::Penetration: return fmt::format("deepest overlap of two bodies at the end, over {} m", asked.scenes[0]->scale);
        case PipelineMeasure::Jitter: return "root mean square of the speeds in the last half second";
    }
    return {};
}

Study study_of(const std::string& name, const Asked& asked, const StudyOptions& options) {
    const bool one = asked.scenes.size() == 1, still = asked.measure != PipelineMeasure::Course;
    Study study{.name = name,
                .stage = "whole pipeline",
                .error = words_of(asked),
                .unit = asked.measure == PipelineMeasure::Jitter ? "m/s" : "1",
                .oracle = still ? "rest, without overlap" : one ? asked.scenes[0]->oracle : "those of the studies of single scenes",
                .time = one ? "a second of the scene, of the processor" : "a second of a scene, of the processor, the mean over the scenes",
                .cases = {{"scene", one ? std::string(to_string(asked.scenes[0]->kind)) : std::string("all")}}};
    add_candidates(asked, options, study);
    return study;
}

}  // namespace

std::vector<Study> pipeline_studies(const StudyOptions& options) {
    std::vector<PipelineScenePtr> scenes;
    for (const PipelineKind kind : pipeline_kinds()) scenes.push_back(pipeline_scene(kind, options.quick));
    std::vector<Study> studies;
    studies.push_back(study_of("pipeline", {scenes, PipelineMeasure::Course}, options));
    for (const PipelineScenePtr& scene : scenes) {
        const std::string name = fmt::format("pipeline_{}", to_string(scene->kind));
        studies.push_back(study_of(name, {{scene}, PipelineMeasure::Course}, options));
        if (!scene->rests || scene->kind == PipelineKind::Creep) continue;
        studies.push_back(study_of(name + "_penetration", {{scene}, PipelineMeasure::Penetration}, options));
        studies.push_back(study_of(name + "_jitter", {{scene}, PipelineMeasure::Jitter}, options));
    }
    return studies;
}

}  // namespace carom::accuracy
