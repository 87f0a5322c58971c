// The cases of the studies of broadphases: boxes spread in a certain way, some of which go back and forth.
//
//   BoxCrowd crowd({.spread = Spread::Clustered, .count = 1000, .moving = 0.1});
//   for (int frame = 0; frame < crowd.frames(); ++frame) { crowd.go_to(frame); update(crowd.boxes(), crowd.movers()); }
#pragma once

#include <carom/broadphase/proxy.hpp>
#include <carom/core/random.hpp>
#include <carom/core/types.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace carom::accuracy {

enum class Spread : unsigned char {
    Even,        ///< in a cube
    Clustered,   ///< sqrt(count) clumps of as many boxes, far apart
    Planar,      ///< on a terrain
    Stacked,     ///< unit boxes in columns of 40 that stand side by side
    Line,        ///< along an axis
    Diagonal,    ///< along the diagonal of the axes
    Ground,      ///< in a cube, over one box that is as wide
    Coincident,  ///< all the same box
};

[[nodiscard]] const char* to_string(Spread spread) noexcept;

struct CrowdSettings {
    Spread spread = Spread::Even;
    std::size_t count = 1000;
    double moving = 0.1;      ///< share of the boxes that move, 0 .. 1; at least one does
    double size_ratio = 1.0;  ///< sizes are log-uniform between 1/sqrt(ratio) and sqrt(ratio) m, edges 0.5 .. 1.5 times that
    double overlaps = 3.0;    ///< others that a box overlaps, in the mean, as far as the spread leaves it open
    std::uint64_t seed = 1;
};

/// Boxes and where they are in each frame. A mover goes by up to 0.05 m a frame on each axis in a direction of its own: half of the frames
/// there, half of them back, so that the last frame is as before the first. The same numbers on every machine.
class BoxCrowd {
public:
    explicit BoxCrowd(const CrowdSettings& settings);

    /// Even; fewer where there are very many boxes.
    [[nodiscard]] int frames() const noexcept { return frames_; }
    /// Moves the movers to where they are at the end of frame 0 .. frames() - 1.
    void go_to(int frame);

    [[nodiscard]] std::span<const FloatAabb> boxes() const noexcept { return boxes_; }
    [[nodiscard]] std::span<const std::uint32_t> movers() const noexcept { return movers_; }
    /// The pairs that overlap at the end of the last frame, of some rows (pairs of one a), evenly chosen so that
    /// at most 1e8 pairs of boxes are looked at; of all rows up to 10,000 boxes. By oracle::pairs_of_row, at the first call.
    [[nodiscard]] const std::vector<ProxyPair>& exact_pairs();
    /// Whether the pairs of this a are among exact_pairs.
    [[nodiscard]] bool is_checked(std::uint32_t a) const noexcept { return a % stride_ == 0; }

private:
    void place(const CrowdSettings& settings, Random& random);

    std::vector<FloatAabb> boxes_, rest_;
    std::vector<std::uint32_t> movers_;
    std::vector<vec3> velocity_;  ///< of each mover [m/frame]
    std::vector<ProxyPair> exact_;
    bool has_exact_ = false;
    int frames_ = 2;
    std::uint32_t stride_ = 1;
};

}  // namespace carom::accuracy
