#include <carom/broadphase/chooser.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

namespace carom {
namespace {

constexpr std::size_t kSample = 1024;  // boxes that stand for all
constexpr int kCoarse = 16;            // cells an axis of the coarse grid
constexpr double kFewBoxes = 500.0, kFewMovingBoxes = 250.0;  // the latter where grids are built anew
constexpr double kOneCrowd = 0.25;  // of the boxes
constexpr double kClumped = 0.5;  // fill below this
constexpr double kSparseLine = 40.0;
constexpr double kFewMove = 0.15, kManyMove = 0.25;  // the grids are built anew from the latter on
constexpr double kLargeSize = 4.0;                   // largest over median
constexpr double kLargeCrowd = 150.0;
constexpr double kStay = 1.25;  // how far beyond a threshold a scene must be to leave the method it has

double longest_edge(const FloatAabb& box) noexcept {
    const dvec3 edges = dvec3(box.upper) - dvec3(box.lower);
    return std::max(edges.x, std::max(edges.y, edges.z));
}

// Live slots that stand for all, chosen by a hash of the slot, so that no order of the boxes shows.
struct Sample {
    std::array<std::uint32_t, kSample + kSample / 4> slots;
    std::size_t count = 0;
};

Sample draw(std::span<const unsigned char> alive, std::size_t live) noexcept {
    Sample sample;
    const double share = std::min(static_cast<double>(kSample) / static_cast<double>(live), 1.0);
    const auto below = static_cast<std::uint64_t>(share * 0x1p32);
    for (std::size_t i = 0; i < alive.size() && sample.count < sample.slots.size(); ++i) {
        const auto slot = static_cast<std::uint32_t>(i);
        if (alive[i] != 0 && (slot + 1u) * 0x9e3779b1u < below) sample.slots[sample.count++] = slot;
    }
    return sample;
}

// The value that a share of the values is below (Hoare 1961, "Find"). What it is does not depend on how it is found.
double quantile(std::span<float> values, double share) noexcept {
    const auto wanted = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ptrdiff_t first = 0, last = static_cast<std::ptrdiff_t>(values.size()) - 1;
    const auto at = [&](std::ptrdiff_t i) -> float& { return values[static_cast<std::size_t>(i)]; };
    while (first < last) {
        const float pivot = at(first + (last - first) / 2);
        std::ptrdiff_t i = first, j = last;
        while (i <= j) {
            while (at(i) < pivot) ++i;
            while (pivot < at(j)) --j;
            if (i <= j) std::swap(at(i++), at(j--));
        }
        if (wanted <= j)
            last = j;
        else if (wanted >= i)
            first = i;
        else
            break;
    }
    return double(at(wanted));
}

// Where most lower corners lie on an axis. Quantiles, not moments: one box far away says nothing about the others.
struct Extent {
    double middle = 0.0, length = 0.0;
};

Extent extent_along(int axis, std::span<const FloatAabb> boxes, const Sample& sample) noexcept {
    constexpr double kTail = 0.02;
    std::array<float, kSample + kSample / 4> store;
    const std::span<float> values(store.data(), sample.count);
    for (std::size_t i = 0; i < sample.count; ++i) values[i] = boxes[sample.slots[i]].lower[axis];
    const double low = quantile(values, kTail), high = quantile(values, 1.0 - kTail);
    return {0.5 * (low + high), (high - low) / (1.0 - 2.0 * kTail)};
}

// Occupied cells of a coarse grid over the cells that boxes spread evenly would occupy.
double fill_of(std::span<const FloatAabb> boxes, const Sample& sample, const Extent extent[3]) noexcept {
    std::array<bool, kCoarse * kCoarse * kCoarse> occupied{};
    double cells = 1.0;
    for (int k = 0; k < 3; ++k) cells *= extent[k].length > 0.0 ? kCoarse : 1.0;
    for (std::size_t i = 0; i < sample.count; ++i) {
        std::size_t cell = 0;
        for (int k = 0; k < 3; ++k) {
            double c = 0.0;
            if (extent[k].length > 0.0) {
                c = kCoarse * ((double(boxes[sample.slots[i]].lower[k]) - extent[k].middle) / extent[k].length + 0.5);
            }
            cell = kCoarse * cell + static_cast<std::size_t>(std::clamp(c, 0.0, kCoarse - 1.0));
        }
        occupied[cell] = true;
    }
    const auto found = static_cast<double>(std::count(occupied.begin(), occupied.end(), true));
    double empty = 1.0;  // chance that a cell stays empty: (1 - 1/cells)^count by squaring
    double power = 1.0 - 1.0 / cells;
    for (std::size_t rest = sample.count; rest != 0; rest >>= 1) {
        if ((rest & 1u) != 0) empty *= power;
        power *= power;
    }
    return std::min(found / (cells * (1.0 - empty)), 1.0);
}

}  // namespace

SceneStatistics measure(std::span<const FloatAabb> boxes, std::span<const unsigned char> alive, double moving_share) {
    SceneStatistics scene;
    scene.moving_share = moving_share;
    dvec3 largest{0.0};
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (alive[i] == 0) continue;
        const dvec3 edges = dvec3(boxes[i].upper) - dvec3(boxes[i].lower);
        largest = dvec3{std::max(largest.x, edges.x), std::max(largest.y, edges.y), std::max(largest.z, edges.z)};
        ++scene.count;
    }
    if (scene.count == 0) return scene;
    scene.largest_size = std::max(largest.x, std::max(largest.y, largest.z));
    const Sample sample = draw(alive, scene.count);
    if (sample.count == 0) return scene;
    std::array<float, kSample + kSample / 4> store;
    const std::span<float> sizes(store.data(), sample.count);
    for (std::size_t i = 0; i < sample.count; ++i) sizes[i] = static_cast<float>(longest_edge(boxes[sample.slots[i]]));
    scene.median_size = quantile(sizes, 0.5);
    scene.p99_size = quantile(sizes, 0.99);
    const Extent extent[3] = {extent_along(0, boxes, sample), extent_along(1, boxes, sample), extent_along(2, boxes, sample)};
    const auto count = static_cast<double>(scene.count);
    scene.largest_crowd = count;
    for (int k = 0; k < 3; ++k) {
        const double reach = std::max(extent[k].length, scene.median_size);
        scene.line_density = std::max(scene.line_density, reach > 0.0 ? count * scene.median_size / reach : count);
        scene.spread_axes += extent[k].length > 8.0 * scene.median_size;
        if (extent[k].length > largest[k]) scene.largest_crowd *= largest[k] / extent[k].length;
    }
    scene.fill = fill_of(boxes, sample, extent);
    return scene;
}

