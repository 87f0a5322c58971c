#include <carom/collision/detail/closed_surface.hpp>

#include <carom/core/radix_sort.hpp>

#include <algorithm>
#include <numeric>

namespace carom {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::uint64_t ordered(float x) noexcept { return ordered_key(x + 0.0f); }  // -0 becomes +0

/// Calls `visit(a, b)` for each directed edge between different positions, of triangles whose corners all differ.
template <class Visit>
void for_each_edge(std::span<const Triangle> triangles, std::span<const std::uint32_t> position, Visit visit) {
    for (const Triangle& t : triangles) {
        const Triangle p{position[t[0]], position[t[1]], position[t[2]]};
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
        visit(p[0], p[1]);
        visit(p[1], p[2]);
        visit(p[2], p[0]);
    }
}

/// Insertion for what a vertex has in most meshes.
void sort_few(std::span<std::uint64_t> values) {
    constexpr std::size_t kFew = 32;
    if (values.size() > kFew) {
        std::stable_sort(values.begin(), values.end());
        return;
    }
    for (std::size_t i = 1; i < values.size(); ++i) {
        const std::uint64_t value = values[i];
        std::size_t k = i;
        for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
        values[k] = value;
    }
}

}  // namespace

std::vector<std::uint32_t> number_positions(std::span<const vec3> vertices) {
    std::vector<std::uint64_t> keys(vertices.size());
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        keys[i] = ordered(vertices[i].x) << 32 | ordered(vertices[i].y);
    }
    RadixScratch scratch;
    radix_sort(keys, order, scratch);
    std::vector<std::uint32_t> numbers(vertices.size());
    std::uint32_t next = 0;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        end = begin + 1;
        while (end < order.size() && keys[end] == keys[begin]) ++end;
        const auto depth = [&](std::uint32_t vertex) { return vertices[vertex].z; };
        if (end - begin > 1) {
            std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end),
                             [&](std::uint32_t i, std::uint32_t k) { return depth(i) < depth(k); });
        }
        for (std::size_t k = begin; k < end; ++k) {
            next += k > begin && depth(order[k - 1]) < depth(order[k]) ? 1u : 0u;
            numbers[order[k]] = next;
        }
        ++next;
    }
    return numbers;
}

// Each vertex keeps its edges to higher ones: twice the other end, and one more where the edge comes down from there. A closed surface
// has them in pairs, and an oriented one none of them twice.
SurfaceKind surface_kind(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    const std::vector<std::uint32_t> position = number_positions(vertices);
    std::vector<std::size_t> ends(vertices.size() + 1, 0);  // where the edges of a vertex begin, then where they end
    for_each_edge(triangles, position, [&](std::uint32_t a, std::uint32_t b) { ++ends[std::min(a, b) + 1]; });
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<std::uint64_t> edges(ends.back());
    bool closed = !edges.empty();
    for_each_edge(triangles, position, [&](std::uint32_t a, std::uint32_t b) {
        edges[ends[std::min(a, b)]++] = std::uint64_t{std::max(a, b)} << 1 | (a > b ? 1u : 0u);
    });
    for (std::size_t v = 0, begin = 0; v < vertices.size(); begin = ends[v++]) {
        const std::span<std::uint64_t> own = std::span(edges).subspan(begin, ends[v] - begin);
        sort_few(own);
        closed = closed && own.size() % 2 == 0;
        for (std::size_t k = 0; k + 1 < own.size(); ++k) {
            if (own[k + 1] == own[k]) return SurfaceKind::Loose;
            closed = closed && (k % 2 != 0 || (own[k] % 2 == 0 && own[k + 1] == own[k] + 1));
        }
    }
    return closed ? SurfaceKind::Closed : SurfaceKind::Oriented;
}

}  // namespace carom
