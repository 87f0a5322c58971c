// Whether the next step is worth several threads: by how long steps take with them and without.
//
//   const bool shared = choice.next(bodies);
//   ... the step ...
//   choice.took(milliseconds, shared);
//
// Threads take 10 to 20 µs to come together, more where others use the processors. Where a step takes about as long either way both ways are tried now and
// then, and the shorter one is kept; where there is next to nothing to do, one thread does it. It changes times, never results.
#pragma once

#include <array>
#include <cstddef>

namespace carom::dynamics {

class ShareChoice {
public:
    static constexpr double kLittle = 0.15;                    ///< [ms]: what one thread does in less is not shared
    static constexpr double kMuch = 1.0;                       ///< [ms]: what takes threads longer is not tried on one
    static constexpr std::size_t kManyBodies = 300;            ///< share the first step
    static constexpr int kTrial = 5, kSoon = 16, kLate = 512;  ///< [steps]: of a trial, and until the first and the rarest

    /// @return whether threads should share the next step.
    /// @param bodies  what the first step goes by
    [[nodiscard]] bool next(std::size_t bodies) noexcept;
    /// What the step took that was shared, or was not.
    void took(double milliseconds, bool shared) noexcept;

private:
    [[nodiscard]] bool can_try() const noexcept { return shares_ ? usual_ < kMuch : usual_ >= kLittle; }

    bool known_ = false, shares_ = false;
    double usual_ = 0.0;                  // smoothed [ms]
    std::array<double, kTrial> trial_{};  // [ms]
    double compared_ = 0.0;               // the same when the two ways were last compared
    int many_ = 0;                        // steps in a row that took much longer
    int left_ = 0;                        // steps of the trial
    int wait_ = kSoon, until_ = kSoon;    // steps from trial to trial, and to the next
};

}  // namespace carom::dynamics
