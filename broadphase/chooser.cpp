#include <carom/broadphase/chooser.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace carom {
namespace {

constexpr int kCoarse = 8;  // cells an axis of the coarse grid
constexpr std::size_t kFewBoxes = 200;
constexpr double kClumped = 0.4;  // fill below this
constexpr double kSparseLine = 50.0;
constexpr double kFewMove = 0.15, kMostMove = 0.5;
constexpr double kManySizes = 6.0;  // p99 over median
constexpr double kLargeSize = 4.0;  // largest over median
constexpr double kStay = 1.25;      // how far beyond a threshold a scene must be to leave the method it has

double longest_edge(const FloatAabb& box) noexcept {
    const dvec3 edges = dvec3(box.upper) - dvec3(box.lower);
    return std::max(edges.x, std::max(edges.y, edges.z));
}

// Quarters of octaves, by the float's own bits: they ascend with the value.
std::size_t size_class(double edge) noexcept { return std::bit_cast<std::uint32_t>(static_cast<float>(edge)) >> 21; }
double size_of(std::size_t size_class) noexcept {
    return double(std::bit_cast<float>(static_cast<std::uint32_t>(size_class << 21 | 1u << 20)));
}

struct Extent {
    double origin = 0.0, mean = 0.0, length = 0.0;
};

Extent extent_along(int axis, std::span<const FloatAabb> boxes, std::span<const unsigned char> alive) noexcept {
    double sum = 0.0, squares = 0.0, n = 0.0, origin = 0.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (alive[i] == 0) continue;
        if (n == 0.0) origin = double(boxes[i].lower[axis]);
        const double x = double(boxes[i].lower[axis]) - origin;
        sum += x;
        squares += x * x;
        n += 1.0;
    }
    const double mean = sum / n;
    // An even spread has this length.
    return {origin, origin + mean, std::sqrt(12.0 * std::max(squares / n - mean * mean, 0.0))};
}

// Occupied cells of a coarse grid over the cells that boxes spread evenly would occupy.
double fill_of(std::span<const FloatAabb> boxes, std::span<const unsigned char> alive, const Extent extent[3], std::size_t count) noexcept {
    std::array<bool, kCoarse * kCoarse * kCoarse> occupied{};
    double cells = 1.0;
    for (int k = 0; k < 3; ++k) cells *= extent[k].length > 0.0 ? kCoarse : 1.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (alive[i] == 0) continue;
        std::size_t cell = 0;
        for (int k = 0; k < 3; ++k) {
            double c = 0.0;
            if (extent[k].length > 0.0) {
                c = kCoarse * ((double(boxes[i].lower[k]) - extent[k].mean) / extent[k].length + 0.5);
            }
            cell = kCoarse * cell + static_cast<std::size_t>(std::clamp(c, 0.0, kCoarse - 1.0));
        }
        occupied[cell] = true;
    }
    const auto found = static_cast<double>(std::count(occupied.begin(), occupied.end(), true));
    double empty = 1.0;  // chance that a cell stays empty: (1 - 1/cells)^count by squaring
    double power = 1.0 - 1.0 / cells;
    for (std::size_t rest = count; rest != 0; rest >>= 1) {
        if ((rest & 1u) != 0) empty *= power;
        power *= power;
    }
    return std::min(found / (cells * (1.0 - empty)), 1.0);
}

}  // namespace

SceneStatistics measure(std::span<const FloatAabb> boxes, std::span<const unsigned char> alive, double moving_share) {
    SceneStatistics scene;
    scene.moving_share = moving_share;
    std::array<std::uint32_t, 1024> sizes{};
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (alive[i] == 0) continue;
        const double edge = longest_edge(boxes[i]);
        scene.largest_size = std::max(scene.largest_size, edge);
        ++sizes[size_class(edge)];
        ++scene.count;
    }
    if (scene.count == 0) return scene;
    const auto quantile = [&](double share) {
        const auto wanted = static_cast<double>(scene.count) * share;
        double below = 0.0;
        std::size_t k = 0;
        while (k + 1 < sizes.size() && below + sizes[k] < wanted) below += sizes[k++];
        return std::min(size_of(k), scene.largest_size);
    };
    scene.median_size = quantile(0.5);
    scene.p99_size = quantile(0.99);
    const Extent extent[3] = {extent_along(0, boxes, alive), extent_along(1, boxes, alive), extent_along(2, boxes, alive)};
    for (const Extent& e : extent) {
        const double reach = std::max(e.length, scene.median_size);
        const double density =
            reach > 0.0 ? static_cast<double>(scene.count) * scene.median_size / reach : static_cast<double>(scene.count);
        scene.line_density = std::max(scene.line_density, density);
        scene.spread_axes += e.length > 8.0 * scene.median_size;
    }
    scene.fill = fill_of(boxes, alive, extent, scene.count);
    return scene;
}

MethodChoice choose_method(const SceneStatistics& s, BroadphaseMethod current) noexcept {
    using enum BroadphaseMethod;
    // A threshold is farther away for a scene that would leave its method by passing it.
    const auto upper = [&](BroadphaseMethod method, double limit) { return current == method ? limit * kStay : limit; };
    const auto lower = [&](BroadphaseMethod method, double limit) { return current == method ? limit / kStay : limit; };
    const auto count = static_cast<double>(s.count);
    if (count <= upper(BruteForce, kFewBoxes)) return {BruteForce, "few boxes: testing every pair costs least"};
    if (s.fill < upper(SortedAxes, kClumped) && s.moving_share < upper(SortedAxes, kFewMove) &&
        s.line_density < upper(SortedAxes, kSparseLine)) {
        return {SortedAxes, "boxes in clumps far apart, of which few move: a mover passes few ends"};
    }
    const bool uneven = s.fill < upper(SweepAndPrune, kClumped) || s.p99_size > lower(SweepAndPrune, kManySizes) * s.median_size;
    if (uneven && s.moving_share > lower(SweepAndPrune, kMostMove) && s.line_density < count) {
        return {SweepAndPrune, "most boxes move, and they are clumped or of many sizes: sorting anew costs least"};
    }
    if (s.largest_size > lower(HierarchicalGrid, kLargeSize) * s.median_size) {
        return {HierarchicalGrid, "some boxes are much larger than most: a grid for each size class"};
    }
    return {UniformGrid, "boxes of like size: one grid"};
}

std::string describe(const MethodChoice& choice, const SceneStatistics& s) {
    char numbers[240];
    std::snprintf(numbers, sizeof numbers, "%s (%zu boxes, largest %.3g and p99 %.3g times the median size, fill %.2f, %.0f %% moving)",
                  choice.reason, s.count, s.median_size > 0.0 ? s.largest_size / s.median_size : 1.0,
                  s.median_size > 0.0 ? s.p99_size / s.median_size : 1.0, s.fill, 100.0 * s.moving_share);
    return numbers;
}

}  // namespace carom
