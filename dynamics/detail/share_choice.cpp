#include <carom/dynamics/detail/share_choice.hpp>

#include <algorithm>
#include <utility>

namespace carom::dynamics {

bool ShareChoice::next(std::size_t bodies) noexcept {
    if (!known_) {
        known_ = true;
        shares_ = bodies >= kManyBodies;
        return shares_;
    }
    if (!can_try()) {  // what was begun is given up
        left_ = 0;
        until_ = wait_;
        return shares_;
    }
    if (left_ == 0 && --until_ <= 0) left_ = kTrial;
    return left_ > 0 ? !shares_ : shares_;
}

// Now and then somebody else has the processor, and a step takes many times as long: of a trial the middle steps count, and of what is usual a step counts for
// a quarter more than the others at most, unless many in a row do.
void ShareChoice::took(double milliseconds, bool shared) noexcept {
    constexpr double kNew = 0.1, kClearly = 0.97;
    constexpr int kMany = 4;
    if (shared == shares_) {
        many_ = milliseconds > 1.25 * usual_ ? many_ + 1 : 0;
        usual_ = usual_ == 0.0 || many_ >= kMany ? milliseconds : usual_ + kNew * (std::min(milliseconds, 1.25 * usual_) - usual_);
        if (usual_ > 1.5 * compared_ || 1.5 * usual_ < compared_) {  // another scene
            compared_ = usual_;
            wait_ = until_ = kSoon;
        }
        return;
    }
    if (left_ == 0) return;
    trial_[static_cast<std::size_t>(--left_)] = milliseconds;
    if (left_ > 0) return;
    std::array<double, kTrial> sorted = trial_;
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        for (std::size_t k = i; k > 0 && sorted[k] < sorted[k - 1]; --k) std::swap(sorted[k], sorted[k - 1]);
    }
    const double trial = sorted[kTrial / 2];
    const bool better = trial < kClearly * usual_;
    if (better) {
        shares_ = shared;
        usual_ = trial;
    }
    compared_ = usual_;
    wait_ = better ? kSoon : std::min(2 * wait_, kLate);
    until_ = wait_;
}

}  // namespace carom::dynamics
