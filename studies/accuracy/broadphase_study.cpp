// The studies "broadphase": every method over numbers of boxes, spreads, sizes and shares that move; the margins and cells between them;
// and what the chooser takes, on the points that its thresholds come from and on others.
#include <carom/studies/accuracy/box_crowd.hpp>
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/winner_map.hpp>

#include <carom/broadphase/broadphase.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace carom::accuracy {
namespace {

constexpr const char* kStage = "broadphase";
constexpr const char* kError = "share of the reported pairs whose boxes, without margin, do not overlap; missed pairs are failures";
constexpr const char* kTime = "an update, for each box, of the processor";
constexpr int kSettled = 100;               // updates after which the chooser has looked at the scene three times
constexpr std::size_t kTimedBoxes = 20000;  // a pass goes round until it has timed so many

struct Knobs {
    BroadphaseMethod method = BroadphaseMethod::Automatic;
    double margin = 0.0;  // by which boxes that are handed over are larger on every side; they stay until the tight box leaves them [m]
    double cell_scale = 1.0;
};

FloatAabb grown(const FloatAabb& box, double margin) {
    const vec3 by{static_cast<float>(margin)};
    return {box.lower - by, box.upper + by};
}

bool holds(const FloatAabb& outer, const FloatAabb& inner) {
    return outer.lower.x <= inner.lower.x && outer.lower.y <= inner.lower.y && outer.lower.z <= inner.lower.z &&
           inner.upper.x <= outer.upper.x && inner.upper.y <= outer.upper.y && inner.upper.z <= outer.upper.z;
}

// One broadphase with the boxes of a crowd in it. It is made at the first pass, and lives as long as its study.
class Contender {
public:
    Contender(Knobs knobs, std::shared_ptr<BoxCrowd> crowd) : knobs_(knobs), crowd_(std::move(crowd)) {}

    Sample pass() {
        if (!broadphase_) start();
        const std::size_t n = crowd_->boxes().size();
        const auto frames = static_cast<std::size_t>(crowd_->frames());
        const std::size_t rounds = 1 + kTimedBoxes / (n * frames);
        double seconds = 0.0;
        for (std::size_t round = 0; round < rounds; ++round) {
            for (int frame = 0; frame < crowd_->frames(); ++frame) seconds += go_to(frame);
        }
        Sample sample = judge();
        sample.time_s = seconds / static_cast<double>(rounds * frames * n);
        sample.note = knobs_.method == BroadphaseMethod::Automatic ? to_string(broadphase_->method()) : "";
        return sample;
    }

private:
    void start() {
        broadphase_.emplace(BroadphaseSettings{.method = knobs_.method, .cell_scale = knobs_.cell_scale});
        filters_.resize(crowd_->boxes().size());
        for (std::uint32_t slot = 0; slot < filters_.size(); ++slot) {
            fat_.push_back(grown(crowd_->boxes()[slot], knobs_.margin));
            moved_.push_back(slot);
        }
        broadphase_->update({.bounds = fat_, .filters = filters_, .moved = moved_}, executor_);
        // Where all boxes move, the first look at the scene saw what all others will see.
        const bool all_move = crowd_->movers().size() + 1 >= filters_.size();
        const int frames = knobs_.method == BroadphaseMethod::Automatic && !all_move ? kSettled : 0;
        for (int frame = 0; frame < frames || frame % crowd_->frames() != 0; ++frame) go_to(frame % crowd_->frames());
    }

    double go_to(int frame) {
        crowd_->go_to(frame);
        const ThreadStopwatch watch;
        if (knobs_.margin == 0.0) {
            broadphase_->update({.bounds = crowd_->boxes(), .filters = filters_, .moved = crowd_->movers()}, executor_);
            return watch.seconds();
        }
        moved_.clear();
        for (const std::uint32_t slot : crowd_->movers()) {
            const FloatAabb& box = crowd_->boxes()[slot];
            if (holds(fat_[slot], box)) continue;
            fat_[slot] = grown(box, knobs_.margin);
            moved_.push_back(slot);
        }
        broadphase_->update({.bounds = fat_, .filters = filters_, .moved = moved_}, executor_);
        return watch.seconds();
    }

    // Both lists are sorted by (a, b).
    [[nodiscard]] Sample judge() {
        const std::vector<ProxyPair>& exact = crowd_->exact_pairs();
        std::size_t reported = 0, right = 0, next = 0;
        for (const ProxyPair& pair : broadphase_->result().pairs) {
            if (!crowd_->is_checked(pair.a)) continue;
            ++reported;
            while (next < exact.size() && exact[next] < pair) ++next;
            if (next < exact.size() && exact[next] == pair) ++right;
        }
        Sample sample;
        sample.failures = exact.size() - right;
        sample.error = reported == 0 ? 0.0 : static_cast<double>(reported - right) / static_cast<double>(reported);
        return sample;
    }

