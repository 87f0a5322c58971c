#include <carom/bench/sweeps_group.hpp>

#include <carom/bench/bullet_convex.hpp>
#include <carom/bench/fcl_convex.hpp>
#include <carom/bench/fcl_mesh.hpp>
#include <carom/bench/race.hpp>
#include <carom/bench/random_shapes.hpp>
#include <carom/narrowphase/shape_cast.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace carom::bench {
namespace {

constexpr std::size_t kShapes = 200, kPairs = 4000, kTurn = 200;
constexpr double kLate = 1e-5;  // of the motion
constexpr double kApart = 4.0;  // more than two of the largest shapes reach
constexpr double kMostTurn = 0.7;

Shape ball_of(Random& random) { return Sphere{static_cast<float>(random.range(0.2, 1.0))}; }

struct Kind {
    const char* bench;
    Shape (*a)(Random&);
    Shape (*b)(Random&);
    bool both_move;
    bool turning;
    std::uint64_t seed;
};
constexpr Kind kKinds[] = {
    {"balls/moving", ball_of, box_of, false, false, 21}, {"boxes/moving", box_of, box_of, true, false, 22},
    {"hulls/moving", hull_of, hull_of, true, false, 23}, {"boxes/turning", box_of, box_of, true, true, 24},
    {"hulls/turning", hull_of, hull_of, true, true, 25},
};

struct Answer {
    bool met = false;
    double t = 1.0;
    bool silent = false;
};

// What is proved of a pair.
struct Truth {
    bool apart = false;       // at every t
    double not_before = 0.0;  // no contact before
    double overlap = 2.0;     // at this t; 2: none was found
};

// One side of all pairs, as each contender takes it.
struct Side {
    std::vector<Shape> shapes;
    std::vector<FclConvex> fcl_shapes;
    std::vector<BulletConvex> bullet_shapes;
    std::vector<std::size_t> shape_of;  // by pair
    std::vector<RigidMotion> motions;
    std::vector<FclMotion> fcl_motions;
    std::vector<BulletMotion> bullet_motions;

    void make_shapes(Random& random, Shape (*make)(Random&)) {
        for (std::size_t i = 0; i < kShapes; ++i) {
            shapes.push_back(make(random));
            fcl_shapes.emplace_back(shapes.back());
            bullet_shapes.emplace_back(shapes.back());
        }
    }
    void add(Random& random, const RigidMotion& motion) {
        shape_of.push_back(static_cast<std::size_t>(random.range(0.0, double(kShapes))));
        motions.push_back(motion);
        fcl_motions.emplace_back(motion);
        bullet_motions.emplace_back(motion);
    }
    [[nodiscard]] const Shape& shape(std::size_t i) const { return shapes[shape_of[i]]; }
};

class Crowd {
public:
    explicit Crowd(const Kind& kind) : kind_(kind) {
        Random random(kind.seed);
        a_.make_shapes(random, kind.a);
        b_.make_shapes(random, kind.b);
        for (std::size_t i = 0; i < kPairs; ++i) {
            const dvec3 way = direction_of(random);
            RigidMotion a{.start = {-kApart * way, rotation_of(random)}}, b{.start = {dvec3{0.0}, rotation_of(random)}};
            a.translation = (kApart * random.range(0.5, 2.0)) * way + 0.5 * direction_of(random);
            if (kind.both_move) b.translation = direction_of(random), a.translation += b.translation;
            if (kind.turning) {
                a.rotation = random.range(0.0, kMostTurn) * direction_of(random);
                b.rotation = random.range(0.0, kMostTurn) * direction_of(random);
            }
            a_.add(random, a);
            b_.add(random, b);
        }
        for (std::size_t i = 0; i < kPairs; ++i) truths_.push_back(prove(i));
    }

    [[nodiscard]] Answer by_carom(std::size_t i) const {
        const Impact impact = kind_.both_move ? time_of_impact(a_.shape(i), a_.motions[i], b_.shape(i), b_.motions[i])
                                              : cast_shape(a_.shape(i), a_.motions[i], b_.shape(i), b_.motions[i].start);
        return {may_touch(impact.status), impact.t};
    }
    [[nodiscard]] Answer by_fcl(std::size_t i) const {
        const FclImpact impact = a_.fcl_shapes[a_.shape_of[i]].time_of_impact(b_.fcl_shapes[b_.shape_of[i]], a_.fcl_motions[i], b_.fcl_motions[i]);
        return {impact.met, impact.t, impact.threw};
    }
    [[nodiscard]] Answer by_bullet(std::size_t i) const {
        const BulletConvex &a = a_.bullet_shapes[a_.shape_of[i]], &b = b_.bullet_shapes[b_.shape_of[i]];
        const BulletMotion &here = a_.bullet_motions[i], &there = b_.bullet_motions[i];
        const BulletImpact impact = kind_.turning ? a.time_of_impact(b, here, there) : a.cast(b, here, there);
        return {impact.met, impact.t};
    }
    [[nodiscard]] const std::vector<Truth>& truths() const { return truths_; }

private:
    [[nodiscard]] bool overlap_at(std::size_t i, double t) const {
        return distance(a_.shape(i), pose_at(a_.motions[i], t), b_.shape(i), pose_at(b_.motions[i], t)).status == DistanceStatus::Overlap;
    }
    [[nodiscard]] Truth prove(std::size_t i) const {
        constexpr int kSamples = 100, kHalvings = 40;
        const Impact impact = time_of_impact(a_.shape(i), a_.motions[i], b_.shape(i), b_.motions[i], {.most_checks = 1 << 14});
        Truth truth{impact.status == ImpactStatus::Separated, impact.t, 2.0};
        for (int k = 0; k <= kSamples && truth.overlap > 1.0; ++k) {
            if (overlap_at(i, double(k) / kSamples)) truth.overlap = double(k) / kSamples;
        }
        double before = std::min(truth.not_before, truth.overlap);
        for (int k = 0; k < kHalvings && truth.overlap <= 1.0; ++k) {
            const double middle = 0.5 * (before + truth.overlap);
            (overlap_at(i, middle) ? truth.overlap : before) = middle;
        }
        return truth;
    }

