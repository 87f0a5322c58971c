#include <carom/dynamics/detail/least_shift.hpp>

#include <algorithm>
#include <cstddef>

namespace carom::dynamics {
namespace {

constexpr double kSlack = 1e-9;   // of the longest shift
constexpr double kNoSine = 1e-6;  // planes at a smaller angle are no corner

/// Takes note of shifts that are within all bounds, if they are shorter than the one that it has.
struct Search {
    std::span<const ShiftBound> bounds;
    double slack = 0.0;
    double shortest = 0.0;  ///< square [m²]
    std::optional<dvec3> found;

    void offer(const dvec3& shift) {
        const double square = glm::dot(shift, shift);
        if (!(square <= shortest) || (found && square == shortest)) return;
        const auto holds = [&](const ShiftBound& b) { return glm::dot(b.normal, shift) >= b.least - slack; };
        if (!std::all_of(bounds.begin(), bounds.end(), holds)) return;
        shortest = square;
        found = shift;
    }
};

}  // namespace

std::optional<dvec3> least_shift(std::span<const ShiftBound> bounds, double longest) {
    Search search{bounds, kSlack * longest, longest * longest, {}};
    search.offer(dvec3{0.0});
    if (search.found) return search.found;
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        const dvec3& a = bounds[i].normal;
        const double aa = glm::dot(a, a);
        if (aa < kNoSine * kNoSine) continue;  // nothing moves along it
        search.offer(bounds[i].least / aa * a);
        for (std::size_t j = 0; j < i; ++j) {
            const dvec3& b = bounds[j].normal;
            const double bb = glm::dot(b, b), ab = glm::dot(a, b), square = aa * bb - ab * ab;
            if (square <= kNoSine * kNoSine * aa * bb) continue;
            search.offer(((bounds[i].least * bb - bounds[j].least * ab) * a + (bounds[j].least * aa - bounds[i].least * ab) * b) / square);
            const dvec3 edge = glm::cross(a, b);
            for (std::size_t k = 0; k < j; ++k) {
                const dvec3& c = bounds[k].normal;
                const double volume = glm::dot(edge, c);
                if (volume * volume <= kNoSine * kNoSine * square * glm::dot(c, c)) continue;
                search.offer((bounds[i].least * glm::cross(b, c) + bounds[j].least * glm::cross(c, a) + bounds[k].least * edge) / volume);
            }
        }
    }
    return search.found;
}

}  // namespace carom::dynamics