    Knobs knobs_;
    std::shared_ptr<BoxCrowd> crowd_;
    std::optional<Broadphase> broadphase_;
    std::vector<FloatAabb> fat_;
    std::vector<ProxyFilter> filters_;
    std::vector<std::uint32_t> moved_;
    SerialExecutor executor_;
};

// The crowd of a study is made when the first of its candidates runs.
class LazyCrowd {
public:
    explicit LazyCrowd(const CrowdSettings& settings) : settings_(settings) {}
    std::shared_ptr<BoxCrowd> get() {
        if (!crowd_) crowd_ = std::make_shared<BoxCrowd>(settings_);
        return crowd_;
    }

private:
    CrowdSettings settings_;
    std::shared_ptr<BoxCrowd> crowd_;
};

Candidate candidate(const Knobs& knobs, const std::shared_ptr<LazyCrowd>& crowd, bool all_knobs) {
    Settings settings{{"method", std::string(to_string(knobs.method))}};
    if (all_knobs) {
        settings.emplace_back("margin", knobs.margin);
        settings.emplace_back("cell", knobs.cell_scale);
    }
    auto contender = std::make_shared<std::unique_ptr<Contender>>();
    return {"carom", settings, [knobs, crowd, contender] {
                if (!*contender) *contender = std::make_unique<Contender>(knobs, crowd->get());
                return (*contender)->pass();
            }};
}

std::string share_text(double share) { return fmt::format("{:g}", 100.0 * share); }

std::string condition_of(const CrowdSettings& c) {
    std::string text = to_string(c.spread);
    if (c.size_ratio > 1.0) text = fmt::format("sizes{:g}", c.size_ratio);
    if (c.overlaps != CrowdSettings{}.overlaps) text += fmt::format("_overlaps{:g}", c.overlaps);
    return text + "_" + share_text(c.moving);
}

// Only letters, digits and '_'.
std::string name_of(const std::string& what) {
    std::string name = "broadphase_" + what;
    std::ranges::replace(name, '.', 'p');
    return name;
}

Study study_of(const std::string& name, const CrowdSettings& c) {
    return {.name = name,
            .stage = kStage,
            .error = kError,
            .unit = "1",
            .oracle = fmt::format("every pair looked at by itself; {} boxes, {}, sizes over a ratio of {:g}, {} % moving", c.count,
                                  to_string(c.spread), c.size_ratio, share_text(c.moving)),
            .time = kTime,
            .cases = {{"spread", std::string(to_string(c.spread))},
                      {"count", static_cast<double>(c.count)},
                      {"moving", c.moving},
                      {"size_ratio", c.size_ratio},
                      {"overlaps", c.overlaps}},
            .candidates = {}};
}

// Brute force beyond 10,000 boxes, and a million boxes that all move with methods that take seconds for them, would only cost time.
bool takes_part(BroadphaseMethod method, const CrowdSettings& c) {
    using enum BroadphaseMethod;
    if (method == BruteForce) return c.count <= 10000;
    return c.count <= 100000 || c.moving < 0.5 || (method != SortedAxes && method != DynamicTree);
}

// Time against false pairs: margins and cells.
Study knob_study(const std::string& name, const CrowdSettings& c) {
    Study study = study_of(name, c);
    const auto crowd = std::make_shared<LazyCrowd>(c);
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        for (const double margin : {0.0, 0.02, 0.05, 0.1, 0.2, 0.4}) {
            if (takes_part(method, c)) study.candidates.push_back(candidate({method, margin, 1.0}, crowd, true));
        }
    }
    for (const BroadphaseMethod method : {BroadphaseMethod::UniformGrid, BroadphaseMethod::HierarchicalGrid}) {
        for (const double cell : {0.5, 0.7, 1.4, 2.0}) study.candidates.push_back(candidate({method, 0.0, cell}, crowd, true));
    }
    return study;
}

// One cell of a winner map.
Study map_study(const std::string& map, const CrowdSettings& c) {
    const std::string condition = condition_of(c);
    Study study = study_of(name_of(fmt::format("{}_{}_{}", map, condition, c.count)), c);
    study.cases.emplace_back("map", map);
    study.cases.emplace_back("condition", condition);
    const auto crowd = std::make_shared<LazyCrowd>(c);
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        if (takes_part(method, c)) study.candidates.push_back(candidate({.method = method}, crowd, false));
    }
    study.candidates.push_back(candidate({}, crowd, false));
    return study;
}

