// The framework of studies: turns, medians, failures, the Pareto front, and the forms of a report.
#include <carom/core/check.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/accuracy/plot.hpp>
#include <carom/studies/accuracy/report.hpp>
#include <carom/studies/accuracy/study.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

namespace carom::accuracy {
namespace {

using Json = nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Point point(double time, std::optional<double> error, const std::string& who = "carom") {
    return {who, {}, time, 0.0, error, error ? 0u : 1u};
}

// A candidate that gives these samples in turn, the first of which is the warm-up.
Candidate scripted(std::string who, std::vector<Sample> samples) {
    return {std::move(who), {{"knob", 1.0}}, [samples, next = std::size_t{0}]() mutable { return samples.at(next++); }};
}

TEST(Quartiles, InterpolateBetweenOrderStatistics) {
    const Quartiles four = quartiles({4.0, 1.0, 3.0, 2.0});
    EXPECT_DOUBLE_EQ(four.lower, 1.75);
    EXPECT_DOUBLE_EQ(four.median, 2.5);
    EXPECT_DOUBLE_EQ(four.upper, 3.25);
    const Quartiles seven = quartiles({70, 10, 30, 20, 50, 60, 40});
    EXPECT_DOUBLE_EQ(seven.lower, 25.0);
    EXPECT_DOUBLE_EQ(seven.median, 40.0);
    EXPECT_DOUBLE_EQ(seven.upper, 55.0);
    const Quartiles one = quartiles({5.0});
    EXPECT_EQ(one.lower, 5.0);
    EXPECT_EQ(one.median, 5.0);
    EXPECT_EQ(one.upper, 5.0);
    EXPECT_THROW(static_cast<void>(quartiles({})), MisuseError);
    EXPECT_THROW(static_cast<void>(quartiles({1.0, kNan})), MisuseError);
}

TEST(ParetoFront, HasWhatNothingBeatsInOrderOfTime) {
    const std::vector<Point> points{point(3, 1e-4), point(1, 1e-1), point(2, 1e-1), point(4, 1e-3), point(2, 1e-2), point(9, std::nullopt)};
    EXPECT_EQ(pareto_front(points), (std::vector<std::size_t>{1, 4, 0}));
    EXPECT_TRUE(pareto_front({}).empty());
    EXPECT_TRUE(pareto_front({point(1, std::nullopt)}).empty());
}

TEST(ParetoFront, KeepsEqualPointsAndZeroErrors) {
    const std::vector<Point> points{point(2, 0.0), point(1, 1e-3), point(1, 1e-3), point(2, 0.0), point(3, 0.0)};
    EXPECT_EQ(pareto_front(points), (std::vector<std::size_t>{1, 2, 0, 3}));
}

TEST(ParetoFront, IsTheSetThatTheDefinitionGives) {
    Random random(801);
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<Point> points;
        for (int i = 0; i < 20; ++i) {
            const double time = std::floor(random.range(1, 8)), error = std::floor(random.range(0, 8));
            points.push_back(point(time, random.unit() < 0.1 ? std::nullopt : std::optional(error)));
        }
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Point& p = points[i];
            const bool beaten = std::ranges::any_of(points, [&](const Point& q) {
                return p.error && q.error && q.time_s <= p.time_s && *q.error <= *p.error && (q.time_s < p.time_s || *q.error < *p.error);
            });
            if (p.error && !beaten) expected.push_back(i);
        }
        std::vector<std::size_t> front = pareto_front(points);
        EXPECT_TRUE(std::ranges::is_sorted(front, {}, [&](std::size_t i) { return points[i].time_s; }));
        std::ranges::sort(front);
        EXPECT_EQ(front, expected) << "trial " << trial;
    }
}

TEST(TimeToReach, IsTheLeastTimeOfAnyPointGoodEnough) {
    const std::vector<Point> points{point(5, 1e-5), point(2, 1e-3), point(7, 1e-4), point(1, 1e-4, "peer"), point(0.1, std::nullopt)};
    EXPECT_EQ(time_to_reach(points, "carom", 1e-2), 2.0);
    EXPECT_EQ(time_to_reach(points, "carom", 1e-3), 2.0) << "an error of exactly that is good enough";
    EXPECT_EQ(time_to_reach(points, "carom", 1e-4), 5.0) << "no interpolation, and not the first in the list";
    EXPECT_EQ(time_to_reach(points, "carom", 1e-6), std::nullopt);
    EXPECT_EQ(time_to_reach(points, "peer", 1e-2), 1.0);
    EXPECT_EQ(time_to_reach(points, "nobody", 1.0), std::nullopt);
}

