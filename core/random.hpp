// The seeded random stream of scenes, tests and studies.
//
//   Random random(12345);
//   double a = random.range(0.25, 0.5);
#pragma once

#include <cstdint>

namespace carom {

/// Knuth's MMIX linear congruential generator, of which the upper 53 bits are used. Good enough to scatter bodies, the
/// same everywhere; never use it for statistics.
class Random {
public:
    explicit Random(std::uint64_t seed) noexcept : state_(seed) {}

    /// @return uniform in [0, 1), a multiple of 2^-53.
    double unit() noexcept {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 11) * 0x1p-53;
    }

    /// @return uniform in [low, high), up to rounding.
    double range(double low, double high) noexcept { return low + (high - low) * unit(); }

private:
    std::uint64_t state_;
};

}  // namespace carom
