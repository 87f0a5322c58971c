#include <carom/narrowphase/detail/reduce.hpp>

namespace carom::detail {
namespace {

// Twice the signed area of the triangle (a, b, c).
double area2(const Candidate& a, const Candidate& b, const Candidate& c) noexcept {
    return (b.u - a.u) * (c.w - a.w) - (b.w - a.w) * (c.u - a.u);
}

// The deepest; among equals the farthest along a direction that is parallel to no edge of the usual patches, which makes it a corner.
int deepest(std::span<const Candidate> candidates, double tolerance) noexcept {
    double least = candidates[0].separation;
    for (const Candidate& c : candidates) least = c.separation < least ? c.separation : least;
    int best = -1;
    double best_extent = 0.0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (candidates[i].separation > least + tolerance) continue;
        const double extent = candidates[i].u + 0.381966 * candidates[i].w;
        if (best < 0 || extent > best_extent) {
            best = static_cast<int>(i);
            best_extent = extent;
        }
    }
    return best;
}

}  // namespace

int reduce_points(std::span<const Candidate> candidates, double tolerance,
                  std::array<int, kMaxManifoldPoints>& chosen) noexcept {
    if (candidates.empty()) return 0;
    const auto at = [&](int i) -> const Candidate& { return candidates[static_cast<std::size_t>(i)]; };
    const int n = static_cast<int>(candidates.size());
    chosen[0] = deepest(candidates, tolerance);
    const Candidate& a = at(chosen[0]);

    double far = tolerance * tolerance;
    chosen[1] = -1;
    for (int i = 0; i < n; ++i) {
        const double du = at(i).u - a.u, dw = at(i).w - a.w;
        if (du * du + dw * dw > far) {
            far = du * du + dw * dw;
            chosen[1] = i;
        }
    }
    if (chosen[1] < 0) return 1;
    const Candidate& b = at(chosen[1]);

    // The farthest point on either side of the line a, b; an area counts from the tolerance times the length of the line on.
    const double length = (b.u - a.u > 0 ? b.u - a.u : a.u - b.u) + (b.w - a.w > 0 ? b.w - a.w : a.w - b.w);
    const double least_area = tolerance * length;
    double left = least_area, right = -least_area;
    int left_index = -1, right_index = -1;
    for (int i = 0; i < n; ++i) {
        const double area = area2(a, b, at(i));
        if (area > left) {
            left = area;
            left_index = i;
        } else if (area < right) {
            right = area;
            right_index = i;
        }
    }
    if (left_index < 0 && right_index < 0) return 2;
    chosen[2] = left > -right ? left_index : right_index;
    const Candidate& c = at(chosen[2]);

    // What lies outside the triangle adds the area of the triangle that it makes with the edge it sees.
    const double turn = left > -right ? 1.0 : -1.0;
    double gain = least_area;
    chosen[3] = -1;
    for (int i = 0; i < n; ++i) {
        const double outside_ab = -turn * area2(a, b, at(i));
        const double outside_bc = -turn * area2(b, c, at(i));
        const double outside_ca = -turn * area2(c, a, at(i));
        const double outside = outside_ab > outside_bc ? (outside_ab > outside_ca ? outside_ab : outside_ca)
                                                       : (outside_bc > outside_ca ? outside_bc : outside_ca);
        if (outside > gain) {
            gain = outside;
            chosen[3] = i;
        }
    }
    return chosen[3] < 0 ? 3 : 4;
}

}  // namespace carom::detail
