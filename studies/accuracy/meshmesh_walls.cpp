// The studies "meshmesh_walls" and "meshmesh_nooks": whether what collide() says of long shapes through thin walls, and of two nooks in each
// other, leads out, and how much farther than need be.
#include <carom/studies/accuracy/any_direction.hpp>
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/oracle/walls.hpp>

#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/collide.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace carom::accuracy {
namespace {

constexpr double kLeastDepth = 1e-4;  // of a pair that counts [m]
constexpr double kHeld = 2e-3;        // what is left of a depth after the motion that counts as not led out [m]
constexpr float kWall = 0.03f, kNookWall = 0.1f;
constexpr int kDirections = 1000;

struct WalledCase {
    Shape a, b;
    Pose pose_a, pose_b;
    oracle::Exits exits;
    double least = 0.0;  // the shortest way out of the whole [m]
};
using WalledCasesPtr = std::shared_ptr<const std::vector<WalledCase>>;

Shape surface_of(const oracle::Walled& room) { return TriangleMesh::build(room.surface.vertices, room.surface.triangles).value(); }

// Rods of 3 x 3 cm, anywhere in the room, turned evenly, that meet its walls.
WalledCasesPtr rod_cases(unsigned walls, float length, std::size_t count, std::uint64_t seed) {
    const oracle::Walled room = oracle::walled(walls, kWall);
    const Shape surface = surface_of(room);
    const Box rod{{0.015f, 0.5f * length, 0.015f}};
    Random random(seed);
    std::vector<WalledCase> cases;
    while (cases.size() < count) {
        const Pose at{{random.range(-0.6, 0.6), random.range(-0.6, 0.6), random.range(-0.6, 0.6)}, any_rotation(random)};
        oracle::Exits exits(std::array{oracle::solid_of(rod, at, at.position)}, oracle::solids_of(room, {}, at.position));
        const auto least = static_cast<double>(exits.least(random, kDirections));
        if (least >= kLeastDepth) cases.push_back({rod, surface, at, {}, std::move(exits), least});
    }
    return std::make_shared<const std::vector<WalledCase>>(std::move(cases));
}

// Two nooks of two walls each, turned evenly, that are as deep in each other as the range says.
WalledCasesPtr nook_cases(double least_depth, double most_depth, std::size_t count, std::uint64_t seed) {
    const oracle::Walled nook = oracle::walled(oracle::kFloor | oracle::kLeft, kNookWall);
    const Shape surface = surface_of(nook);
    Random random(seed);
    std::vector<WalledCase> cases;
    while (cases.size() < count) {
        const Pose at{{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)}, any_rotation(random)};
        oracle::Exits exits(oracle::solids_of(nook, at, at.position), oracle::solids_of(nook, {}, at.position));
        const auto least = static_cast<double>(exits.least(random, kDirections));
        if (least >= std::max(least_depth, kLeastDepth) && least < most_depth) {
            cases.push_back({surface, surface, at, {}, std::move(exits), least});
        }
    }
    return std::make_shared<const std::vector<WalledCase>>(std::move(cases));
}

// The motion of A by which all contacts are led out, each along its own normal.
dvec3 motion_of(std::span<const Manifold> manifolds) {
    dvec3 motion{0.0};
    for (int round = 0; round < 32; ++round) {
        for (const Manifold& m : manifolds) {
            double least = 0.0;
            for (const ContactPoint& p : m.used()) least = std::min(least, static_cast<double>(p.separation));
            const double left = least - 1e-6 - glm::dot(motion, dvec3(m.normal));
            if (left < 0.0) motion += left * dvec3(m.normal);
        }
    }
    return motion;
}

struct Ways {
    std::size_t pairs = 0, held = 0, unsaid = 0;
    double excess = 0.0, longest = 0.0;  // of those that are led out [m]
};

void judge(const WalledCase& c, std::span<const Manifold> manifolds, CollideStatus status, Ways& ways) {
    const dvec3 motion = motion_of(manifolds);
    ++ways.pairs;
    if (static_cast<double>(c.exits.deepest_after(oracle::real(motion))) > kHeld) {
        ++ways.held;
        ways.unsaid += status == CollideStatus::Ok ? 1 : 0;
        return;
    }
    const double more = std::max(0.0, glm::length(motion) - c.least);
    ways.excess += more;
    ways.longest = std::max(ways.longest, more);
}

