// Rays through a grid, in the manner of Amanatides and Woo 1987 ("A Fast Voxel Traversal Algorithm for Ray Tracing") but a layer of cells
// at a time: along the axis on which the ray crosses most cells, each layer is entered once, and of the layer just those cells are
// looked at that the ray's piece in it can have to do with. As a box is listed in one cell, and a cell is in one layer, no box is met
// twice: what mail boxes are for elsewhere. Every bound is rounded outward, so that the walk misses nothing that the exact test
// of a box would accept.
#include <carom/broadphase/detail/grid_level.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

constexpr double kRounding = 0x1p-46;  // of the sum of what goes into a coordinate: more than all rounding of walk and test
constexpr double kHuge = 1e300;        // beyond every float, and finite
constexpr double kMostFloat{std::numeric_limits<float>::max()};

struct CoordinateRange {
    std::uint32_t first, last;
};

struct TimeSpan {
    double first, last;
};

// Where boxes may be listed that the path meets between two times.
CoordinateRange cells_between(const CellMap& map, const SweepPath& path, int k, const TimeSpan& t) noexcept {
    const int axis = map.axes[k];
    const double o = path.origin[axis], d = path.direction[axis], reach{map.reach[k]};
    const double a = std::clamp(t.first * d, -kHuge, kHuge), b = std::clamp(t.last * d, -kHuge, kHuge);
    const double low = o + std::min(a, b) - path.grow[axis], high = o + std::max(a, b) + path.grow[axis];
    const double slack = kRounding * (std::abs(o) + std::max(std::abs(a), std::abs(b)) + path.grow[axis] + reach);
    // Rounding to float never decreases as the value grows, and corners are floats, so it takes no cell away.
    const auto cell = [&](double x) { return map.coordinate(k, static_cast<float>(std::clamp(x, -kMostFloat, kMostFloat))); };
    return {cell((low - reach) - slack), cell(high + slack)};
}

// When the path is where boxes of this layer may be; empty if first > last.
TimeSpan time_in_layer(const CellMap& map, const SweepPath& path, int k, std::uint32_t layer) noexcept {
    const int axis = map.axes[k];
    const double o = path.origin[axis], d = path.direction[axis];
    if (d == 0.0) return {0.0, path.t_max};
    FloatAabb box;
    map.region(k, layer, box);
    const double lower{box.lower[axis]}, upper{box.upper[axis]};
    const double low = lower - path.grow[axis] - kRounding * (std::abs(o) + std::abs(lower));
    const double high = upper + path.grow[axis] + kRounding * (std::abs(o) + std::abs(upper));
    const double a = (low - o) / d, b = (high - o) / d;
    return {std::max(std::min(a, b), 0.0), std::min(std::max(a, b), path.t_max)};
}

// The axis of the grid along which the path crosses most cells.
int main_axis(const CellMap& map, const SweepPath& path) noexcept {
    int best = 0;
    double most = -1.0;
    for (int k = 0; k < 3; ++k) {
        const double length = std::min(std::abs(path.direction[map.axes[k]]) * path.t_max, kHuge);
        const double crossed = std::min(length * double{map.per_metre[k]}, double{map.last[k]});
        if (crossed <= most) continue;
        most = crossed;
        best = k;
    }
    return best;
}

}  // namespace

template <class F>
bool GridLevel::walk_layers(const SweepPath& path, F visit_cells) const {
    const int m = main_axis(map, path), axis = map.axes[m];
    const CoordinateRange layers = cells_between(map, path, m, {0.0, path.t_max});
    const bool backward = path.direction[axis] < 0.0;
    for (std::uint32_t i = 0; i <= layers.last - layers.first; ++i) {
        const std::uint32_t layer = backward ? layers.last - i : layers.first + i;
        const TimeSpan t = time_in_layer(map, path, m, layer);
        if (t.first > t.last) {
            if (t.first > path.t_max) break;  // and so are all later ones
            continue;
        }
        std::uint32_t first[3], last[3];
        for (int k = 0; k < 3; ++k) {
            const CoordinateRange range = k == m ? CoordinateRange{layer, layer} : cells_between(map, path, k, t);
            first[k] = range.first;
            last[k] = range.last;
        }
        if (!visit_cells(first, last)) return false;
    }
    return true;
}

bool GridLevel::visit_along(const ProxyTable& table, const SweepPath& path, FunctionRef<bool(const FloatAabb&)> touches,
                            FunctionRef<bool(std::uint32_t)> visit) const {
    if (map.hashed) {
        // Cells of a hash may be many more than boxes, all empty.
        double cells = 0.0;
        const bool worth_it = walk_layers(path, [&](const std::uint32_t first[3], const std::uint32_t last[3]) {
            double in_layer = 1.0;
            for (int k = 0; k < 3; ++k) in_layer *= static_cast<double>(last[k] - first[k]) + 1.0;
            cells += in_layer;
            return cells <= static_cast<double>(size_);
        });
        if (!worth_it) return visit_run(table, 0, stray_end, touches, visit);
    }
    // Where cells share an entry of the table, each takes only what is its own.
    const auto is_at_home = [&](std::size_t at, const std::uint32_t cell[3]) {
        for (int k = 0; k < 3; ++k) {
            if (map.coordinate(k, entries.lower[k][at]) != cell[k]) return false;
        }
        return true;
    };
    const auto visit_cell = [&](const std::uint32_t c[3]) {
        const std::uint32_t cell = map.cell(c[0], c[1], c[2]);
        const std::size_t end = std::size_t{begin[cell]} + used[cell];
        for (std::size_t at = begin[cell]; at < end; ++at) {
            if (map.hashed && !is_at_home(at, c)) continue;
            const std::uint32_t slot = static_cast<Tag>(entries.tag[at]) & kIndexMask;
            if (touches(table.boxes[slot]) && !visit(slot)) return false;
        }
        return true;
    };
    const bool never_stopped = walk_layers(path, [&](const std::uint32_t first[3], const std::uint32_t last[3]) {
        std::uint32_t c[3];
        for (c[2] = first[2]; c[2] <= last[2]; ++c[2]) {
            for (c[1] = first[1]; c[1] <= last[1]; ++c[1]) {
                for (c[0] = first[0]; c[0] <= last[0]; ++c[0]) {
                    if (!visit_cell(c)) return false;
                }
            }
        }
        return true;
    });
    return never_stopped && visit_run(table, stray_begin, stray_end, touches, visit);
}

}  // namespace carom::detail
