#include <carom/cli/recorder.hpp>

#include <carom/viz/broadphase_layers.hpp>
#include <carom/viz/make_debug_frame.hpp>
#include <carom/viz/reveal.hpp>
#include <carom/viz/sweep_layers.hpp>
#include <carom/viz/vtk/picture.hpp>
#include <carom/viz/vtk/vtp_series.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace carom::cli {
namespace {

// Frames over a whole run; each can hold every vertex of the scene.
constexpr int kMostFrames = 60;
// Round shapes in the frames: a third of the triangles that a picture has.
constexpr int kSeriesSegments = 12;

class VtkRecorder final : public Recorder {
public:
    explicit VtkRecorder(const RecorderOptions& options) : options_(options) {
        if (!options.vtk.empty()) series_.emplace(options.vtk);
    }

    Status begin(const scenes::SceneRun& run) override {
        interval_ = std::max(1, (run.steps + kMostFrames - 1) / kMostFrames);
        if (series_) {
            if (Status status = add_frame(run, 0); !status) return status;
        }
        // The smallest picture there is shows whether a display answers and the file can be written.
        return options_.picture.empty() ? Status{} : draw(run, 0, {.width = 16, .height = 16});
    }

    Status stepped(const scenes::SceneRun& run, int done) override {
        done_ = done;
        const bool due = series_ && (done % interval_ == 0 || done == run.steps);
        return due ? add_frame(run, done) : Status{};
    }

    Status end(const scenes::SceneRun& run) override {
        if (series_) {
            if (Status status = series_->finish(); !status) return status;
        }
        return options_.picture.empty() ? Status{} : draw(run, done_, {});
    }

private:
    [[nodiscard]] DebugFrame frame_of(const scenes::SceneRun& run, int done, int segments) const {
        DebugFrame frame =
            make_debug_frame(run.world, {.layers = kAllLayers & ~layer_bit(Layer::Bvh), .segments = segments});
        if (options_.broadphase) append_broadphase_layers(frame, run.world);
        if (options_.sweeps) append_sweep_layers(frame, run.world);
        frame.caption = fmt::format("{}, step {}, {:.2f} s", run.name, done, done * run.dt);
        return frame;
    }

    Status add_frame(const scenes::SceneRun& run, int done) {
        return series_->add(frame_of(run, done, kSeriesSegments), done * run.dt);
    }

    Status draw(const scenes::SceneRun& run, int done, const PictureSettings& settings) const {
        DebugFrame frame = frame_of(run, done, DebugFrameSettings{}.segments);
        PictureSettings opened = settings;
        opened.camera = automatic_camera(frame, static_cast<double>(settings.width) / settings.height);
        reveal(frame, *opened.camera);
        return render_to_png(frame, options_.picture, opened);
    }

    RecorderOptions options_;
    std::optional<VtpSeriesWriter> series_;
    int interval_ = 1;
    int done_ = 0;
};

}  // namespace

void add_recorder_options(CLI::App& command, RecorderOptions& options) {
    command.add_option("--picture", options.picture, "draw the end of the run into this PNG file (needs a display)");
    command.add_option("--vtk", options.vtk, "write frames.pvd, which ParaView opens, into this folder");
    command.add_flag("--broadphase", options.broadphase, "show the broadphase's boxes, cells, axes and tree in pictures and frames");
    command.add_flag("--sweeps", options.sweeps, "show what was followed in the step: swept volumes, impacts and the steps of advancement");
}

std::unique_ptr<Recorder> make_recorder(const RecorderOptions& options) {
    if (options.picture.empty() && options.vtk.empty()) return nullptr;
    return std::make_unique<VtkRecorder>(options);
}

}  // namespace carom::cli
