// The cases of the studies of broadphases against their own words, and what the studies add up to, on made-up results.
#include <carom/studies/accuracy/box_crowd.hpp>
#include <carom/studies/accuracy/winner_map.hpp>
#include <carom/studies/oracle/box_pairs.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace carom::accuracy {
namespace {

constexpr Spread kSpreads[] = {Spread::Even, Spread::Clustered, Spread::Planar,    Spread::Stacked,
                               Spread::Line, Spread::Diagonal,  Spread::Coincident};

TEST(BoxPairs, AreThoseThatShareAPoint) {
    const FloatAabb unit{vec3{0.0f}, vec3{1.0f}};
    const std::vector<FloatAabb> boxes{unit,
                                       {vec3{1.0f}, vec3{2.0f}},                               // shares a corner
                                       {vec3{1.0f, 0.0f, 1.5f}, vec3{2.0f, 1.0f, 2.0f}},       // apart along z alone
                                       {vec3{-1.0f, 0.5f, 0.5f}, vec3{-0.0f, 0.6f, 0.6f}},     // touches a face
                                       {vec3{0.5f}, vec3{0.5f}},                               // a point inside
                                       {vec3{0.0f, -3.0f, 0.0f}, vec3{1.0f, -1e-30f, 1.0f}}};  // apart by next to nothing
    EXPECT_EQ(oracle::pairs_of_row(boxes, 0), (std::vector<ProxyPair>{{0, 1}, {0, 3}, {0, 4}}));
    EXPECT_EQ(oracle::pairs_of_row(boxes, 1), (std::vector<ProxyPair>{{1, 2}}));
    EXPECT_TRUE(oracle::pairs_of_row(boxes, 5).empty());
}

TEST(BoxCrowd, IsBackAfterItsLastFrameAndMovesNoOthers) {
    for (const Spread spread : kSpreads) {
        SCOPED_TRACE(to_string(spread));
        BoxCrowd crowd({.spread = spread, .count = 500, .moving = 0.2, .seed = 4});
        const std::vector<FloatAabb> before(crowd.boxes().begin(), crowd.boxes().end());
        ASSERT_EQ(before.size(), 500u);
        const std::set<std::uint32_t> movers(crowd.movers().begin(), crowd.movers().end());
        EXPECT_NEAR(static_cast<double>(movers.size()), 100.0, 40.0);
        ASSERT_GE(crowd.frames(), 2);
        for (int frame = 0; frame + 1 < crowd.frames(); ++frame) {
            crowd.go_to(frame);
            for (std::uint32_t i = 0; i < 500; ++i) {
                ASSERT_EQ(crowd.boxes()[i] != before[i], movers.count(i) == 1);
                ASSERT_TRUE(crowd.boxes()[i].lower.x <= crowd.boxes()[i].upper.x);
            }
        }
        crowd.go_to(crowd.frames() - 1);
        EXPECT_TRUE(std::ranges::equal(crowd.boxes(), before));
    }
}

TEST(BoxCrowd, HasTheOverlapsAndSizesThatWereAskedFor) {
    const auto overlaps = [](const CrowdSettings& settings) {
        return 2.0 * static_cast<double>(BoxCrowd(settings).exact_pairs().size()) / static_cast<double>(settings.count);
    };
    for (const Spread spread : {Spread::Even, Spread::Clustered, Spread::Planar, Spread::Line}) {
        EXPECT_NEAR(overlaps({.spread = spread, .count = 4000}), 3.0, 1.2) << to_string(spread);
    }
    EXPECT_NEAR(overlaps({.count = 4000, .overlaps = 30.0}), 30.0, 6.0);
    EXPECT_NEAR(overlaps({.count = 4000, .size_ratio = 100.0}), 3.0, 1.5);
    EXPECT_EQ(overlaps({.spread = Spread::Coincident, .count = 50, .moving = 0.0}), 49.0);
    const BoxCrowd sizes({.count = 4000, .size_ratio = 1e4});
    double least = 1e9, most = 0.0;
    for (const FloatAabb& box : sizes.boxes()) {
        least = std::min(least, double(box.upper.y) - double(box.lower.y));
        most = std::max(most, double(box.upper.y) - double(box.lower.y));
    }
    EXPECT_GT(most / least, 1e4);
    EXPECT_LT(most / least, 4e4);
    EXPECT_EQ(BoxCrowd({.count = 30, .moving = 0.0}).movers().size(), 1u);
}

Point point(const std::string& method, double time, std::optional<double> error = 0.0, const std::string& note = "") {
    return {"carom", {{"method", method}}, time, 0.0, error, error ? 0u : 1u, note};
}

StudyResult result(const std::string& map, const std::string& condition, double count, std::vector<Point> points) {
    StudyResult r;
    r.cases = {{"map", map}, {"condition", condition}, {"count", count}};
    r.points = std::move(points);
    return r;
}

std::vector<StudyResult> example() {
    return {result(kHeldOut, "even_1", 100.0,
                   {point("brute_force", 2e-8), point("uniform_grid", 4e-8), point("automatic", 3e-8, 0.0, "uniform_grid")}),
            result(kHeldOut, "even_1", 1000.0, {point("uniform_grid", 4e-8), point("automatic", 4e-8, 0.0, "uniform_grid")}),
            result(kHeldOut, "line_1", 100.0, {point("sorted_axes", 5e-8), point("automatic", 5.5e-8, 0.0, "sorted_axes")}),
            result(kHeldOut, "line_1", 1000.0, {point("sorted_axes", 1e-9, std::nullopt), point("automatic", 1e-8)}),
            result(kKnown, "even_1", 100.0, {point("dynamic_tree", 1e-8), point("automatic", 3e-8, 0.0, "sweep_and_prune")}),
            result("", "", 0.0, {point("dynamic_tree", 1e-9)})};
}

TEST(WinnerMap, ComparesTheChoiceWithTheBestMethod) {
    const std::vector<StudyResult> results = example();
    const std::vector<WinnerCell> cells = winner_cells(results, kHeldOut);
    ASSERT_EQ(cells.size(), 3u) << "a study with a failure counts for nothing";
    EXPECT_EQ(cells[0].best, "brute_force");
    EXPECT_EQ(cells[0].chosen, "uniform_grid");
    EXPECT_DOUBLE_EQ(cells[0].ratio, 1.5);
    const ChooserScore score = score_of(cells);
    EXPECT_EQ(score.count, 3u);
    EXPECT_DOUBLE_EQ(score.median, 1.1);
    EXPECT_DOUBLE_EQ(score.worst, 1.5);
    EXPECT_EQ(score_of({}).count, 0u);
}

TEST(WinnerMap, TheDigestHasBothMaps) {
    const std::vector<StudyResult> results = example();
    const Digest digest = broadphase_digest(results);
    EXPECT_NE(digest.table.find("chooser over 3 points: median ratio 1.100, worst 1.50"), std::string::npos) << digest.table;
    EXPECT_NE(digest.table.find("chooser over 1 points: median ratio 3.000, worst 3.00"), std::string::npos) << digest.table;
    ASSERT_EQ(digest.pictures.size(), 2u);
    const std::string script = digest.pictures[1].script("it's.svg");
    EXPECT_NE(script.find("set output 'it''s.svg'"), std::string::npos) << script;
    EXPECT_NE(script.find("$best_brute_force << END\n0 0 \nEND\n"), std::string::npos) << script;
    EXPECT_NE(script.find("$chosen_uniform_grid << END\n0 0 \nEND\n"), std::string::npos) << "only where another is best:\n" << script;
    EXPECT_NE(script.find("$best_sorted_axes << END\n0 1 \nEND\n"), std::string::npos) << script;
    EXPECT_TRUE(broadphase_digest({}).pictures.empty());
}

TEST(BroadphaseStudies, MissNoPairAndHaveMapsAndNamesOfTheirOwn) {
    const std::vector<Study> studies = broadphase_studies({.quick = true});
    std::set<std::string> names;
    std::vector<StudyResult> results;
    for (const Study& study : studies) {
        EXPECT_TRUE(names.insert(study.name).second) << study.name;
        EXPECT_EQ(study.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos) << study.name;
        results.push_back(measure(study, {.repeats = 1}));
        for (const Point& p : results.back().points) {
            EXPECT_EQ(p.failures, 0u) << study.name << ", " << to_string(p.settings);
            double margin = 0.0;
            for (const auto& [key, value] : p.settings) {
                if (key == "margin") margin = std::get<double>(value);
            }
            ASSERT_TRUE(p.error.has_value());
            EXPECT_EQ(*p.error == 0.0, margin == 0.0) << study.name << ", " << to_string(p.settings);
        }
    }
    EXPECT_EQ(results[0].name, "broadphase");
    EXPECT_FALSE(winner_cells(results, kKnown).empty());
    EXPECT_FALSE(winner_cells(results, kHeldOut).empty());
}

}  // namespace
}  // namespace carom::accuracy
