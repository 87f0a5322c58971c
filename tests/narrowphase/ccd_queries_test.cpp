// Deforming triangles on the public queries of Wang, Ferguson, Schneider, Jiang, Attene and Panozzo, "A Large-Scale Benchmark and an
// Inclusion-Based Algorithm for Continuous Collision Detection" (ACM TOG 2021), where they are to be had: CAROM_CCD_QUERIES names the
// folder that holds <scene>/edge-edge/*.csv and <scene>/vertex-face/*.csv. A row of a file is a corner, as three exact rationals, and the
// verdict; eight rows are a query.
#include <carom/narrowphase/deforming_triangles.hpp>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace carom {
namespace {

using Rational = boost::multiprecision::cpp_rational;

/// Four corners at t = 0, then at t = 1, and whether they meet.
struct Query {
    std::array<dvec3, 8> corner;
    bool meet = false;
};

/// @return the queries of a file. Every coordinate there is a double, which is checked.
std::vector<Query> read_queries(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<Query> queries;
    std::string line;
    for (std::size_t row = 0; std::getline(file, line); ++row) {
        if (row % 8 == 0) queries.emplace_back();
        Query& query = queries.back();
        std::stringstream fields(line);
        std::string numerator, denominator, verdict;
        for (int k = 0; k < 3; ++k) {
            std::getline(fields, numerator, ',');
            std::getline(fields, denominator, ',');
            const Rational exact(numerator + "/" + denominator);
            query.corner[row % 8][k] = exact.convert_to<double>();
            EXPECT_TRUE(Rational(query.corner[row % 8][k]) == exact) << path << " row " << row;
        }
        std::getline(fields, verdict, ',');
        query.meet = verdict[0] == '1';
    }
    return queries;
}

Impact answer(const Query& q, bool edges, const DeformingSettings& settings) {
    const auto corner = [&](std::size_t i) { return MovingPoint{q.corner[i], q.corner[i + 4]}; };
    if (edges) return time_of_impact(EdgeEdgeMotion{{corner(0), corner(1)}, {corner(2), corner(3)}}, settings);
    return time_of_impact(VertexFaceMotion{corner(0), {corner(1), corner(2), corner(3)}}, settings);
}

TEST(CcdQueries, NoneIsMissedAndFewAreMadeUp) {
    const char* const folder = std::getenv("CAROM_CCD_QUERIES");
    if (folder == nullptr || !std::filesystem::is_directory(folder)) GTEST_SKIP() << "CAROM_CCD_QUERIES names no folder of queries";
    int meet = 0, apart = 0, missed = 0, made_up = 0, made_up_at_tolerance = 0, missed_at_tolerance = 0, clamped = 0, most_checks = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".csv") continue;
        const bool edges = entry.path().parent_path().filename() == "edge-edge";
        for (const Query& query : read_queries(entry.path())) {
            const Impact fine = answer(query, edges, {}), coarse = answer(query, edges, {.tolerance = 1e-6});
            clamped += fine.status == ImpactStatus::Clamped ? 1 : 0;
            most_checks = std::max(most_checks, fine.checks);
            ++(query.meet ? meet : apart);
            if (query.meet) {
                missed += may_touch(fine.status) ? 0 : 1;
                missed_at_tolerance += may_touch(coarse.status) ? 0 : 1;
            } else {
                made_up += may_touch(fine.status) ? 1 : 0;
                made_up_at_tolerance += may_touch(coarse.status) ? 1 : 0;
            }
        }
    }
    EXPECT_EQ(missed, 0);
    EXPECT_EQ(missed_at_tolerance, 0);
    EXPECT_EQ(clamped, 0) << "of most " << most_checks;
    EXPECT_EQ(made_up, 0) << "of " << apart;
    EXPECT_LT(made_up_at_tolerance, apart / 100);
    EXPECT_GT(meet + apart, 0);
    RecordProperty("meet", meet);
    RecordProperty("apart", apart);
    RecordProperty("made_up_at_tolerance", made_up_at_tolerance);
}

}  // namespace
}  // namespace carom
