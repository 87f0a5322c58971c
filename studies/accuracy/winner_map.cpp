#include <carom/studies/accuracy/winner_map.hpp>

#include <carom/broadphase/method.hpp>
#include <carom/studies/accuracy/plot.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

namespace carom::accuracy {
namespace {

std::string text_of(const Settings& settings, const std::string& key) {
    for (const auto& [name, value] : settings) {
        if (name == key && std::holds_alternative<std::string>(value)) return std::get<std::string>(value);
    }
    return "";
}

double number_of(const Settings& settings, const std::string& key) {
    for (const auto& [name, value] : settings) {
        if (name == key && std::holds_alternative<double>(value)) return std::get<double>(value);
    }
    return 0.0;
}

std::optional<WinnerCell> cell_of(const StudyResult& result) {
    const std::string automatic = to_string(BroadphaseMethod::Automatic);
    WinnerCell cell{.condition = text_of(result.cases, "condition"), .count = number_of(result.cases, "count"), .best = {}, .chosen = {}};
    std::optional<double> own;
    for (const Point& p : result.points) {
        if (!p.error) return std::nullopt;
        const std::string method = text_of(p.settings, "method");
        if (method == automatic) {
            own = p.time_s;
            cell.chosen = p.note;
        } else if (cell.best.empty() || p.time_s < cell.best_time) {
            cell.best = method;
            cell.best_time = p.time_s;
        }
    }
    if (!own || cell.best.empty() || !(cell.best_time > 0.0)) return std::nullopt;
    cell.ratio = *own / cell.best_time;
    return cell;
}

template <class T, class F>
std::vector<T> distinct(std::span<const WinnerCell> cells, F of) {
    std::vector<T> values;
    for (const WinnerCell& cell : cells) {
        if (std::ranges::find(values, of(cell)) == values.end()) values.push_back(of(cell));
    }
    return values;
}

std::vector<std::string> conditions_of(std::span<const WinnerCell> cells) {
    return distinct<std::string>(cells, [](const WinnerCell& cell) { return cell.condition; });
}

std::vector<double> counts_of(std::span<const WinnerCell> cells) {
    std::vector<double> counts = distinct<double>(cells, [](const WinnerCell& cell) { return cell.count; });
    std::ranges::sort(counts);
    return counts;
}

std::string table_of(std::span<const WinnerCell> cells, const std::string& title) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    const ChooserScore score = score_of(cells);
    fmt::format_to(out,
                   "{}: the fastest method, its time for each box in an update, and, where it is another, what the chooser took;\n"
                   "the ratio is the chooser's time to the best one's\n",
                   title);
    fmt::format_to(out, "  {:<24} {:>8}  {:<18} {:>10} {:>7}  {}\n", "condition", "boxes", "fastest", "time [ns]", "ratio", "chosen");
    for (const WinnerCell& cell : cells) {
        fmt::format_to(out, "  {:<24} {:>8}  {:<18} {:>10.3g} {:>7.2f}  {}\n", cell.condition, cell.count, cell.best, 1e9 * cell.best_time,
                       cell.ratio, cell.chosen == cell.best ? "" : cell.chosen);
    }
    fmt::format_to(out, "  chooser over {} points: median ratio {:.3f}, worst {:.2f}\n", score.count, score.median, score.worst);
    return fmt::to_string(text);
}

}  // namespace

std::vector<WinnerCell> winner_cells(std::span<const StudyResult> results, const std::string& map) {
    std::vector<WinnerCell> cells;
    for (const StudyResult& result : results) {
        if (text_of(result.cases, "map") != map) continue;
        if (std::optional<WinnerCell> cell = cell_of(result)) cells.push_back(*std::move(cell));
    }
    return cells;
}

ChooserScore score_of(std::span<const WinnerCell> cells) {
    if (cells.empty()) return {};
    std::vector<double> ratios;
    for (const WinnerCell& cell : cells) ratios.push_back(cell.ratio);
    return {cells.size(), quartiles(ratios).median, *std::ranges::max_element(ratios)};
}

