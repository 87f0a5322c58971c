#include <carom/cli/why_picture.hpp>

#include <carom/cli/picture_size.hpp>

#include <carom/viz/camera.hpp>
#include <carom/viz/contact_layers.hpp>
#include <carom/viz/sweep_layers.hpp>
#include <carom/viz/vtk/picture.hpp>
#include <carom/viz/vtk/vtp_series.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace carom::cli {
namespace {

// Lines of at most 70 characters, which fit into a picture 800 pixels wide.
std::string wrapped(const std::string& text) {
    std::string out, line;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        if (!line.empty() && line.size() + 1 + (end - begin) > 70) {
            out += line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + text.substr(begin, end - begin);
        begin = end + 1;
    }
    return out + line;
}

}  // namespace

void add_why_picture_options(CLI::App& command, WhyPictureOptions& options) {
    CLI::Option* picture = command.add_option("--picture", options.picture,
                                              "draw the two with axis, simplex and manifold into this PNG file (needs a display)");
    command.add_option("--size", options.size, "of the picture [pixels], WIDTHxHEIGHT")->needs(picture);
    command.add_option("--vtk", options.vtk, "write frames.pvd, which ParaView opens, into this folder: a layer for each of them");
}

Status check_why_picture(const WhyPictureOptions& options) {
    const Result<PictureSize> size = parse_picture_size(options.size);
    if (!size) return size.error();
    if (size->width < 16 || size->height < 16 || size->width > 8192 || size->height > 8192) {
        return Error{ErrorCode::InvalidArgument, fmt::format("\"{}\" is not within 16x16 and 8192x8192", options.size), "--size"};
    }
    // The smallest picture there is shows whether a display answers and the file can be written.
    if (options.picture.empty()) return {};
    return render_to_png({}, options.picture, {.width = 16, .height = 16, .camera = Camera{}});
}

Status draw_why(const scenes::SceneRun& run, const ContactExplanation& why, const std::string& way, const WhyPictureOptions& options) {
    if (options.picture.empty() && options.vtk.empty()) return {};
    DebugFrame frame = make_contact_frame(run.world, why);
    if (frame.layers.empty()) return Error{ErrorCode::Empty, "there are no shapes to draw", "--picture"};
    append_sweep_layers(frame, run.world, {.bodies = {why.body_a, why.body_b}});
    frame.caption = wrapped(fmt::format("{}, step {}: {}", run.name, why.step, why.sentence));
    if (!way.empty()) frame.caption += "\n" + wrapped(way.substr(0, way.find('\n')));
    if (!options.vtk.empty()) {
        VtpSeriesWriter series(options.vtk);
        if (Status status = series.add(frame, static_cast<double>(why.step) * run.dt); !status) return status;
        if (Status status = series.finish(); !status) return status;
    }
    if (options.picture.empty()) return {};
    const Result<PictureSize> size = parse_picture_size(options.size);
    return render_to_png(frame, options.picture, {.width = size->width, .height = size->height, .camera = {}});
}

}  // namespace carom::cli
