#include <carom/studies/accuracy/plot.hpp>

#include <carom/core/output_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <iterator>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace carom::accuracy {
namespace {

constexpr const char* kProgram = "gnuplot";
constexpr int kNotFound = 127, kBroken = 126;

// The lower and the upper edge: powers of ten outside all positive errors.
struct Edges {
    double lower = 1e-17, upper = 1.0;

    explicit Edges(const StudyResult& result) {
        double least = 1.0, most = 0.0;
        for (const Point& p : result.points) {
            if (!p.error || !(*p.error > 0.0)) continue;
            least = std::min(least, *p.error);
            most = std::max(most, *p.error);
        }
        if (most > 0.0) {
            lower = std::pow(10.0, std::floor(std::log10(least)) - 1.0);
            upper = std::pow(10.0, std::ceil(std::log10(most)) + 1.0);
        }
    }
    [[nodiscard]] double place(const Point& p) const { return p.error ? std::max(*p.error, lower) : upper; }
};

std::vector<std::string> names_of(const StudyResult& result) {
    std::vector<std::string> names;
    for (const Point& p : result.points) {
        if (std::ranges::find(names, p.who) == names.end()) names.push_back(p.who);
    }
    return names;
}

// Runs gnuplot on the script and waits. @return its exit code; kNotFound: there is no such program; kBroken: it did not exit.
int run_gnuplot(const std::string& script) {
    std::string program = kProgram, path = script;
    const std::array<char*, 3> argv{program.data(), path.data(), nullptr};
    pid_t child = 0;
    if (posix_spawnp(&child, kProgram, nullptr, nullptr, argv.data(), environ) != 0) return kNotFound;
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) return kBroken;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : kBroken;
}

}  // namespace

// In single quotes gnuplot takes everything as it is, a quote is written twice, and a line ends the string.
std::string quoted_for_gnuplot(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    std::string out = "'";
    for (const char c : text) {
        out += c == '\'' ? "''" : std::string(1, c);
    }
    return out + "'";
}

std::string plot_script(const StudyResult& result, const std::string& svg) {
    const Edges edges(result);
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "set terminal svg size 900,600 dynamic noenhanced background rgb 'white' font 'sans,13'\n");
    fmt::format_to(out, "set output {}\nset title {}\n", quoted_for_gnuplot(svg), quoted_for_gnuplot(result.name));
    fmt::format_to(out, "set xlabel {}\nset ylabel {}\n", quoted_for_gnuplot(fmt::format("time of {} [s]", result.time)), quoted_for_gnuplot(fmt::format("error [{}]", result.unit)));
    fmt::format_to(out, "set logscale xy\nset format xy '%.0e'\nset grid\nset key outside bottom center horizontal\n");
    fmt::format_to(out, "set yrange [{:g}:{:g}]\nset offsets graph 0.05, graph 0.05, graph 0, graph 0\n", edges.lower, edges.upper);
    fmt::format_to(out, "set label {} at graph 0.01, 0.02\n", quoted_for_gnuplot("on this edge: error 0"));
    fmt::format_to(out, "set label {} at graph 0.01, 0.98\n", quoted_for_gnuplot("on this edge: failed"));

    const std::vector<std::string> names = names_of(result);
    std::string plots;
    for (std::size_t k = 0; k < names.size(); ++k) {
        fmt::format_to(out, "$who{} << END\n", k);
        for (const Point& p : result.points) {
            if (p.who == names[k]) fmt::format_to(out, "{} {}\n", p.time_s, edges.place(p));
        }
        fmt::format_to(out, "END\n");
        plots += fmt::format("$who{} using 1:2 with points pt 7 ps 0.9 lc {} title {}, ", k, k + 1, quoted_for_gnuplot(names[k]));
    }
    fmt::format_to(out, "$front << END\n");
    for (const std::size_t i : result.front) {
        fmt::format_to(out, "{} {}\n", result.points[i].time_s, edges.place(result.points[i]));
    }
    fmt::format_to(out, "END\n");
    // gnuplot refuses to plot a block without data.
    if (!result.front.empty()) plots += "$front using 1:2 with steps lw 1.5 lc rgb 'gray40' title 'Pareto front', ";
    fmt::format_to(out, "plot {}1/0 notitle\n", plots);
    return fmt::to_string(text);
}

Result<Drawn> run_script(const std::string& script, const std::string& stem) {
    const std::string file = stem + ".gp";
    if (Status written = write_text(file, script); !written) return written.error();
    const int code = run_gnuplot(file);
    if (code == kNotFound) return Drawn::NoGnuplot;
    if (code != 0) return Error{ErrorCode::Io, fmt::format("{} ended with code {}", kProgram, code), file};
    return Drawn::Yes;
}

Result<Drawn> draw_svg(const StudyResult& result, const std::string& stem) {
    return run_script(plot_script(result, stem + ".svg"), stem);
}

}  // namespace carom::accuracy
