// A window in which a scene runs: turn it, pause it, step it, switch layers, pick bodies.
//
//   ViewerSource source{.frame = [&] { return make_debug_frame(run.world); },
//                       .step = [&] { run.world.step(run.dt); return true; },
//                       .describe = [&](BodyId body) { return describe_body(run.world, body); }};
//   Status s = Viewer(source, {.title = "pile_boxes"}).run();
//
// Mouse: left turns, middle (or shift + left) pans, wheel or right zooms, a left click without moving picks a body.
// Keys: space pauses, n steps once, 1..9 switch layers, r frames the scene anew (or goes back to the given camera), h hides the help, q or Escape closes.
#pragma once

#include <carom/core/ids.hpp>
#include <carom/core/result.hpp>
#include <carom/viz/camera.hpp>
#include <carom/viz/debug_frame.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace carom {

/// Where the viewer gets its scene from. The functions are called on the viewer's thread, from run() and its relatives only.
struct ViewerSource {
    std::function<DebugFrame()> frame{};                ///< the scene as it stands; required
    std::function<bool()> step{};                       ///< advances it by one step; false: it has come to its end. Empty: a still
    std::function<std::string(BodyId)> describe{};      ///< what to print of a picked body; empty: its id
    std::function<void(const std::string&)> print{};    ///< where to; empty: standard output
};

struct ViewerSettings {
    std::string title = "carom";
    int width = 1600;                ///< [pixels], 16..8192
    int height = 1000;               ///< [pixels], 16..8192
    std::optional<Camera> camera{};  ///< none: automatic_camera
    bool paused = false;             ///< at first
    bool close_at_end = false;       ///< close the window when the source comes to its end, rather than leave it open
    double steps_per_second = 60.0;  ///< at most; in (0, 1000]
};

class Viewer {
public:
    Viewer(ViewerSource source, ViewerSettings settings = {});
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    /// Opens the window and shows the first frame; run() does it where it has not been done.
    /// @return Io without a display; InvalidArgument for settings out of range or a source without `frame`; what validate(frame)
    /// and validate(camera) say. The same failure ends run().
    [[nodiscard]] Status open();

    /// Shows the window until it is closed; at once done where that has happened.
    /// @return what open() says, or the fault of a later frame.
    [[nodiscard]] Status run();

    /// Does what the key does: "space", "n", "1".."9", "r", "h", "q", "Escape"; other keys nothing. Requires an open window.
    void press(const std::string& key);

    /// Picks as a click does, and prints. Requires an open window.
    /// @param x, y  [pixels] from the lower left corner.
    /// @return the body drawn there; null where there is none.
    BodyId pick(int x, int y);

    [[nodiscard]] std::uint64_t steps() const noexcept;  ///< done so far
    [[nodiscard]] bool paused() const noexcept;
    /// @return whether the layer is switched on; false where the frame has none of that name.
    [[nodiscard]] bool layer_visible(const std::string& name) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace carom
