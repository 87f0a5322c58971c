// Which broadphase method is fastest where, and how far the chooser is from it: what the studies of broadphases add up to.
//
//   std::vector<WinnerCell> cells = winner_cells(results, kHeldOut);
//   ChooserScore score = score_of(cells);                // median and worst ratio to the best method
#pragma once

#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/study.hpp>

#include <span>
#include <string>
#include <vector>

namespace carom::accuracy {

/// Maps by the name in StudyResult::cases: of the points that the chooser's thresholds come from, and of others.
inline constexpr const char* kKnown = "known";
inline constexpr const char* kHeldOut = "held_out";

struct WinnerCell {
    std::string condition;
    double count = 0.0;
    std::string best;        ///< the method that took least time
    double best_time = 0.0;  ///< for each box in an update [s]
    std::string chosen;      ///< what the chooser took
    double ratio = 1.0;      ///< time of the automatic choice, looking at the scene included, over best_time
};

/// @return a cell for each study of that map whose every point has an error, in their order.
[[nodiscard]] std::vector<WinnerCell> winner_cells(std::span<const StudyResult> results, const std::string& map);

struct ChooserScore {
    std::size_t count = 0;
    double median = 1.0, worst = 1.0;  ///< of WinnerCell::ratio; 1 where there are none
};
[[nodiscard]] ChooserScore score_of(std::span<const WinnerCell> cells);

/// The tables and pictures of both maps.
[[nodiscard]] Digest broadphase_digest(std::span<const StudyResult> results);

/// The script that draws a map: a field for each cell in the colour of its best method, with the time in it; a dot in the colour of the
/// method chosen, where that is another.
[[nodiscard]] std::string map_script(std::span<const WinnerCell> cells, const std::string& title, const std::string& svg);

}  // namespace carom::accuracy
