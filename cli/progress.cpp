#include <carom/cli/progress.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <unistd.h>

namespace carom::cli {

Progress::Progress(int total) : total_(total), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::show(int done) {
    const Clock::time_point now = Clock::now();
    if (!terminal_ || now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    drawn_ = true;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double left = elapsed / done * (total_ - done);
    fmt::print(stderr, "\r\x1b[Kstep {} of {}, {:.0f} %, {:.0f} s left", done, total_, 100.0 * done / total_, left);
    std::fflush(stderr);
}

}  // namespace carom::cli
