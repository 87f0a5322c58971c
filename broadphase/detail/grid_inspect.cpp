// The cells of a grid for pictures.
#include <carom/broadphase/detail/grid_level.hpp>

#include <algorithm>
#include <array>

namespace carom::detail {
namespace {

using Cell = std::array<std::uint32_t, 3>;

Cell cell_at(const GridLevel& g, std::size_t at) noexcept {
    Cell c;
    for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = g.map.coordinate(k, g.entries.lower[k][at]);
    return c;
}

FloatAabb box_of(const CellMap& map, const Cell& c) noexcept {
    FloatAabb box;
    for (int k = 0; k < 3; ++k) {
        const double edge = map.per_metre[k] > 0.0f ? 1.0 / double{map.per_metre[k]} : 0.0;
        const double low = double{map.origin[k]} + c[static_cast<std::size_t>(k)] * edge;
        box.lower[map.axes[k]] = static_cast<float>(low);
        box.upper[map.axes[k]] = static_cast<float>(low + edge);
    }
    return box;
}

}  // namespace

void GridLevel::visit_cells(int level, FunctionRef<void(const BroadphasePart&)> visit) const {
    for (std::size_t entry = 0; entry < used.size(); ++entry) {
        const std::size_t first = begin[entry], last = first + used[entry];
        for (std::size_t at = first; at < last; ++at) {  // cells that share an entry of the table are told apart
            const Cell cell = cell_at(*this, at);
            std::size_t before = first;
            while (before < at && cell_at(*this, before) != cell) ++before;
            if (before < at) continue;
            std::size_t count = 1;
            for (std::size_t later = at + 1; later < last; ++later) count += !map.hashed || cell_at(*this, later) == cell;
            visit({box_of(map, cell), level, count});
            if (!map.hashed) break;
        }
    }
    for (std::size_t at = stray_begin; at < stray_end; ++at) visit(part_at(at, level));
}

BroadphasePart GridLevel::part_at(std::size_t at, int level) const {
    if (at >= stray_begin) {
        FloatAabb box;
        for (int k = 0; k < 3; ++k) {
            box.lower[map.axes[k]] = entries.lower[k][at];
            box.upper[map.axes[k]] = entries.upper[k][at];
        }
        return {box, level, 1, true};
    }
    const Cell cell = cell_at(*this, at);
    const std::size_t entry = map.cell(cell[0], cell[1], cell[2]);
    std::size_t count = 0;
    for (std::size_t other = begin[entry]; other < begin[entry] + used[entry]; ++other) count += cell_at(*this, other) == cell;
    return {box_of(map, cell), level, count};
}

}  // namespace carom::detail