bool is_few(std::size_t count, double moving_share, BroadphaseMethod current) noexcept {
    const double few = moving_share > kManyMove ? kFewMovingBoxes : kFewBoxes;
    return static_cast<double>(count) <= (current == BroadphaseMethod::BruteForce ? kStay * few : few);
}

MethodChoice choose_method(const SceneStatistics& s, BroadphaseMethod current) noexcept {
    using enum BroadphaseMethod;
    // A threshold is farther away for a scene that would leave its method by passing it.
    const auto upper = [&](BroadphaseMethod method, double limit) { return current == method ? limit * kStay : limit; };
    const auto lower = [&](BroadphaseMethod method, double limit) { return current == method ? limit / kStay : limit; };
    if (is_few(s.count, s.moving_share, current)) return {BruteForce, "few boxes: testing every pair costs least"};
    if (static_cast<double>(s.count) <= upper(BruteForce, kFewBoxes) && s.largest_crowd > kOneCrowd * static_cast<double>(s.count)) {
        return {BruteForce, "few boxes, and most of them in one place: testing every pair costs least"};
    }
    if (s.moving_share < upper(SortedAxes, kFewMove) && s.line_density < upper(SortedAxes, kSparseLine)) {
        return {SortedAxes, "few boxes side by side along every axis, of which few move: a mover passes few ends"};
    }
    if (s.moving_share > lower(SweepAndPrune, kManyMove) && s.fill < upper(SweepAndPrune, kClumped) && s.spread_axes > 0) {
        return {SweepAndPrune, "many boxes move, and they are clumped: sorting anew costs least"};
    }
    if (s.largest_size > lower(HierarchicalGrid, kLargeSize) * s.median_size && s.largest_crowd > lower(HierarchicalGrid, kLargeCrowd)) {
        return {HierarchicalGrid, "cells as large as the largest box would be crowded: a grid for each size class"};
    }
    return {UniformGrid, "cells as large as the largest box hold few: one grid"};
}

SceneChoice choose_for(std::span<const FloatAabb> boxes, std::span<const unsigned char> alive, std::size_t live_count, double moving_share,
                       BroadphaseMethod current) {
    const bool few = is_few(live_count, moving_share, current);  // then nothing else is looked at
    const SceneStatistics scene =
        few ? SceneStatistics{.count = live_count, .moving_share = moving_share} : measure(boxes, alive, moving_share);
    return {choose_method(scene, current), scene};
}

std::string describe(const MethodChoice& choice, const SceneStatistics& s) {
    char numbers[280];
    if (choice.method == BroadphaseMethod::BruteForce) {
        std::snprintf(numbers, sizeof numbers, "%s (%zu boxes)", choice.reason, s.count);
        return numbers;
    }
    std::snprintf(numbers, sizeof numbers,
                  "%s (%zu boxes, largest %.3g times the median size, %.4g in its reach, %.4g side by side, fill %.2f, %.0f %% moving)",
                  choice.reason, s.count, s.median_size > 0.0 ? s.largest_size / s.median_size : 1.0, s.largest_crowd, s.line_density,
                  s.fill, 100.0 * s.moving_share);
    return numbers;
}

}  // namespace carom
