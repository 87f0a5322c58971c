// The studies "ccd": vertices against faces and edges against edges in motion, made up and missed, against tolerance and cap.
//
// The queries of Wang, Ferguson, Schneider, Jiang, Attene and Panozzo (ACM TOG 2021) are used where CAROM_CCD_QUERIES names the folder that
// holds <scene>/edge-edge/*.csv and <scene>/vertex-face/*.csv; queries of our own, whose answers are known by how they are made, always.
#include <carom/studies/accuracy/catalogue.hpp>

#include <carom/core/random.hpp>
#include <carom/narrowphase/deforming_triangles.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

namespace carom::accuracy {
namespace {

/// Queries of one kind; the other list is empty.
struct CcdCases {
    std::string name;
    std::vector<VertexFaceMotion> faces;
    std::vector<EdgeEdgeMotion> edges;
    std::vector<bool> meet;
    std::vector<Impact> finest;  ///< without a tolerance

    [[nodiscard]] std::size_t apart() const { return static_cast<std::size_t>(std::count(meet.begin(), meet.end(), false)); }
};
using CcdCasesPtr = std::shared_ptr<const CcdCases>;

void solve(const CcdCases& cases, const DeformingSettings& settings, std::vector<Impact>& out) {
    out.resize(cases.meet.size());
    if (cases.faces.empty()) {
        times_of_impact(cases.edges, out, settings);
    } else {
        times_of_impact(cases.faces, out, settings);
    }
}

void add(CcdCases& cases, bool edges, const std::array<MovingPoint, 4>& p, bool meet) {
    if (edges) {
        cases.edges.push_back({{p[0], p[1]}, {p[2], p[3]}});
    } else {
        cases.faces.push_back({p[0], {p[1], p[2], p[3]}});
    }
    cases.meet.push_back(meet);
}

/// A number of the form n / d, n and d integers of any length, d a power of two and the quotient a double: both round to the same double.
double read_rational(const char*& at) {
    char* end = nullptr;
    const double numerator = std::strtod(at, &end);
    const double denominator = std::strtod(end + 1, &end);
    at = end + 1;
    return numerator / denominator;
}

void read_file(const std::filesystem::path& path, bool edges, CcdCases& cases) {
    std::ifstream file(path);
    std::array<MovingPoint, 4> p;
    std::string line;
    for (std::size_t row = 0; std::getline(file, line); ++row) {
        const char* at = line.c_str();
        dvec3& corner = row % 8 < 4 ? p[row % 4].start : p[row % 4].end;
        for (int k = 0; k < 3; ++k) corner[k] = read_rational(at);
        if (row % 8 == 7) add(cases, edges, p, *at == '1');
    }
}

/// Faces and edges that pass each other with one velocity, so that they are in one plane once, at a known point of both or at a known gap
/// beside the face.
CcdCases make_cases(bool edges, std::size_t count) {
    CcdCases cases{.name = edges ? "own_edges" : "own_faces", .faces = {}, .edges = {}, .meet = {}, .finest = {}};
    Random random(edges ? 0xcd1 : 0xcd0);
    const auto grid = [&] { return std::floor(random.range(-1024.0, 1024.0)) / 1024.0; };
    const auto point = [&] { return dvec3{grid(), grid(), grid()}; };
    for (std::size_t i = 0; i < count; ++i) {
        const bool meet = i % 4 == 0;
        const dvec3 a = point(), u = point(), v = point(), speed = 2.0 * point(), drift = point();
        const double t = std::floor(random.range(1.0, 16.0)) / 16.0;
        // Where in the face, or on the edges, in sixteenths; beside it where they do not meet.
        const double inside = std::floor(random.range(0.0, 9.0)) / 16.0, beside = -std::pow(2.0, -std::floor(random.range(1.0, 40.0)));
        const double s = meet ? inside : beside, r = std::floor(random.range(0.0, 8.0)) / 16.0;
        const dvec3 at = edges ? a + s * u : a + s * u + r * v;
        const auto moving = [&](const dvec3& p, const dvec3& velocity) { return MovingPoint{p - t * velocity, p + (1.0 - t) * velocity}; };
        if (edges) {
            add(cases, true, {moving(a, drift), moving(a + u, drift), moving(at - r * v, speed + drift), moving(at + (1.0 - r) * v, speed + drift)},
                meet);
        } else {
            add(cases, false, {moving(at, speed + drift), moving(a, drift), moving(a + u, drift), moving(a + v, drift)}, meet);
        }
    }
    return cases;
}

std::vector<CcdCasesPtr> all_cases(bool quick) {
    std::vector<CcdCases> all{make_cases(false, quick ? 200 : 4000), make_cases(true, quick ? 200 : 4000)};
    const char* const folder = std::getenv("CAROM_CCD_QUERIES");
    if (folder != nullptr && std::filesystem::is_directory(folder)) {
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
            if (entry.path().extension() == ".csv") files.push_back(entry.path());
        }
        std::stable_sort(files.begin(), files.end());
        for (const auto& path : files) {
            const std::string kind = path.parent_path().filename().string();
            std::string name = path.parent_path().parent_path().filename().string() + "_" + kind;
            std::replace(name.begin(), name.end(), '-', '_');
            if (all.back().name != name) all.push_back({.name = name, .faces = {}, .edges = {}, .meet = {}, .finest = {}});
            read_file(path, kind == "edge-edge", all.back());
        }
    }
    std::vector<CcdCasesPtr> out;
    for (CcdCases& cases : all) {
        solve(cases, {.most_checks = 1 << 16}, cases.finest);
        out.push_back(std::make_shared<const CcdCases>(std::move(cases)));
    }
    return out;
}

/// @param early  measure how early times are rather than what is made up.
Sample run(const std::vector<CcdCasesPtr>& all, const DeformingSettings& settings, bool early) {
    Sample sample;
    std::size_t queries = 0, apart = 0, made_up = 0, both = 0, clamped = 0;
    double ahead = 0.0;
    std::vector<Impact> out;
    for (const CcdCasesPtr& cases : all) {
        out.resize(cases->meet.size());
        const ThreadStopwatch watch;
        solve(*cases, settings, out);
        sample.time_s += watch.seconds();
        queries += out.size();
        apart += cases->apart();
        for (std::size_t i = 0; i < out.size(); ++i) {
            const bool found = may_touch(out[i].status);
            sample.failures += cases->meet[i] && !found ? 1 : 0;
            made_up += !cases->meet[i] && found ? 1 : 0;
            clamped += out[i].status == ImpactStatus::Clamped ? 1 : 0;
            if (!cases->meet[i] || !found) continue;
            ++both;
            ahead += cases->finest[i].t - out[i].t;
        }
    }
    sample.time_s /= static_cast<double>(queries);
    sample.error = early ? (both == 0 ? 0.0 : ahead / static_cast<double>(both))
                         : (apart == 0 ? 0.0 : static_cast<double>(made_up) / static_cast<double>(apart));
    sample.note = fmt::format("{} made up, {} clamped", made_up, clamped);
    return sample;
}

Study study_of(const std::string& name, const std::vector<CcdCasesPtr>& cases, bool early) {
    std::size_t queries = 0, apart = 0;
    for (const CcdCasesPtr& c : cases) queries += c->meet.size(), apart += c->apart();
    Study study{.name = name,
                .stage = "sweeps and continuous collision",
                .error = early ? "how much earlier than without a tolerance contact is reported, mean over the contacts, of the motion"
                               : "contacts made up, of the queries without one; a failure is a contact missed",
                .unit = "1",
                .oracle = fmt::format("exact verdicts; {} queries, {} of them without a contact", queries, apart),
                .time = "one query, of the processor"};
    const auto candidate = [&](double tolerance, int cap) {
        study.candidates.push_back({"carom", {{"tolerance", tolerance}, {"checks", static_cast<double>(cap)}}, [=] {
                                        return run(cases, {.tolerance = tolerance, .most_checks = cap}, early);
                                    }});
    };
    for (const double tolerance : {0.0, 1e-9, 1e-6, 1e-4, 1e-2}) candidate(tolerance, 512);
    for (const int cap : {64, 16, 4}) candidate(0.0, cap);
    return study;
}

}  // namespace

std::vector<Study> ccd_studies(const StudyOptions& options) {
    const std::vector<CcdCasesPtr> cases = all_cases(options.quick);
    std::vector<Study> studies{study_of("ccd", cases, false), study_of("ccd_early", cases, true)};
    for (const CcdCasesPtr& c : cases) studies.push_back(study_of("ccd_" + c->name, {c}, false));
    return studies;
}

}  // namespace carom::accuracy
