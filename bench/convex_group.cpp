#include <carom/bench/convex_group.hpp>

#include <carom/bench/fcl_convex.hpp>
#include <carom/bench/fcl_mesh.hpp>
#include <carom/bench/race.hpp>
#include <carom/bench/random_shapes.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/overlap.hpp>
#include <carom/studies/oracle/polytope.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace carom::bench {
namespace {

constexpr std::size_t kShapes = 200, kPairs = 20000, kTurn = 1000, kJudged = 4000;
constexpr double kTouching = 1e-9;  // gaps and depths that no verdict is wrong about [m]

// The pairs, as both contenders take them: pair i is of the places 2 i and 2 i + 1, which Carom counts from the first of its turn.
struct Crowd {
    std::vector<Shape> shapes;
    std::vector<FclConvex> fcl_shapes;
    std::vector<std::size_t> shape_of;  // by place
    std::vector<const Shape*> placed;
    std::vector<Pose> poses;
    std::vector<FclPlace> fcl_places;
    std::vector<NumberedPair> pairs;

    Crowd(std::uint64_t seed, Shape (*make)(Random&)) {
        Random random(seed);
        for (std::size_t i = 0; i < kShapes; ++i) shapes.push_back(make(random));
        for (const Shape& shape : shapes) fcl_shapes.emplace_back(shape);
        for (std::size_t i = 0; i < kPairs; ++i) {
            const dvec3 way = direction_of(random);
            const double apart = random.range(0.5, 2.4);
            for (const double part : {-0.5, 0.5}) {
                shape_of.push_back(static_cast<std::size_t>(random.range(0.0, double(kShapes))));
                placed.push_back(&shapes[shape_of.back()]);
                poses.push_back({(part * apart) * way, rotation_of(random)});
                fcl_places.emplace_back(poses.back());
            }
            if (i < kTurn) pairs.push_back({static_cast<std::uint32_t>(2 * i), static_cast<std::uint32_t>(2 * i + 1), 0.0f});
        }
    }
    [[nodiscard]] PlacedShapes places(std::size_t first) const {
        return {std::span(placed).subspan(2 * first, 2 * kTurn), std::span(poses).subspan(2 * first, 2 * kTurn)};
    }

