// A build without viz has no pictures, no frames and no `view`: the options do not exist.
#include <carom/cli/command.hpp>
#include <carom/cli/recorder.hpp>
#include <carom/cli/why_picture.hpp>

namespace carom::cli {

void add_recorder_options(CLI::App&, RecorderOptions&) {}

std::unique_ptr<Recorder> make_recorder(const RecorderOptions&) { return nullptr; }

void add_why_picture_options(CLI::App&, WhyPictureOptions&) {}

Status check_why_picture(const WhyPictureOptions&) { return {}; }

Status draw_why(const scenes::SceneRun&, const ContactExplanation&, const std::string&, const WhyPictureOptions&) { return {}; }

void add_view_command(CLI::App&, Action&) {}

}  // namespace carom::cli
