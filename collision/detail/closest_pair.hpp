// Closest points of the cores of any pair: chooses the function, and the order of its arguments.
//
//   const Nearest n = closest_cores(make_pair(a, b));   // n.a on the first core
#pragma once

#include <carom/collision/detail/closest_box.hpp>

namespace carom::geo::detail {

/// Below this many times eps times the size of a pair, a distance is a rounding.
inline constexpr double kRoundings = 8.0;
[[nodiscard]] inline double slack(double size) noexcept { return kRoundings * 0x1p-52 * size; }

/// Simpler cores first: point, segment, triangle, box along the axes, turned box.
template <class Core>
inline constexpr int kRank = std::is_same_v<Core, dvec3>              ? 0
                             : std::is_same_v<Core, Segment<double>>  ? 1
                             : std::is_same_v<Core, Triangle<double>> ? 2
                             : std::is_same_v<Core, AlignedBox>       ? 3
                                                                      : 4;

template <class A, class B>
[[nodiscard]] Nearest closest_cores(const A& a, const B& b, double size) noexcept {
    if constexpr (kRank < A >> kRank<B>) {
        return swapped(closest_cores(b, a, size));
    } else if constexpr (requires { closest(a, b, size); }) {
        return closest(a, b, slack(size));
    } else {
        return closest(a, b);
    }
}
template <class A, class B>
[[nodiscard]] Nearest closest_cores(const Pair<A, B>& pair) noexcept {
    return closest_cores(pair.a, pair.b, pair.size);
}

}  // namespace carom::geo::detail
