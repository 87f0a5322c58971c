// From boxes and their poses in double to the rows of floats that the kernels for many pairs read.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/box_lines.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>

#include <algorithm>
#include <cmath>

#ifndef CAROM_NARROWPHASE_BOX_LINES_ONCE
#define CAROM_NARROWPHASE_BOX_LINES_ONCE
namespace carom::detail {
namespace {

constexpr double kMostDistance = 1e30;  // beyond, differences of positions may leave the range of floats
constexpr std::size_t kRows = sizeof(BoxLine) / (4 * sizeof(float));

// Sixteen boxes, number by number.
struct BoxNumbers {
    DoubleBundle position[3][2], orientation[4][2];
    FloatBundle line[4 * kRows];
};

}  // namespace
}  // namespace carom::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

using HalfTag = hn::Rebind<float, DoubleTag>;  // as many floats as there are doubles in a vector
using HalfFloats = hn::Vec<HalfTag>;

HWY_INLINE HalfFloats to_half(Doubles a) { return hn::DemoteTo(HalfTag(), a.raw); }
HWY_INLINE void store_half(HalfFloats a, float* to) { hn::Store(a, HalfTag(), to); }

// Lanes from `lane` on of the doubles become rows; as glm::mat3_cast and box_line() do it.
HWY_INLINE void convert(BoxNumbers& n, int bundle, int lane) {
    const auto read = [&](const DoubleBundle (&of)[2]) { return load(of[bundle].lane + lane); };
    float* const out = n.line[0].lane + bundle * kDoubleBundleWidth + lane;
    const auto write = [out](std::size_t row, std::size_t column, HalfFloats value) { store_half(value, out + (4 * row + column) * kBundleWidth); };
    const Doubles x = read(n.orientation[0]), y = read(n.orientation[1]), z = read(n.orientation[2]), w = read(n.orientation[3]);
    const Doubles xx = x * x, yy = y * y, zz = z * z, xz = x * z, xy = x * y, yz = y * z, wx = w * x, wy = w * y, wz = w * z;
    const Doubles one(1.0), two(2.0);
    const Doubles axes[3][3] = {{one - two * (yy + zz), two * (xy + wz), two * (xz - wy)},
                                {two * (xy - wz), one - two * (xx + zz), two * (yz + wx)},
                                {two * (xz + wy), two * (yz - wx), one - two * (xx + yy)}};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) write(k, i, to_half(axes[k][i]));
    }
    for (std::size_t i = 0; i < 3; ++i) {
        Doubles rest = read(n.position[i]);
        for (std::size_t part = 0; part < 3; ++part) {
            const HalfFloats rounded = to_half(rest);
            write(3 + part, i, rounded);
            rest = rest - Doubles(hn::PromoteTo(DoubleTag(), rounded));
        }
    }
}

void WriteBoxLines(const PlacedShapes& placed, std::span<const std::uint32_t> numbers, std::span<const std::uint32_t> places, std::span<BoxLine> lines) {
    BoxNumbers n;
    alignas(64) std::int32_t to[kBundleWidth];
    for (std::size_t first = 0; first < numbers.size(); first += kBundleWidth) {
        const std::size_t count = std::min<std::size_t>(kBundleWidth, numbers.size() - first);
        for (std::size_t l = 0; l < kBundleWidth; ++l) {
            const std::size_t of = first + (l < count ? l : 0);  // the first stands in for those that are not there
            const std::uint32_t number = numbers[of];
            const Pose& pose = placed.poses[number];
            const std::size_t bundle = l / kDoubleBundleWidth, lane = l % kDoubleBundleWidth;
            to[l] = static_cast<std::int32_t>(places[of]);
            double largest = 0.0;
            for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(pose.position[i]));
            const bool far = largest > kMostDistance;
            for (int i = 0; i < 3; ++i) n.position[i][bundle].lane[lane] = far ? 0.0 : pose.position[i];
            n.orientation[0][bundle].lane[lane] = pose.orientation.x;
            n.orientation[1][bundle].lane[lane] = pose.orientation.y;
            n.orientation[2][bundle].lane[lane] = pose.orientation.z;
            n.orientation[3][bundle].lane[lane] = pose.orientation.w;
            const vec3& half = std::get_if<Box>(placed.shapes[number])->half_extents;
            for (int k = 0; k < 3; ++k) n.line[4 * k + 3].lane[l] = half[k];
            n.line[15].lane[l] = far ? 1.0f : 0.0f;
        }
        for (int bundle = 0; bundle < 2; ++bundle) {
            for (int lane = 0; lane < kDoubleBundleWidth; lane += kDoubleLanes) convert(n, bundle, lane);
        }
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            for (std::size_t row = 0; row < kRows; ++row) {
                const auto of = [&](std::size_t column) { return load(n.line[4 * row + column].lane + lane); };
                scatter_rows(lines.data()->axis[0], to + lane, 4 * kRows, 4 * row, of(0), of(1), of(2), of(3));
            }
        }
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(WriteBoxLines);
void write_box_lines(const PlacedShapes& placed, std::span<const std::uint32_t> numbers, std::span<const std::uint32_t> places, std::span<BoxLine> lines) {
    HWY_DYNAMIC_DISPATCH(WriteBoxLines)(placed, numbers, places, lines);
}
}  // namespace carom::detail
#endif
