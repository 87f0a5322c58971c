// Error against run time: what a study is, and how it is measured.
//
//   Study study{.name = "rays", .stage = "primitive and ray tests", ...};
//   study.candidates.push_back({"carom", {{"precision", "double"}}, [cases] { return cast_all(*cases); }});
//   StudyResult result = measure(study, {.repeats = 9});
//
// Every candidate of a study solves the same cases, so that times and errors of a study compare. Cases that differ in how hard
// they are (near, far, tiny) are studies of their own.
#pragma once

#include <carom/core/result.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace carom::accuracy {

/// The knobs of a candidate, in the order that tables show them.
using Value = std::variant<double, std::string>;
using Settings = std::vector<std::pair<std::string, Value>>;

/// @return "precision=double width=8".
[[nodiscard]] std::string to_string(const Settings& settings);

/// What one pass over the cases of a study gave.
struct Sample {
    double time_s = 0.0;          ///< wall time of the work alone, without comparing with the oracle [s]
    std::optional<double> error;  ///< in the study's measure, >= 0; none where there is no answer to judge
    std::size_t failures = 0;     ///< cases without an answer: an error, a cap reached, a value that is not finite
    std::string note{};           ///< what the pass says about itself, such as which method it chose; mostly empty
};

/// One way to do the work, at one setting of its knobs.
struct Candidate {
    std::string who;                ///< "carom", or the name of a peer
    Settings settings;
    std::function<Sample()> run;    ///< one pass; must give the same error each time
};

struct Study {
    std::string name{};    ///< letters, digits and '_': files are named after it
    std::string stage{};   ///< of the pipeline: "primitive and ray tests"
    std::string error{};   ///< what the error measures, in words
    std::string unit{};    ///< of the error; "1" for a ratio
    std::string oracle{};  ///< what the error is measured against
    std::string time = "one pass over all cases";  ///< what Sample::time_s is the time of
    Settings cases{};      ///< the knobs of the cases, where studies of a group differ by them
    std::vector<Candidate> candidates{};
};

/// A candidate as measured.
struct Point {
    std::string who;
    Settings settings;
    double time_s = 0.0;          ///< median over the repeats [s]
    double time_iqr_s = 0.0;      ///< upper less lower quartile [s]
    std::optional<double> error;  ///< the largest over the repeats; none where a case failed
    std::size_t failures = 0;     ///< the largest over the repeats
    std::string note{};           ///< of the last pass
};

/// The errors whose time a study asks for.
inline constexpr std::array<double, 3> kReach{1e-2, 1e-3, 1e-4};

struct StudyResult {
    std::string name, stage, error, unit, oracle, time;
    Settings cases;
    std::vector<Point> points;         ///< in the order of the candidates; failed ones too
    std::vector<std::size_t> front;    ///< pareto_front(points)
    std::array<std::optional<double>, kReach.size()> time_to;  ///< time_to_reach over the points of "carom" [s]
};

struct MeasureSettings {
    int repeats = 9;  ///< counted passes of each candidate, >= 1; one more goes before them to warm up
    /// Called after each round of all candidates with the number of rounds done and of all; may be empty.
    std::function<void(int done, int all)> progress{};
};

/// Runs the candidates in turns, one pass each a round, so that what slows the machine down slows all of them; each round starts
/// with another candidate.
///
/// A pass whose error is missing, negative or not finite counts as a failure where it names none. A point with failures has no
/// error; it stays in the list.
/// Misuse (no repeats, no candidate, a candidate without a function, a time that is negative or not finite: InvalidArgument) is
/// reported; then a result without points.
[[nodiscard]] StudyResult measure(const Study& study, const MeasureSettings& settings = {});

/// @return the points that no other beats in time and error at once (at least as good in both, better in one), as indices in
/// order of time; equal points are all there. Points without an error are never among them. Cost: O(n log n).
[[nodiscard]] std::vector<std::size_t> pareto_front(const std::vector<Point>& points);

/// @return the least time of the points of `who` whose error is at most `error`, without interpolation; none where there is none [s].
[[nodiscard]] std::optional<double> time_to_reach(const std::vector<Point>& points, const std::string& who, double error);

struct Quartiles {
    double lower = 0.0, median = 0.0, upper = 0.0;
};

/// Quartiles by linear interpolation between order statistics: of n sorted values x, the quantile p is x at the place p (n - 1),
/// counted from 0 (Hyndman and Fan 1996, definition 7).
/// @param values  not empty, finite; misuse is reported and gives zeros.
[[nodiscard]] Quartiles quartiles(std::vector<double> values);

/// Wall time from its creation, by a clock that never goes back.
class Stopwatch {
public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Processor time of the calling thread from its creation: what other programs take is not counted. A look costs some 0.2 us.
class ThreadStopwatch {
public:
    [[nodiscard]] double seconds() const { return now() - start_; }

private:
    static double now();
    double start_ = now();
};

}  // namespace carom::accuracy
