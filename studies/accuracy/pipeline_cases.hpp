// Small scenes whose right course is known, or known better by far than a step of 1/60 s shows it; and how far an engine's course is from it.
//
//   const PipelineScenePtr scene = pipeline_scene(PipelineKind::Slide, false);
//   const Track track = follow(*make_carom(scene->make({})), scene->bodies, scene->times, 1.0 / 60.0);
//   double error = error_of(*scene, track, PipelineMeasure::Course).value();
#pragma once

#include <carom/studies/accuracy/track.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace carom::accuracy {

/// Slide: a box on a slope of 30° with μ = 0.3. Bounce: a ball with e = 0.8. Top: a hull of 24 corners that spins on its tip. Creep: a box on a slope that holds it
/// (tan = 0.5, μ = 0.6). Column: 8 boxes. Pyramid: 8 rows. Pile: 30 boxes that fall into a bin.
enum class PipelineKind : unsigned char { Slide, Bounce, Top, Creep, Column, Pyramid, Pile };
[[nodiscard]] const char* to_string(PipelineKind kind) noexcept;
[[nodiscard]] std::span<const PipelineKind> pipeline_kinds();

enum class PipelineMeasure : unsigned char {
    Course,       ///< distance of the bodies' centres from where they should be, over PipelineScene::scale, the largest over times, of the worst body; of a
                  ///< pile of the mean one
    Penetration,  ///< the deepest overlap of two shapes at the end, over `scale`
    Jitter,       ///< root mean square of the bodies' speeds in the last half second, of what should be at rest [m/s]
};

struct PipelineScene {
    PipelineKind kind = PipelineKind::Slide;
    std::function<World(const WorldDef&)> make;  ///< always the same bodies; the definition's gravity is not used
    SceneBodies bodies{};
    std::vector<double> times{};  ///< a tenth of a second apart [s]
    std::size_t course = 0;       ///< how many of them Course looks at: a pile soon forgets where it came from
    std::vector<std::vector<dvec3>> truth{};  ///< where the centres of mass should be, by body, by time
    double scale = 1.0;           ///< [m]
    bool rests = false;           ///< at the end: Jitter has a meaning
    std::string oracle{};         ///< where `truth` is from, in words
    std::optional<double> doubt{};  ///< of a truth by small steps: what it differs by, as a Course, from that of twice the step
};
using PipelineScenePtr = std::shared_ptr<const PipelineScene>;

/// @param quick  a reference by dt = 1/960 s, and not 1/3840 s: a 64th of 1/60 s.
[[nodiscard]] PipelineScenePtr pipeline_scene(PipelineKind kind, bool quick);

/// @return none where a state is not finite.
[[nodiscard]] std::optional<double> error_of(const PipelineScene& scene, const Track& track, PipelineMeasure measure);

}  // namespace carom::accuracy