// The points that the chooser's thresholds come from.
std::vector<CrowdSettings> known_conditions() {
    using enum Spread;
    return {{.spread = Even, .moving = 0.001},
            {.spread = Even, .moving = 0.01},
            {.spread = Even, .moving = 0.1},
            {.spread = Even, .moving = 1.0},
            {.spread = Clustered, .moving = 0.01},
            {.spread = Clustered, .moving = 1.0},
            {.spread = Planar, .moving = 0.01},
            {.spread = Planar, .moving = 1.0},
            {.spread = Stacked, .moving = 0.1},
            {.spread = Ground, .moving = 0.01},
            {.spread = Ground, .moving = 1.0},
            {.spread = Line, .moving = 0.01},
            {.spread = Line, .moving = 1.0},
            {.spread = Diagonal, .moving = 0.01},
            {.spread = Diagonal, .moving = 1.0},
            {.spread = Even, .moving = 0.01, .size_ratio = 10.0},
            {.spread = Even, .moving = 1.0, .size_ratio = 10.0},
            {.spread = Even, .moving = 0.01, .size_ratio = 100.0},
            {.spread = Even, .moving = 1.0, .size_ratio = 100.0},
            {.spread = Even, .moving = 0.1, .size_ratio = 1e4},
            {.spread = Even, .moving = 1.0, .size_ratio = 1e4},
            {.spread = Even, .moving = 0.1, .overlaps = 30.0},
            {.spread = Even, .moving = 0.1, .overlaps = 0.03}};
}

// Others: of other numbers, shares, ratios, densities and seeds.
std::vector<CrowdSettings> held_out_conditions() {
    using enum Spread;
    return {{.spread = Even, .moving = 0.003},
            {.spread = Even, .moving = 0.03},
            {.spread = Even, .moving = 0.4},
            {.spread = Clustered, .moving = 0.003},
            {.spread = Clustered, .moving = 0.1},
            {.spread = Clustered, .moving = 0.7},
            {.spread = Planar, .moving = 0.1},
            {.spread = Planar, .moving = 0.6},
            {.spread = Stacked, .moving = 0.01},
            {.spread = Stacked, .moving = 1.0},
            {.spread = Ground, .moving = 0.1},
            {.spread = Line, .moving = 0.1},
            {.spread = Diagonal, .moving = 0.3},
            {.spread = Even, .moving = 0.03, .size_ratio = 3.0},
            {.spread = Even, .moving = 1.0, .size_ratio = 3.0},
            {.spread = Even, .moving = 0.3, .size_ratio = 30.0},
            {.spread = Even, .moving = 0.01, .size_ratio = 1000.0},
            {.spread = Even, .moving = 1.0, .size_ratio = 1000.0},
            {.spread = Even, .moving = 0.03, .overlaps = 10.0},
            {.spread = Even, .moving = 0.3, .overlaps = 0.3}};
}

void add_map(const std::string& map, const std::vector<CrowdSettings>& conditions, const std::vector<std::size_t>& counts,
             std::vector<Study>& studies) {
    std::uint64_t seed = map == kHeldOut ? 9000 : 100;
    for (CrowdSettings c : conditions) {
        for (const std::size_t count : counts) {
            c.count = count;
            c.seed = ++seed;
            studies.push_back(map_study(map, c));
        }
    }
}

}  // namespace

std::vector<Study> broadphase_studies(const StudyOptions& options) {
    using enum Spread;
    const std::size_t middle = options.quick ? 1000 : 10000;
    std::vector<Study> studies;
    studies.push_back(knob_study("broadphase", {.spread = Even, .count = middle, .moving = 0.1}));
    if (options.quick) {
        add_map(kKnown, {{.spread = Even, .moving = 0.1}, {.spread = Clustered, .moving = 1.0}, {.spread = Coincident, .moving = 0.1}},
                {100, 400}, studies);
        add_map(kHeldOut, {{.spread = Even, .moving = 0.4}}, {60, 500}, studies);
        return studies;
    }
    studies.push_back(knob_study("broadphase_all_moving", {.spread = Even, .count = middle, .moving = 1.0}));
    studies.push_back(knob_study("broadphase_sizes", {.spread = Even, .count = middle, .moving = 0.1, .size_ratio = 100.0}));
    add_map(kKnown, known_conditions(), {100, 250, 600, 1000, 10000, 100000}, studies);
    add_map(kKnown, {{.spread = Coincident, .moving = 0.1}}, {100, 1000}, studies);
    add_map(kKnown, {{.spread = Even, .moving = 0.01}, {.spread = Even, .moving = 1.0}}, {1000000}, studies);
    add_map(kHeldOut, held_out_conditions(), {150, 400, 3000, 30000}, studies);
    add_map(kHeldOut, {{.spread = Coincident, .moving = 0.3}}, {60, 400}, studies);
    return studies;
}

}  // namespace carom::accuracy
