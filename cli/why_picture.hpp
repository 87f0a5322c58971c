// The picture and the frames that `carom why` leaves behind, in builds with viz.
//
//   add_why_picture_options(*command, options);
//   if (Status s = draw_why(run, why, options); !s) return s;
#pragma once

#include <carom/core/result.hpp>
#include <carom/dynamics/explain.hpp>
#include <carom/scenes/scene.hpp>

#include <CLI/CLI.hpp>

#include <string>

namespace carom::cli {

struct WhyPictureOptions {
    std::string picture;  ///< path of a PNG; empty: none
    std::string size = "1600x1000";
    std::string vtk;      ///< folder of frames.pvd; empty: none
};

/// Adds --picture and --vtk; nothing in builds without viz.
void add_why_picture_options(CLI::App& command, WhyPictureOptions& options);

/// Draws the two bodies as the last step saw them, with the axis, the simplex and the manifold between them and where they were swept, where that was asked for.
/// @param way  what the caption says beyond the explanation's sentence.
[[nodiscard]] Status draw_why(const scenes::SceneRun& run, const ContactExplanation& why, const std::string& way, const WhyPictureOptions& options);

/// Proves before anything runs that what was asked for can be written.
[[nodiscard]] Status check_why_picture(const WhyPictureOptions& options);

}  // namespace carom::cli