std::string map_script(std::span<const WinnerCell> cells, const std::string& title, const std::string& svg) {
    const std::vector<std::string> conditions = conditions_of(cells);
    const std::vector<double> counts = counts_of(cells);
    const auto place = [](const auto& values, const auto& value) { return std::ranges::find(values, value) - values.begin(); };
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "set terminal svg size 900,{} dynamic noenhanced background rgb 'white' font 'sans,12'\n",
                   160 + 26 * conditions.size());
    fmt::format_to(out, "set output {}\nset title {}\n", quoted_for_gnuplot(svg), quoted_for_gnuplot(title));
    fmt::format_to(out, "set xlabel 'boxes'\nset key outside bottom center horizontal\nset style fill solid 0.7\n");
    fmt::format_to(out, "set xrange [-0.5:{}.5]\nset yrange [{}.5:-0.5]\n", counts.size() - 1, conditions.size() - 1);
    for (std::size_t k = 0; k < counts.size(); ++k) fmt::format_to(out, "set xtics {}('{:g}' {})\n", k == 0 ? "" : "add ", counts[k], k);
    for (std::size_t k = 0; k < conditions.size(); ++k) {
        fmt::format_to(out, "set ytics {}({} {})\n", k == 0 ? "" : "add ", quoted_for_gnuplot(conditions[k]), k);
    }
    std::string plots;
    const auto block = [&](const std::string& name, auto wanted, const auto& line) {
        std::string data;
        for (const WinnerCell& cell : cells) {
            if (wanted(cell)) data += fmt::format("{} {} {}\n", place(counts, cell.count), place(conditions, cell.condition), line(cell));
        }
        // gnuplot refuses to plot a block without data.
        if (!data.empty()) fmt::format_to(out, "${} << END\n{}END\n", name, data);
        return !data.empty();
    };
    const auto nothing = [](const WinnerCell&) { return ""; };
    std::string dots;
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        const std::string name = to_string(method);
        const auto colour = static_cast<int>(method);
        if (block(
                "best_" + name, [&](const WinnerCell& cell) { return cell.best == name; }, nothing)) {
            plots +=
                fmt::format("$best_{} using 1:2:(0.48):(0.46) with boxxyerror lc {} title {}, ", name, colour, quoted_for_gnuplot(name));
        }
        if (block(
                "chosen_" + name, [&](const WinnerCell& cell) { return cell.chosen == name && cell.best != name; }, nothing)) {
            dots += fmt::format("$chosen_{} using ($1-0.38):2 with points pt 7 ps 1.4 lc {} notitle, ", name, colour);
        }
    }
    const auto label = [](const WinnerCell& cell) { return fmt::format("\"{:.3g} ns  x{:.2f}\"", 1e9 * cell.best_time, cell.ratio); };
    if (block(
            "times", [](const WinnerCell&) { return true; }, label))
        plots += dots + "$times using 1:2:3 with labels notitle, ";
    fmt::format_to(out, "plot {}1/0 notitle\n", plots);
    return fmt::to_string(text);
}

Digest broadphase_digest(std::span<const StudyResult> results) {
    Digest digest;
    for (const auto& [map, title] : {std::pair{kKnown, "points that the thresholds come from"}, std::pair{kHeldOut, "held-out points"}}) {
        const std::vector<WinnerCell> cells = winner_cells(results, map);
        if (cells.empty()) continue;
        digest.table += (digest.table.empty() ? "" : "\n") + table_of(cells, title);
        const std::string name = std::string("broadphase_map_") + map;
        digest.pictures.push_back({name, [cells, heading = std::string(title)](const std::string& svg) {
                                       return map_script(cells, "fastest method: " + heading, svg);
                                   }});
    }
    return digest;
}

}  // namespace carom::accuracy
