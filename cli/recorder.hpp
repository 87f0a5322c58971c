// What a run leaves behind beside its report: a picture of the end and a series of frames, in builds with viz.
//
//   std::unique_ptr<Recorder> recorder = make_recorder(options);      // null: nothing was asked for
//   if (Status s = recorder->begin(run); !s) return s;
#pragma once

#include <carom/core/result.hpp>
#include <carom/scenes/scene.hpp>

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace carom::cli {

struct RecorderOptions {
    std::string picture;  ///< path of a PNG; empty: none
    std::string vtk;      ///< folder of frames.pvd; empty: none
    bool broadphase = false;  ///< frames show what the broadphase keeps
    bool sweeps = false;      ///< frames show what was followed; the world must record paths
};

class Recorder {
public:
    virtual ~Recorder() = default;
    /// Before the first step: proves that everything can be written, and records the start.
    [[nodiscard]] virtual Status begin(const scenes::SceneRun& run) = 0;
    /// After `done` steps.
    [[nodiscard]] virtual Status stepped(const scenes::SceneRun& run, int done) = 0;
    [[nodiscard]] virtual Status end(const scenes::SceneRun& run) = 0;
};

/// Adds --picture and --vtk; nothing in builds without viz.
void add_recorder_options(CLI::App& command, RecorderOptions& options);

/// @return null where nothing is to be recorded.
[[nodiscard]] std::unique_ptr<Recorder> make_recorder(const RecorderOptions& options);

}  // namespace carom::cli
