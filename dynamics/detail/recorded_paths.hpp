// The paths of a step that was written down, to be searched again.
//
//   RecordedPath a(paths, slot_a), b(paths, slot_b);
//   if (touch_along(a, b, search, cores)) search.t;
#pragma once

#include <carom/dynamics/detail/path_touch.hpp>
#include <carom/dynamics/detail/step_paths.hpp>

#include <vector>

namespace carom::dynamics {

/// How a body went through a step: a leg from each impact to the next.
class RecordedPath {
public:
    struct Leg {
        double begin = 0.0, end = 1.0;
        Flight flight;
        Ride ride;
        bool flies = false, rides = false;
        BodyPath path;
    };

    /// @param paths  outlives this.
    RecordedPath(const StepPaths& paths, std::uint32_t slot);

    [[nodiscard]] std::vector<Leg>& legs() noexcept { return legs_; }
    /// @return where the principal frame was, by the integrator where it flew.
    [[nodiscard]] Pose pose_at(double t) const;

private:
    const BodyMass& mass_;
    double dt_;
    std::vector<Leg> legs_;
};

/// touch() over the step or a part of it, leg by leg. @param search  whose paths are set.
[[nodiscard]] bool touch_along(RecordedPath& a, RecordedPath& b, PathSearch& search, Cores& cores, double begin = 0.0);

}  // namespace carom::dynamics