TEST(Measure, TakesTurnsAndStartsEachRoundWithAnother) {
    std::string order;
    Study study{.name = "turns"};
    for (const char* who : {"a", "b", "c"}) {
        study.candidates.push_back({who, {}, [&order, who] {
                                        order += who;
                                        return Sample{1.0, 0.0, 0};
                                    }});
    }
    std::vector<int> rounds;
    const StudyResult result = measure(study, {.repeats = 3, .progress = [&](int done, int all) {
                                                   EXPECT_EQ(all, 4);
                                                   rounds.push_back(done);
                                               }});
    EXPECT_EQ(order, "abcbcacababc");
    EXPECT_EQ(rounds, (std::vector<int>{1, 2, 3, 4}));
    ASSERT_EQ(result.points.size(), 3u);
    EXPECT_EQ(result.points[1].who, "b");
}

TEST(Measure, IsTheMedianWithoutTheWarmUp) {
    Study study{.name = "median"};
    study.candidates.push_back(scripted("carom", {{1000, 1e-3, 0}, {5, 1e-3, 0}, {1, 1e-3, 0}, {2, 5e-3, 0}, {9, 1e-3, 0}, {3, 1e-3, 0}}));
    const StudyResult result = measure(study, {.repeats = 5});
    EXPECT_DOUBLE_EQ(result.points[0].time_s, 3.0);
    EXPECT_DOUBLE_EQ(result.points[0].time_iqr_s, 3.0);
    EXPECT_EQ(result.points[0].error, 5e-3) << "the largest over the repeats";
    EXPECT_EQ(result.front, (std::vector<std::size_t>{0}));
    EXPECT_EQ(result.time_to[0], 3.0);
    EXPECT_EQ(result.time_to[1], std::nullopt);
}

TEST(Measure, FailuresStayInTheListWithoutAnError) {
    const std::vector<Sample> bad{{1, std::nullopt, 0}, {1, kNan, 0}, {1, kInfinity, 0}, {1, -1e-3, 0}, {1, 1e-3, 4}};
    for (const Sample& sample : bad) {
        Study study{.name = "failures"};
        study.candidates.push_back(scripted("carom", {{1, 0.0, 0}, {1, 0.0, 0}, sample, {1, 0.0, 0}}));
        study.candidates.push_back(scripted("carom", {{9, 0.0, 0}, {9, 0.0, 0}, {9, 0.0, 0}, {9, 0.0, 0}}));
        const StudyResult result = measure(study, {.repeats = 3});
        ASSERT_EQ(result.points.size(), 2u);
        EXPECT_EQ(result.points[0].error, std::nullopt);
        EXPECT_EQ(result.points[0].failures, std::max<std::size_t>(1, sample.failures));
        EXPECT_EQ(result.points[0].time_s, 1.0);
        EXPECT_EQ(result.front, (std::vector<std::size_t>{1}));
        EXPECT_EQ(result.time_to[0], 9.0);
    }
}

TEST(Measure, RefusesMisuse) {
    Study study{.name = "misuse"};
    EXPECT_THROW(static_cast<void>(measure(study)), MisuseError) << "no candidate";
    study.candidates.push_back({"carom", {}, {}});
    EXPECT_THROW(static_cast<void>(measure(study)), MisuseError) << "no function";
    study.candidates[0].run = [] { return Sample{1.0, 0.0, 0}; };
    EXPECT_THROW(static_cast<void>(measure(study, {.repeats = 0})), MisuseError);
    study.candidates[0].run = [] { return Sample{kNan, 0.0, 0}; };
    EXPECT_THROW(static_cast<void>(measure(study)), MisuseError);
    study.candidates[0].run = [] { return Sample{-1.0, 0.0, 0}; };
    EXPECT_THROW(static_cast<void>(measure(study)), MisuseError);
}

