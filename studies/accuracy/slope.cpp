#include <carom/studies/accuracy/slope.hpp>

#include <algorithm>
#include <cmath>

namespace carom::accuracy {
namespace {

struct Sum {
    Series series{};
    std::vector<std::pair<double, double>> logs{};  // of knob and error, of those that are fitted
};

/// Of the points that are in order of falling knobs, those before rounding takes over.
void cut_rounding(std::vector<std::pair<double, double>>& logs, double rounding) {
    std::ranges::stable_sort(logs, std::ranges::greater{}, [](const auto& p) { return p.first; });
    for (std::size_t i = 1; i < logs.size(); ++i) {
        const bool falls = logs[i - 1].second - logs[i].second > 0.5 * (logs[i - 1].first - logs[i].first);
        if (falls || logs[i].second > std::log(rounding)) continue;
        logs.resize(i);
        return;
    }
}

std::optional<double> fitted(const std::vector<std::pair<double, double>>& logs) {
    if (logs.size() < 3) return std::nullopt;
    double x = 0.0, y = 0.0;
    for (const auto& [a, b] : logs) x += a, y += b;
    x /= static_cast<double>(logs.size()), y /= static_cast<double>(logs.size());
    double xx = 0.0, xy = 0.0;
    for (const auto& [a, b] : logs) xx += (a - x) * (a - x), xy += (a - x) * (b - y);
    return xx > 0.0 ? std::optional(xy / xx) : std::nullopt;
}

}  // namespace

std::vector<Series> slopes(const StudyResult& result, const std::string& knob, const SlopeRange& range) {
    std::vector<Sum> sums;
    for (const Point& point : result.points) {
        Settings others = point.settings;
        const auto at = std::ranges::find(others, knob, [](const auto& setting) { return setting.first; });
        if (at == others.end() || !std::holds_alternative<double>(at->second)) continue;
        const double value = std::get<double>(at->second);
        others.erase(at);
        auto sum = std::ranges::find_if(sums, [&](const Sum& s) { return s.series.who == point.who && s.series.settings == others; });
        if (sum == sums.end()) sum = sums.insert(sum, {.series = {.who = point.who, .settings = others}});
        if (!point.error) continue;
        ++sum->series.points;
        sum->series.largest = std::max(sum->series.largest, *point.error);
        if (*point.error > 0.0 && *point.error <= range.most && value > 0.0) sum->logs.emplace_back(std::log(value), std::log(*point.error));
    }
    std::vector<Series> out;
    for (Sum& sum : sums) {
        if (sum.series.points < 3) continue;
        cut_rounding(sum.logs, range.rounding);
        sum.series.slope = fitted(sum.logs);
        out.push_back(std::move(sum.series));
    }
    return out;
}

}  // namespace carom::accuracy
