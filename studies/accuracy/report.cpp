#include <carom/studies/accuracy/report.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace carom::accuracy {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, kReach.size()> kReachNames{"1e-2", "1e-3", "1e-4"};

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json settings_json(const Settings& settings) {
    Json out = Json::object();
    for (const auto& [key, value] : settings) {
        std::visit([&](const auto& v) { out[key] = v; }, value);
    }
    return out;
}

Json study_json(const StudyResult& result) {
    Json points = Json::array();
    for (const Point& p : result.points) {
        points.push_back({{"who", p.who},
                          {"settings", settings_json(p.settings)},
                          {"time_s", p.time_s},
                          {"time_iqr_s", p.time_iqr_s},
                          {"error", or_null(p.error)},
                          {"failures", p.failures},
                          {"note", p.note}});
    }
    Json time_to = Json::object();
    for (std::size_t i = 0; i < kReach.size(); ++i) {
        time_to[kReachNames[i]] = or_null(result.time_to[i]);
    }
    return {{"name", result.name},     {"stage", result.stage}, {"error", result.error}, {"unit", result.unit},
            {"oracle", result.oracle}, {"time", result.time},   {"cases", settings_json(result.cases)},
            {"points", points},      {"front", result.front}, {"time_to", time_to}};
}

std::string quoted(const std::string& field) {
    if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
    std::string out = "\"";
    for (const char c : field) {
        out += c == '"' ? "\"\"" : std::string(1, c);
    }
    return out + "\"";
}

bool on_front(const StudyResult& result, std::size_t index) { return std::ranges::find(result.front, index) != result.front.end(); }

std::string time_text(const std::optional<double>& seconds) {
    if (!seconds) return "-";
    const double s = *seconds;
    if (s < 1e-6) return fmt::format("{:.3g} ns", s * 1e9);
    if (s < 1e-3) return fmt::format("{:.3g} us", s * 1e6);
    return s < 1.0 ? fmt::format("{:.3g} ms", s * 1e3) : fmt::format("{:.3g} s", s);
}

// Everybody who took part, Carom first.
std::vector<std::string> names_of(const StudyResult& result) {
    std::vector<std::string> names{"carom"};
    for (const Point& p : result.points) {
        if (std::ranges::find(names, p.who) == names.end()) names.push_back(p.who);
    }
    return names;
}

}  // namespace

std::string to_json(std::span<const StudyResult> results) {
    Json studies = Json::array();
    for (const StudyResult& result : results) {
        studies.push_back(study_json(result));
    }
    return Json{{"studies", studies}}.dump(2) + "\n";
}

std::string to_csv(const StudyResult& result) {
    std::string text = "who,settings,time_s,time_iqr_s,error,failures,front,note\n";
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Point& p = result.points[i];
        text += fmt::format("{},{},{},{},{},{},{},{}\n", quoted(p.who), quoted(to_string(p.settings)), p.time_s, p.time_iqr_s,
                            p.error ? fmt::format("{}", *p.error) : "", p.failures, on_front(result, i) ? 1 : 0, quoted(p.note));
    }
    return text;
}

std::string to_table(const StudyResult& result) {
    std::vector<std::size_t> order(result.points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        const Point &p = result.points[a], &q = result.points[b];
        return p.error.has_value() != q.error.has_value() ? p.error.has_value() : p.time_s < q.time_s;
    });
    std::size_t widest = 8;
    for (const Point& p : result.points) {
        widest = std::max(widest, to_string(p.settings).size());
    }
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{}: {}\n  oracle: {}\n  time: {}\n", result.name, result.error, result.oracle, result.time);
    fmt::format_to(out, "  {:<8} {:<{}} {:>10} {:>10} {:>10} {:>8}\n", "who", "settings", widest, "time", "IQR", "error", "failures");
    for (const std::size_t i : order) {
        const Point& p = result.points[i];
        fmt::format_to(out, "{} {:<8} {:<{}} {:>10} {:>10} {:>10} {:>8}{}{}\n", on_front(result, i) ? '*' : ' ', p.who, to_string(p.settings),
                       widest, time_text(p.time_s), time_text(p.time_iqr_s), p.error ? fmt::format("{:.2e}", *p.error) : "failed",
                       p.failures, p.note.empty() ? "" : "  ", p.note);
    }
    for (const std::string& who : names_of(result)) {
        fmt::format_to(out, "  time for {} to reach", who);
        for (std::size_t k = 0; k < kReach.size(); ++k) {
            fmt::format_to(out, "{} {}: {}", k == 0 ? "" : ",", kReachNames[k], time_text(time_to_reach(result.points, who, kReach[k])));
        }
        fmt::format_to(out, "\n");
    }
    return fmt::to_string(text);
}

}  // namespace carom::accuracy
