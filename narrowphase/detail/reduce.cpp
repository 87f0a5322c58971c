#include <carom/narrowphase/detail/reduce.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

using Chosen = std::array<int, kMaxManifoldPoints>;

const Candidate& at(std::span<const Candidate> candidates, int i) noexcept { return candidates[static_cast<std::size_t>(i)]; }

double distance_sq(const Candidate& a, const Candidate& b) noexcept {
    return (b.u - a.u) * (b.u - a.u) + (b.w - a.w) * (b.w - a.w);
}

// Twice the signed area of the triangle (a, b, c).
double area2(const Candidate& a, const Candidate& b, const Candidate& c) noexcept {
    return (b.u - a.u) * (c.w - a.w) - (b.w - a.w) * (c.u - a.u);
}

// The index with the largest score, if that is over `least`; otherwise -1. Ties go to the lower index.
template <class Score>
int best_of(std::span<const Candidate> candidates, double least, const Score& score) noexcept {
    int best = -1;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const double s = score(candidates[i]);
        if (s > least) {
            least = s;
            best = static_cast<int>(i);
        }
    }
    return best;
}

// Up to four corners of the outline.
int choose_outline(std::span<const Candidate> candidates, double tolerance, Chosen& chosen) noexcept {
    // A direction that is parallel to no edge of the usual patches, so that a corner is farthest along it.
    const auto along = [](const Candidate& c) { return c.u + 0.381966 * c.w; };
    chosen[0] = std::max(0, best_of(candidates, along(candidates[0]), along));
    const Candidate& a = at(candidates, chosen[0]);
    chosen[1] = best_of(candidates, tolerance * tolerance, [&](const Candidate& c) { return distance_sq(a, c); });
    if (chosen[1] < 0) return 1;
    const Candidate& b = at(candidates, chosen[1]);

    // An area counts from the tolerance times the longest side on.
    const double least = tolerance * std::sqrt(distance_sq(a, b));
    const int left = best_of(candidates, least, [&](const Candidate& c) { return area2(a, b, c); });
    const int right = best_of(candidates, least, [&](const Candidate& c) { return -area2(a, b, c); });
    if (left < 0 && right < 0) return 2;
    const bool is_left = right < 0 || (left >= 0 && area2(a, b, at(candidates, left)) >= -area2(a, b, at(candidates, right)));
    chosen[2] = is_left ? left : right;
    const Candidate& c = at(candidates, chosen[2]);

    // What lies outside the triangle adds the area of the triangle that it makes with the edge it sees.
    const double turn = is_left ? -1.0 : 1.0;
    chosen[3] = best_of(candidates, least, [&](const Candidate& d) {
        return std::max({turn * area2(a, b, d), turn * area2(b, c, d), turn * area2(c, a, d)});
    });
    return chosen[3] < 0 ? 3 : 4;
}

}  // namespace

int reduce_points(std::span<const Candidate> candidates, double tolerance, Chosen& chosen) noexcept {
    if (candidates.empty()) return 0;
    int count = choose_outline(candidates, tolerance, chosen);
    double least = at(candidates, chosen[0]).separation;
    for (int i = 1; i < count; ++i) least = std::min(least, at(candidates, chosen[static_cast<std::size_t>(i)]).separation);
    const int deepest = best_of(candidates, tolerance - least, [](const Candidate& c) { return -c.separation; });
    if (deepest < 0) return count;
    const Candidate& d = at(candidates, deepest);
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
        if (distance_sq(at(candidates, chosen[i]), d) < distance_sq(at(candidates, chosen[nearest]), d)) nearest = i;
    }
    const bool same_place = distance_sq(at(candidates, chosen[nearest]), d) <= tolerance * tolerance;
    if (count < kMaxManifoldPoints && !same_place) {
        chosen[static_cast<std::size_t>(count++)] = deepest;
    } else {
        chosen[nearest] = deepest;
    }
    return count;
}

}  // namespace carom::detail
