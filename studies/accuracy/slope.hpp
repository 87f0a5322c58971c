// How fast an error falls with a knob: the order of a method as its points show it.
//
//   for (const Series& s : slopes(result, "dt")) print(s.slope);        // 2: half the step, a quarter of the error
#pragma once

#include <carom/studies/accuracy/study.hpp>

#include <optional>
#include <string>
#include <vector>

namespace carom::accuracy {

/// Points of one candidate that differ in one knob alone.
struct Series {
    std::string who{};
    Settings settings{};          ///< the others
    std::size_t points = 0;       ///< with an error
    double largest = 0.0;         ///< of the errors
    std::optional<double> slope{};  ///< d log(error) / d log(knob) by least squares; none where fewer than three points tell it
};

/// What a slope is fitted to: from the largest knob on, errors up to `most`, beyond which the law of small steps does not hold, until one below
/// `rounding` falls by less than half an order.
struct SlopeRange {
    double most = 0.3, rounding = 1e-8;
};

/// @param knob  a setting that is a number; points without it are left out.
/// @return the series of three points and more, in the order of their first ones.
[[nodiscard]] std::vector<Series> slopes(const StudyResult& result, const std::string& knob, const SlopeRange& range = {});

}  // namespace carom::accuracy