    Kind kind_;
    Side a_, b_;
    std::vector<Truth> truths_;
};

Quality judge(const std::vector<Truth>& truths, const std::vector<Answer>& answers) {
    std::size_t missed = 0, late = 0, made_up = 0, silent = 0, sound = 0;
    double latest = 0.0, early = 0.0;
    for (std::size_t i = 0; i < truths.size(); ++i) {
        const Truth& truth = truths[i];
        const Answer& answer = answers[i];
        silent += answer.silent ? 1 : 0;
        if (answer.silent) continue;
        if (!answer.met) {
            missed += truth.overlap <= 1.0 ? 1 : 0;
            continue;
        }
        latest = std::max(latest, truth.overlap <= 1.0 ? answer.t - truth.overlap : 0.0);
        const bool is_late = answer.t > truth.overlap + kLate;
        late += is_late ? 1 : 0;
        made_up += truth.apart ? 1 : 0;
        if (is_late || truth.apart) continue;
        ++sound;
        early += std::max(0.0, truth.not_before - answer.t);
    }
    return {{"missed", double(missed)}, {"late", double(late)},     {"latest", latest},
            {"made_up", double(made_up)}, {"early", sound > 0 ? early / double(sound) : 0.0}, {"no_answer", double(silent)}};
}

std::string text_of(const Quality& quality) {
    std::string text;
    for (const auto& [name, value] : quality) text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", name, value);
    return text;
}

void print(std::FILE* table, const Row& row) {
    fmt::print(table, "{:<22} carom {:>8.1f} ns   {} {:>8.1f} ns   {:>6.2f}x\n", row.bench, 1e6 * row.carom_ms, row.peer, 1e6 * row.peer_ms,
               speedup(row));
    fmt::print(table, "    carom: {}\n    {}: {}\n", text_of(row.carom_quality), row.peer, text_of(row.peer_quality));
    std::fflush(table);
}

}  // namespace

Result<std::vector<Row>> run_sweeps_group(const GroupRequest& request) {
    std::vector<Row> rows;
    for (const Kind& kind : kKinds) {
        const auto wanted = [&](const char* peer) { return fmt::format("{}/{}", kind.bench, peer).find(request.filter) != std::string::npos; };
        const bool fcl = wanted("fcl"), bullet = wanted("bullet");
        if (!fcl && !bullet) continue;
        const Crowd crowd(kind);
        std::vector<std::vector<Answer>> answers(3, std::vector<Answer>(kPairs));
        const auto turn = [&](std::vector<Answer>& out, Answer (Crowd::*ask)(std::size_t) const) -> Turn {
            return [&crowd, &out, ask](std::size_t first) {
                for (std::size_t i = first; i < first + kTurn; ++i) out[i] = (crowd.*ask)(i);
            };
        };
        std::vector<Turn> contenders{turn(answers[0], &Crowd::by_carom)};
        if (fcl) contenders.push_back(turn(answers[1], &Crowd::by_fcl));
        if (bullet) contenders.push_back(turn(answers[2], &Crowd::by_bullet));
        const std::vector<double> medians = race(contenders, {.items = kPairs, .turn = kTurn});
        const auto add = [&](const char* peer, const std::string& version, double ns, const std::vector<Answer>& of_peer) {
            Row row;
            row.bench = kind.bench;
            row.peer = peer;
            row.peer_version = version;
            row.carom_ms = 1e-6 * medians[0];
            row.peer_ms = 1e-6 * ns;
            row.carom_quality = judge(crowd.truths(), answers[0]);
            row.peer_quality = judge(crowd.truths(), of_peer);
            print(request.table, row);
            rows.push_back(std::move(row));
        };
        if (fcl) add("fcl", FclMesh::version(), medians[1], answers[1]);
        if (bullet) add("bullet", BulletConvex::version(), medians.back(), answers[2]);
    }
    if (rows.empty()) return Error{ErrorCode::UnknownName, fmt::format("no row of the group matches \"{}\"", request.filter), "filter"};
    return rows;
}

}  // namespace carom::bench
