// A line on stderr that says how far a run is and how long it will take, where stderr is a terminal.
//
//   Progress progress(steps);
//   for (int i = 0; i < steps; ++i) { ...; progress.show(i + 1); }      // the line is gone when `progress` is
#pragma once

#include <chrono>

namespace carom::cli {

class Progress {
public:
    explicit Progress(int total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Redraws the line, ten times a second at most.
    void show(int done);

private:
    using Clock = std::chrono::steady_clock;
    int total_;
    bool terminal_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

}  // namespace carom::cli