StudyResult example() {
    StudyResult result{"demo", "a stage", "how wrong, \"in words\"", "m", "an oracle", "a pass", {{"count", 3.0}}, {}, {}, {}};
    result.points.push_back({"carom", {{"precision", std::string("double")}, {"width", 8.0}}, 0.25, 0.5, 1e-3, 0});
    result.points.push_back({"peer", {{"mode", std::string("a,b \"c\"")}}, 0.125, 0.0625, std::nullopt, 3, "tired, \"so\""});
    result.points.push_back({"carom", {}, 0.5, 0.0, 0.0, 0});
    result.front = pareto_front(result.points);
    for (std::size_t i = 0; i < kReach.size(); ++i) {
        result.time_to[i] = time_to_reach(result.points, "carom", kReach[i]);
    }
    return result;
}

TEST(Report, JsonHasExactlyItsKeys) {
    const Json json = Json::parse(to_json(std::vector{example()}));
    EXPECT_EQ(json, Json::parse(R"({"studies": [{
        "name": "demo", "stage": "a stage", "error": "how wrong, \"in words\"", "unit": "m", "oracle": "an oracle",
        "time": "a pass", "cases": {"count": 3.0},
        "points": [
            {"who": "carom", "settings": {"precision": "double", "width": 8.0}, "time_s": 0.25, "time_iqr_s": 0.5, "error": 1e-3, "failures": 0, "note": ""},
            {"who": "peer", "settings": {"mode": "a,b \"c\""}, "time_s": 0.125, "time_iqr_s": 0.0625, "error": null, "failures": 3, "note": "tired, \"so\""},
            {"who": "carom", "settings": {}, "time_s": 0.5, "time_iqr_s": 0.0, "error": 0.0, "failures": 0, "note": ""}],
        "front": [0, 2],
        "time_to": {"1e-2": 0.25, "1e-3": 0.25, "1e-4": 0.5}}]})"));
    StudyResult nothing = example();
    nothing.time_to = {};
    const Json empty = Json::parse(to_json(std::vector{nothing}));
    EXPECT_TRUE(empty.at("studies").at(0).at("time_to").at("1e-4").is_null());
    EXPECT_EQ(Json::parse(to_json({})), Json::parse(R"({"studies": []})"));
}

TEST(Report, CsvIsQuotedWhereItMustBe) {
    EXPECT_EQ(to_csv(example()),
              "who,settings,time_s,time_iqr_s,error,failures,front,note\n"
              "carom,precision=double width=8,0.25,0.5,0.001,0,1,\n"
              "peer,\"mode=a,b \"\"c\"\"\",0.125,0.0625,,3,0,\"tired, \"\"so\"\"\"\n"
              "carom,,0.5,0,0,0,1,\n");
}

TEST(Report, TheTableMarksTheFrontAndKeepsFailures) {
    const std::string table = to_table(example());
    EXPECT_NE(table.find("* carom    precision=double width=8"), std::string::npos) << table;
    EXPECT_NE(table.find("  peer "), std::string::npos) << table;
    EXPECT_NE(table.find("failed"), std::string::npos) << table;
    EXPECT_NE(table.find("3  tired, \"so\"\n"), std::string::npos) << "the note stands last:\n" << table;
    EXPECT_NE(table.find("time for carom to reach 1e-2: 250 ms, 1e-3: 250 ms, 1e-4: 500 ms"), std::string::npos) << table;
    EXPECT_NE(table.find("time for peer to reach 1e-2: -, 1e-3: -, 1e-4: -"), std::string::npos) << table;
}

TEST(Plot, TheScriptHasEveryPointAndNoStrayQuote) {
    StudyResult result = example();
    result.name = "it's";
    const std::string script = plot_script(result, "a'b.svg");
    EXPECT_NE(script.find("set output 'a''b.svg'"), std::string::npos) << script;
    EXPECT_NE(script.find("set title 'it''s'"), std::string::npos);
    EXPECT_NE(script.find("$who0 << END\n0.25 0.001\n0.5 0.0001\nEND\n"), std::string::npos) << "zero stands on the edge:\n" << script;
    EXPECT_NE(script.find("$who1 << END\n0.125 0.01\nEND\n"), std::string::npos) << "a failure stands on the upper edge:\n" << script;
    EXPECT_NE(script.find("$front << END\n0.25 0.001\n0.5 0.0001\nEND\n"), std::string::npos) << script;
}

}  // namespace
}  // namespace carom::accuracy
