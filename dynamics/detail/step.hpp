// One step in progress: runs the stages, times them and keeps the report.
#pragma once

#include <carom/dynamics/step_report.hpp>

#include <chrono>

namespace carom::dynamics {

class Step {
public:
    explicit Step(double dt) : begin_(Clock::now()) { report.dt = dt; }

    /// Calls `work` and adds its time to the stage.
    template <class Work>
    void run(Stage stage, const Work& work) {
        const Clock::time_point begin = Clock::now();
        work();
        report.stage_ms[static_cast<std::size_t>(stage)] += milliseconds_since(begin);
    }

    StepReport finish() {
        report.total_ms = milliseconds_since(begin_);
        return std::move(report);
    }

    StepReport report;

private:
    using Clock = std::chrono::steady_clock;
    static double milliseconds_since(Clock::time_point begin) {
        return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    }
    Clock::time_point begin_;
};

}  // namespace carom::dynamics