    // Calls ask(number, pair) for each pair of the turn from `first`.
    template <class Ask>
    void one_by_one(std::size_t first, const Ask& ask) const {
        for (std::size_t i = first; i < first + kTurn; ++i) {
            ask(i, ShapePair{placed[2 * i], placed[2 * i + 1], poses[2 * i], poses[2 * i + 1], 0.0f});
        }
    }
    // Calls fcl(a, b, place a, place b) for each pair of the turn from `first`.
    template <class Ask>
    void by_fcl(std::size_t first, const Ask& ask) const {
        for (std::size_t i = first; i < first + kTurn; ++i) {
            ask(i, fcl_shapes[shape_of[2 * i]], fcl_shapes[shape_of[2 * i + 1]], fcl_places[2 * i], fcl_places[2 * i + 1]);
        }
    }
};

// Whether Carom is asked about the pairs of a turn at once, or about one after the other.
enum class Ask { Many, One };

// Of a pair [ns].
std::pair<double, double> race_two(const Turn& carom, const Turn& peer) {
    const std::vector<double> medians = race(std::array{carom, peer}, {.items = kPairs, .turn = kTurn});
    return {medians[0], medians[1]};
}

// What a contender got wrong.
struct Faults {
    std::size_t wrong = 0;
    double largest = 0.0;
    std::size_t silent = 0;  // no answer
    void judge(std::optional<double> error, double allowed) {
        if (!error) {
            ++silent;
            return;
        }
        largest = std::max(largest, *error);
        wrong += *error > allowed ? 1 : 0;
    }
    [[nodiscard]] Quality quality(const char* what) const {
        return {{what, double(wrong)}, {"largest_error", largest}, {"no_answer", double(silent)}};
    }
};

class Rows {
public:
    explicit Rows(const GroupRequest& request) : request_(request) {}
    [[nodiscard]] bool wants(const std::string& bench) const { return (bench + "/fcl").find(request_.filter) != std::string::npos; }
    void add(const std::string& bench, std::pair<double, double> times, const Faults& carom, const Faults& peer, const char* what) {
        Row row;
        row.bench = bench;
        row.peer = "fcl";
        row.peer_version = FclMesh::version();
        row.carom_ms = 1e-6 * times.first;
        row.peer_ms = 1e-6 * times.second;
        row.carom_quality = carom.quality(what);
        row.peer_quality = peer.quality(what);
        fmt::print(request_.table,
                   "{:<20} carom {:>8.1f} ns   fcl {:>8.1f} ns   {:>7.2f}x   {} {} and {}, largest error {:.2g} and {:.2g}\n", bench,
                   times.first, times.second, speedup(row), what, carom.wrong, peer.wrong, carom.largest, peer.largest);
        std::fflush(request_.table);
        rows.push_back(std::move(row));
    }
    std::vector<Row> rows;

private:
    const GroupRequest& request_;
};

double true_depth(const Crowd& crowd, std::size_t i) {
    const Shape &a = *crowd.placed[2 * i], &b = *crowd.placed[2 * i + 1];
    const Pose &pose_a = crowd.poses[2 * i], &pose_b = crowd.poses[2 * i + 1];
    if (const Box* box = std::get_if<Box>(&a)) return oracle::overlap_depth(*box, pose_a, std::get<Box>(b), pose_b);
    return oracle::overlap_depth(*oracle::make_polytope(a, pose_a), *oracle::make_polytope(b, pose_b));
}

void boolean_row(const Crowd& crowd, const std::string& bench, Ask how, Rows& rows) {
    SerialExecutor executor;
    std::vector<Overlap> verdicts;
    std::vector<Overlap> all(kPairs);
    std::vector<unsigned char> peer(kPairs);
    const auto times = race_two(
        [&](std::size_t first) {
            if (how == Ask::One) {
                crowd.one_by_one(first, [&](std::size_t i, const ShapePair& p) { all[i] = overlaps(*p.a, p.pose_a, *p.b, p.pose_b); });
                return;
            }
            overlaps(crowd.places(first), crowd.pairs, executor, verdicts);
            std::ranges::copy(verdicts, all.begin() + static_cast<std::ptrdiff_t>(first));
        },
        [&](std::size_t first) {
            crowd.by_fcl(first, [&](std::size_t i, const auto& a, const auto& b, const auto& here, const auto& there) {
                peer[i] = a.overlaps(b, here, there) ? 1 : 0;
            });
        });
    Faults ours, theirs;
    for (std::size_t i = 0; i < kJudged; ++i) {
        const double depth = true_depth(crowd, i);
        const DistanceResult gap = distance(*crowd.placed[2 * i], crowd.poses[2 * i], *crowd.placed[2 * i + 1], crowd.poses[2 * i + 1]);
        if (depth < kTouching && gap.lower < kTouching) continue;
        const auto error = [&](bool overlap) { return overlap == (depth > 0.0) ? 0.0 : std::max(depth, gap.lower); };
        ours.judge(all[i] == Overlap::Undecided ? std::nullopt : std::optional(error(all[i] == Overlap::Overlapping)), 0.0);
        theirs.judge(error(peer[i] != 0), 0.0);
    }
    rows.add(bench, times, ours, theirs, "wrong_verdicts");
}

void manifold_row(const Crowd& crowd, const std::string& bench, Ask how, Rows& rows) {
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> manifolds;
    std::vector<double> all(kPairs);
    std::vector<std::optional<double>> peer(kPairs);
    const auto times = race_two(
        [&](std::size_t first) {
            if (how == Ask::One) {
                manifolds.clear();
                crowd.one_by_one(first,
                                 [&](std::size_t i, const ShapePair& p) { collide(p, static_cast<std::uint32_t>(i - first), manifolds); });
            } else {
                collide(crowd.places(first), crowd.pairs, executor, scratch, manifolds);
            }
            std::fill_n(all.begin() + static_cast<std::ptrdiff_t>(first), kTurn, 0.0);
            for (const Manifold& m : manifolds) {
                for (const ContactPoint& p : m.used()) all[first + m.pair] = std::max(all[first + m.pair], -double(p.separation));
            }
        },
        [&](std::size_t first) {
            crowd.by_fcl(first, [&](std::size_t i, const auto& a, const auto& b, const auto& here, const auto& there) {
                peer[i] = a.depth(b, here, there);
            });
        });
    Faults ours, theirs;
    for (std::size_t i = 0; i < kJudged; ++i) {
        const double depth = true_depth(crowd, i);
        ours.judge(std::abs(all[i] - depth), 1e-3);
        theirs.judge(peer[i] ? std::optional(std::abs(*peer[i] - depth)) : std::nullopt, 1e-3);
    }
    rows.add(bench, times, ours, theirs, "depths_off_by_1e-3");
}

void distance_row(const Crowd& crowd, const std::string& bench, Ask how, Rows& rows) {
    SerialExecutor executor;
    std::vector<DistanceResult> results;
    std::vector<DistanceResult> all(kPairs);
    std::vector<std::optional<double>> peer(kPairs);
    const auto times = race_two(
        [&](std::size_t first) {
            if (how == Ask::One) {
                crowd.one_by_one(first, [&](std::size_t i, const ShapePair& p) { all[i] = distance(*p.a, p.pose_a, *p.b, p.pose_b); });
                return;
            }
            distance(crowd.places(first), crowd.pairs, executor, {}, results);
            std::ranges::copy(results, all.begin() + static_cast<std::ptrdiff_t>(first));
        },
        [&](std::size_t first) {
            crowd.by_fcl(first, [&](std::size_t i, const auto& a, const auto& b, const auto& here, const auto& there) {
                peer[i] = a.distance(b, here, there);
            });
        });
    Faults ours, theirs;
    for (std::size_t i = 0; i < kJudged; ++i) {
        const DistanceResult truth = distance(*crowd.placed[2 * i], crowd.poses[2 * i], *crowd.placed[2 * i + 1], crowd.poses[2 * i + 1]);
        const auto off = [&](double d) { return std::max({0.0, truth.lower - d, d - truth.upper}); };
        ours.judge(std::max(off(all[i].lower), off(all[i].upper)), 1e-6);
        theirs.judge(peer[i] ? std::optional(off(std::max(0.0, *peer[i]))) : std::nullopt, 1e-6);
    }
    rows.add(bench, times, ours, theirs, "distances_off_by_1e-6");
}

}  // namespace

