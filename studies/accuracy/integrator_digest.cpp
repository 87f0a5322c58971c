#include <carom/studies/accuracy/integrator_digest.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace carom::accuracy {
namespace {

constexpr double kExact = 1e-10;      // what rounding may add up to over a run
constexpr double kLeastOrder = 1.95;  // "2": what a fit to steps of finite length gives

const Value* find(const Settings& settings, const std::string& key) {
    const auto at = std::ranges::find(settings, key, [](const auto& s) { return s.first; });
    return at == settings.end() ? nullptr : &at->second;
}

bool is_energy(const std::string& study) { return study.ends_with("_energy"); }

OrderVerdict verdict_of(const std::string& study, const Series& series) {
    if (series.who != "carom") return OrderVerdict::NotAsked;
    if (series.largest <= kExact) return OrderVerdict::Exact;
    const Value* const asked = find(series.settings, "tolerance");
    const double tolerance = asked != nullptr ? std::get<double>(*asked) : 1.0;
    if (tolerance < 1.0) {  // sub-cycled to a bound on the energy, not by an order
        if (!is_energy(study)) return OrderVerdict::NotAsked;
        return series.largest <= tolerance ? OrderVerdict::Passed : OrderVerdict::Failed;
    }
    return series.slope && *series.slope >= kLeastOrder ? OrderVerdict::Passed : OrderVerdict::Failed;
}

std::string spin_text(std::span<const StudyResult> results) {
    std::string text;
    for (const StudyResult& result : results) {
        if (!result.name.starts_with("integrator_single_body_spin")) continue;
        const double most = is_energy(result.name) ? kMostSpinEnergy : kMostSpinMomentum;
        for (const Point& p : result.points) {
            const bool passed = p.error && *p.error < most;
            text += fmt::format("  {:<38} {:<8} {:>10}  {:>8.0e}  {}\n", result.name, p.who, p.error ? fmt::format("{:.1e}", *p.error) : "failed", most,
                                passed ? "pass" : "fail");
        }
    }
    if (text.empty()) return text;
    return fmt::format("the spinning box at dt = 1/60 s\n  {:<38} {:<8} {:>10}  {:>8}\n", "study", "who", "error", "asked") + text;
}

}  // namespace

const char* to_string(OrderVerdict verdict) noexcept {
    switch (verdict) {
        case OrderVerdict::Passed: return "pass";
        case OrderVerdict::Exact: return "exact";
        case OrderVerdict::Failed: return "fail";
        case OrderVerdict::NotAsked: return "-";
    }
    return "unknown";
}

std::vector<OrderRow> order_rows(std::span<const StudyResult> results) {
    std::vector<OrderRow> rows;
    for (const StudyResult& result : results) {
        for (Series& series : slopes(result, "dt")) {
            const OrderVerdict verdict = verdict_of(result.name, series);
            rows.push_back({result.name, std::move(series), verdict});
        }
    }
    return rows;
}

Digest integrator_digest(std::span<const StudyResult> results) {
    Digest digest;
    digest.table = fmt::format("order: error ~ dt^order\n  {:<31} {:<8} {:<38} {:>8} {:>7}\n", "study", "who", "settings", "largest", "order");
    for (const OrderRow& row : order_rows(results)) {
        digest.table += fmt::format("  {:<31} {:<8} {:<38} {:>8.1e} {:>7}  {}\n", row.study, row.series.who, to_string(row.series.settings),
                                    row.series.largest, row.series.slope ? fmt::format("{:.2f}", *row.series.slope) : "-",
                                    to_string(row.verdict));
    }
    digest.table += "\n" + spin_text(results);
    return digest;
}

}  // namespace carom::accuracy