using Measure = std::function<std::optional<double>(const Ways&)>;  // none where no pair tells

struct Kind {
    std::string suffix, error, unit;
    Measure measure;
};

const std::vector<Kind>& kinds() {
    const auto share = [](std::size_t part, const Ways& w) { return static_cast<double>(part) / static_cast<double>(w.pairs); };
    const auto of_led = [](double value, const Ways& w) { return w.held < w.pairs ? std::optional(value) : std::nullopt; };
    static const std::vector<Kind> all{
        {"", "share of the pairs that are not led out: the motion by all contacts leaves them over 2 mm deep", "1",
         [share](const Ways& w) { return share(w.held, w); }},
        {"_unsaid", "share of the pairs that are not led out and not said to be undecided", "1",
         [share](const Ways& w) { return share(w.unsaid, w); }},
        {"_excess", "by how much the motion is longer than the shortest way, mean of those that are led out", "m",
         [of_led](const Ways& w) { return of_led(w.excess / static_cast<double>(w.pairs - w.held), w); }},
        {"_longest", "by how much the motion is longer than the shortest way, the most of those that are led out", "m",
         [of_led](const Ways& w) { return of_led(w.longest, w); }}};
    return all;
}

Candidate candidate(WalledCasesPtr cases, Settings settings, Measure measure) {
    return {"carom", std::move(settings), [cases = std::move(cases), measure = std::move(measure)] {
                Ways ways;
                Sample sample;
                std::vector<Manifold> manifolds;
                for (const WalledCase& c : *cases) {
                    manifolds.clear();
                    const ThreadStopwatch watch;
                    const CollideStatus status = collide({&c.a, &c.b, c.pose_a, c.pose_b, 0.0f}, 0, manifolds);
                    sample.time_s += watch.seconds() / static_cast<double>(cases->size());
                    judge(c, manifolds, status, ways);
                }
                sample.error = measure(ways);
                return sample;
            }};
}

using Group = std::vector<std::pair<Settings, WalledCasesPtr>>;

void add_studies(const std::string& name, const std::string& pairs, const Group& group, std::vector<Study>& studies) {
    for (const Kind& kind : kinds()) {
        Study study{.name = name + kind.suffix,
                    .stage = "mesh against mesh",
                    .error = kind.error,
                    .unit = kind.unit,
                    .oracle = fmt::format("the least of {} directions and all separating axes of the parts, in long double; {}",
                                          kDirections, pairs),
                    .time = "collide() of one pair, of the processor",
                    .candidates = {}};
        for (const auto& [settings, cases] : group) study.candidates.push_back(candidate(cases, settings, kind.measure));
        studies.push_back(std::move(study));
    }
}

}  // namespace

std::vector<Study> meshmesh_wall_studies(const StudyOptions& options) {
    const std::size_t count = options.quick ? 20 : 400;
    std::vector<Study> studies;
    Group rods, nooks;
    const std::pair<const char*, unsigned> rooms[] = {
        {"L", oracle::kFloor | oracle::kLeft}, {"U", oracle::kFloor | oracle::kLeft | oracle::kRight}, {"bin", oracle::kAllWalls}};
    std::uint64_t seed = 81;
    for (const auto& [name, walls] : rooms) {
        for (const float length : {0.3f, 1.0f, 2.0f}) {
            rods.push_back(
                {{{"walls", std::string(name)}, {"length", static_cast<double>(length)}}, rod_cases(walls, length, count, seed++)});
        }
    }
    nooks.push_back({{{"deep", std::string("up to 0.1 m")}}, nook_cases(0.0, 0.1, count / 2, seed++)});
    nooks.push_back({{{"deep", std::string("0.1 to 0.3 m")}}, nook_cases(0.1, 0.3, count / 2, seed++)});
    add_studies("meshmesh_walls", fmt::format("{} rods of 3 x 3 cm through walls of 3 cm of a room of 1 m, for each kind", count), rods,
                studies);
    add_studies("meshmesh_nooks", fmt::format("{} pairs of nooks of two walls of 1 m and 0.1 m, for each depth", count / 2), nooks,
                studies);
    return studies;
}

}  // namespace carom::accuracy