std::vector<Row> run_convex_rows(const GroupRequest& request) {
    using AddRow = void (*)(const Crowd&, const std::string&, Ask, Rows&);
    struct Entry {
        const char* bench;
        AddRow add;
        Ask how;
    };
    constexpr Entry kBoxes[] = {{"box/boolean", boolean_row, Ask::Many},
                                {"box/manifold", manifold_row, Ask::Many},
                                {"box/one/boolean", boolean_row, Ask::One},
                                {"box/one/distance", distance_row, Ask::One},
                                {"box/one/manifold", manifold_row, Ask::One}};
    constexpr Entry kHulls[] = {{"hull32/boolean", boolean_row, Ask::Many},      {"hull32/distance", distance_row, Ask::Many},
                                {"hull32/manifold", manifold_row, Ask::Many},    {"hull32/one/boolean", boolean_row, Ask::One},
                                {"hull32/one/distance", distance_row, Ask::One}, {"hull32/one/manifold", manifold_row, Ask::One}};
    Rows rows(request);
    const auto run = [&](std::span<const Entry> entries, std::uint64_t seed, Shape (*make)(Random&)) {
        std::optional<Crowd> crowd;
        for (const Entry& entry : entries) {
            if (!rows.wants(entry.bench)) continue;
            if (!crowd) crowd.emplace(seed, make);
            entry.add(*crowd, entry.bench, entry.how, rows);
        }
    };
    run(kBoxes, 12, box_of);
    run(kHulls, 13, hull_of);
    return rows.rows;
}

}  // namespace carom::bench
