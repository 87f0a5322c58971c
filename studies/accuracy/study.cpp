#include <carom/studies/accuracy/study.hpp>

#include <carom/core/check.hpp>
#include <carom/core/types.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <time.h>

namespace carom::accuracy {
namespace {

// What the passes of one candidate add up to.
struct Tally {
    std::vector<double> times;
    double error = 0.0;
    std::size_t failures = 0;
    std::string note;

    void add(const Sample& sample) {
        times.push_back(sample.time_s);
        note = sample.note;
        const bool good = sample.error && is_finite(*sample.error) && *sample.error >= 0.0;
        failures = std::max(failures, sample.failures > 0 || good ? sample.failures : 1);
        if (good) error = std::max(error, *sample.error);
    }
};

Point point_of(const Candidate& candidate, const Tally& tally) {
    Point point{candidate.who, candidate.settings, 0.0, 0.0, std::nullopt, tally.failures, tally.note};
    const Quartiles q = quartiles(tally.times);
    point.time_s = q.median;
    point.time_iqr_s = q.upper - q.lower;
    if (tally.failures == 0) point.error = tally.error;
    return point;
}

}  // namespace

std::string to_string(const Settings& settings) {
    std::string text;
    for (const auto& [key, value] : settings) {
        text += text.empty() ? "" : " ";
        text += std::holds_alternative<double>(value) ? fmt::format("{}={:g}", key, std::get<double>(value))
                                                      : fmt::format("{}={}", key, std::get<std::string>(value));
    }
    return text;
}

StudyResult measure(const Study& study, const MeasureSettings& settings) {
    StudyResult result{study.name, study.stage, study.error, study.unit, study.oracle, study.time, study.cases, {}, {}, {}};
    CAROM_REQUIRE(settings.repeats >= 1, ErrorCode::InvalidArgument, "repeats must be at least 1", result);
    const bool runnable = std::ranges::all_of(study.candidates, [](const Candidate& c) { return static_cast<bool>(c.run); });
    CAROM_REQUIRE(!study.candidates.empty() && runnable, ErrorCode::InvalidArgument, "a study needs candidates that can run", result);

    const std::size_t count = study.candidates.size();
    std::vector<Tally> tallies(count);
    for (int round = 0; round <= settings.repeats; ++round) {
        for (std::size_t turn = 0; turn < count; ++turn) {
            const std::size_t i = (turn + static_cast<std::size_t>(round)) % count;
            const Sample sample = study.candidates[i].run();
            CAROM_REQUIRE(is_finite(sample.time_s) && sample.time_s >= 0.0, ErrorCode::InvalidArgument,
                          "a pass took a time that is negative or not finite", result);
            if (round > 0) tallies[i].add(sample);  // the first round warms up
        }
        if (settings.progress) settings.progress(round + 1, settings.repeats + 1);
    }

    for (std::size_t i = 0; i < count; ++i) {
        result.points.push_back(point_of(study.candidates[i], tallies[i]));
    }
    result.front = pareto_front(result.points);
    for (std::size_t i = 0; i < kReach.size(); ++i) {
        result.time_to[i] = time_to_reach(result.points, "carom", kReach[i]);
    }
    return result;
}

std::vector<std::size_t> pareto_front(const std::vector<Point>& points) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].error) order.push_back(i);
    }
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
        if (points[a].time_s != points[b].time_s) return points[a].time_s < points[b].time_s;
        return *points[a].error != *points[b].error ? *points[a].error < *points[b].error : a < b;
    });
    // Along growing time a point is on the front if its error is below all before it, or if it equals the last one there.
    std::vector<std::size_t> front;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order) {
        const bool equal = !front.empty() && *points[i].error == least && points[i].time_s == points[front.back()].time_s;
        if (*points[i].error < least || equal) front.push_back(i);
        least = std::min(least, *points[i].error);
    }
    return front;
}

std::optional<double> time_to_reach(const std::vector<Point>& points, const std::string& who, double error) {
    std::optional<double> least;
    for (const Point& point : points) {
        if (point.who != who || !point.error || !(*point.error <= error)) continue;
        least = std::min(least.value_or(point.time_s), point.time_s);
    }
    return least;
}

Quartiles quartiles(std::vector<double> values) {
    const bool good = !values.empty() && std::ranges::all_of(values, [](double v) { return is_finite(v); });
    CAROM_REQUIRE(good, ErrorCode::InvalidArgument, "quartiles need values, and finite ones", {});
    std::ranges::sort(values);
    const auto quantile = [&](double p) {
        const double place = p * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(place);
        const double above = values[std::min(below + 1, values.size() - 1)];
        return values[below] + (place - static_cast<double>(below)) * (above - values[below]);
    };
    return {quantile(0.25), quantile(0.5), quantile(0.75)};
}

double ThreadStopwatch::now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace carom::accuracy
