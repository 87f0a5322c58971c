// The scenes of the pipeline's study: their truths, their measures on courses that are known to be wrong, and that Carom is near what they ask.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/pipeline_cases.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace carom::accuracy {
namespace {

// A track whose bodies go exactly where they should and rest at the end.
Track perfect(const PipelineScene& scene) {
    Track track;
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
        track.states.emplace_back();
        for (const dvec3& at : scene.truth[i]) track.states[i].push_back({at, scene.bodies.moving[i].pose.orientation, dvec3{0.0}, dvec3{0.0}});
    }
    return track;
}

Track run(const PipelineScene& scene, double dt, const WorldDef& def = {}) {
    return follow(*make_carom(scene.make(def)), scene.bodies, scene.times, dt);
}

double course_error(PipelineKind kind, double dt, const WorldDef& def = {}) {
    const PipelineScenePtr scene = pipeline_scene(kind, true);
    return error_of(*scene, run(*scene, dt, def), PipelineMeasure::Course).value();
}

TEST(PipelineScenes, MeasureWhatWasSpoiled) {
    const PipelineScenePtr column = pipeline_scene(PipelineKind::Column, true);
    Track track = perfect(*column);
    for (const PipelineMeasure m : {PipelineMeasure::Course, PipelineMeasure::Penetration, PipelineMeasure::Jitter}) {
        EXPECT_EQ(error_of(*column, track, m), 0.0) << static_cast<int>(m);
    }
    track.states[3].back().position.y -= 0.01;
    track.states[5].back().velocity = {0.3, 0.0, 0.4};
    EXPECT_NEAR(error_of(*column, track, PipelineMeasure::Course).value(), 0.01, 1e-12);
    EXPECT_NEAR(error_of(*column, track, PipelineMeasure::Penetration).value(), 0.01, 1e-9);
    EXPECT_NEAR(error_of(*column, track, PipelineMeasure::Jitter).value(), 0.5 / std::sqrt(8.0 * 5.0), 1e-12) << "one of 8 bodies at one of 5 times";
    track.states[2][4].velocity.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(error_of(*column, track, PipelineMeasure::Course), std::nullopt);
}

TEST(PipelineScenes, TheTruthsAreThoseOfMechanics) {
    const PipelineScenePtr slide = pipeline_scene(PipelineKind::Slide, true), ball = pipeline_scene(PipelineKind::Bounce, true);
    const double a = 9.81 * (0.5 - 0.3 * std::sqrt(0.75));
    EXPECT_NEAR(glm::length(slide->truth[0].back() - slide->bodies.moving[0].pose.position), 0.5 * a, 1e-7) << "after one second";
    // Of 1 m: down in 0.4515 s, up again to 0.64 m in 0.3612 s more, and down in as much again.
    const auto height = [&](std::size_t tenths) { return ball->truth[0][tenths - 1].y - 0.25; };
    EXPECT_NEAR(height(4), 1.0 - 0.5 * 9.81 * 0.16, 1e-12);
    EXPECT_NEAR(height(8), 0.64 - 0.5 * 9.81 * std::pow(0.8 - 1.8 * std::sqrt(2.0 / 9.81), 2), 1e-12);
    EXPECT_NEAR(height(12), 0.4096 - 0.5 * 9.81 * std::pow(1.2 - (1.0 + 2.0 * 0.8 + 0.64) * std::sqrt(2.0 / 9.81), 2), 1e-12);
}

// Bounds at some twice of what was measured; half the step is to be nearer where the scene moves.
TEST(PipelineScenes, CaromIsNearThemAndNearerWithSmallerSteps) {
    EXPECT_LT(course_error(PipelineKind::Slide, 1.0 / 60.0), 8e-3);
    EXPECT_LT(course_error(PipelineKind::Slide, 1.0 / 240.0), 0.5 * course_error(PipelineKind::Slide, 1.0 / 60.0));
    EXPECT_LT(course_error(PipelineKind::Bounce, 1.0 / 60.0), 1e-6);
    EXPECT_LT(course_error(PipelineKind::Creep, 1.0 / 60.0), 1e-4);
    EXPECT_LT(course_error(PipelineKind::Column, 1.0 / 60.0), 4e-3);
    EXPECT_LT(course_error(PipelineKind::Column, 1.0 / 60.0, {.contact_method = ContactMethod::Direct}), 3e-4);
    EXPECT_LT(course_error(PipelineKind::Pyramid, 1.0 / 60.0), 2e-3);
}

TEST(PipelineScenes, TheReferenceOfATopIsMoreCertainThanWhatItJudges) {
    const PipelineScenePtr top = pipeline_scene(PipelineKind::Top, true);
    ASSERT_TRUE(top->doubt);
    EXPECT_LT(*top->doubt, 5e-3);
    const double at_60 = error_of(*top, run(*top, 1.0 / 60.0), PipelineMeasure::Course).value();
    EXPECT_GT(at_60, *top->doubt);
    EXPECT_LT(at_60, 0.1);
}

TEST(PipelineStudies, HaveNamesOfTheirOwnAndAddUpOverTheScenes) {
    const std::vector<Study> studies = pipeline_studies({.quick = true});
    std::set<std::string> names;
    for (const Study& study : studies) EXPECT_TRUE(names.insert(study.name).second) << study.name;
    ASSERT_EQ(studies[0].name, "pipeline");
    ASSERT_EQ(names.count("pipeline_pile_jitter"), 1u);
    double sum = 0.0;
    for (const Study& study : studies) {
        const bool course = study.name != "pipeline" && !study.name.ends_with("_penetration") && !study.name.ends_with("_jitter");
        if (course) sum += study.candidates[0].run().error.value();
    }
    EXPECT_NEAR(studies[0].candidates[0].run().error.value(), sum / 7.0, 1e-12);
}

}  // namespace
}  // namespace carom::accuracy
