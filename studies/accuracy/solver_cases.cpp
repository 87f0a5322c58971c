#include <carom/studies/accuracy/solver_cases.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/accuracy/scene_bodies.hpp>

#include <array>
#include <cmath>

namespace carom::accuracy {
namespace {

constexpr double kGravity = 9.81;
constexpr int kColumn = 20, kRows = 10, kWedges = 9;
constexpr double kInner = 2.0, kOuter = 2.6, kDeep = 0.5;  // of the arch [m]
constexpr double kHalf = 0.25;                             // of a box of the pile [m]

void add_floor(World& world) {
    world.add_shape(world.create_body({.type = BodyType::Static, .position = {0.0, -0.5, 0.0}}), Box{{20.0f, 0.5f, 20.0f}});
}

void add_box(World& world, const Pose& pose, double half, double density) {
    const BodyId body = world.create_body({.position = pose.position, .orientation = pose.orientation});
    world.add_shape(body, Box{vec3{static_cast<float>(half)}}, {.density = density});
}

void add_column(World& world, std::span<const double> densities) {
    for (std::size_t i = 0; i < densities.size(); ++i) add_box(world, {{0.0, 0.5 + static_cast<double>(i), 0.0}}, 0.5, densities[i]);
}

void add_pyramid(World& world) {
    for (int row = 0; row < kRows; ++row) {
        for (int i = 0; i < kRows - row; ++i) add_box(world, {{1.0625 * (i - 0.5 * (kRows - row - 1)), 0.5 + row, 0.0}}, 0.5, 1000.0);
    }
}

// Voussoirs: each shares its two faces with its neighbours, the outer ones stand on the floor.
void add_arch(World& world) {
    for (int i = 0; i < kWedges; ++i) {
        std::vector<vec3> corners;
        for (const int side : {i, i + 1}) {
            const double angle = kPi * side / kWedges;
            for (const double radius : {kInner, kOuter}) {
                // To the last digit on the floor.
                const double height = side == 0 || side == kWedges ? 0.0 : radius * std::sin(angle);
                for (const double z : {-kDeep, kDeep}) {
                    corners.emplace_back(static_cast<float>(radius * std::cos(angle)), static_cast<float>(height), static_cast<float>(z));
                }
            }
        }
        world.add_shape(world.create_body(), *ConvexHull::build(corners), {.density = 2000.0, .friction = 0.8f});
    }
}

void add_bin(World& world) {
    for (const double side : {-1.0, 1.0}) {
        world.add_shape(world.create_body({.type = BodyType::Static, .position = {1.5 * side, 4.0, 0.0}}), Box{{0.25f, 4.0f, 1.75f}});
        world.add_shape(world.create_body({.type = BodyType::Static, .position = {0.0, 4.0, 1.5 * side}}), Box{{1.75f, 4.0f, 0.25f}});
    }
}

std::vector<Pose> start_of_pile(int count) {
    std::vector<Pose> poses;
    Random random(9022);
    for (int i = 0; i < count; ++i) {
        const double x = 0.75 * (i % 3 - 1) + random.range(-0.04, 0.04), z = 0.8 * ((i / 3) % 2 - 0.5) + random.range(-0.04, 0.04);
        const double angle = random.range(-0.3, 0.3);
        poses.push_back({{x, 0.3 + 0.6 * (i / 6), z}, {std::cos(angle), 0.0, std::sin(angle), 0.0}});
    }
    return poses;
}

World pile_of(const WorldDef& def, const std::vector<Pose>& poses) {
    World world(def);
    add_floor(world);
    add_bin(world);
    for (const Pose& pose : poses) add_box(world, pose, kHalf, 1000.0);
    return world;
}

WorldDef with_gravity(WorldDef def) {
    def.gravity = {0.0, -kGravity, 0.0};
    return def;
}

// By the direct method, which leaves the least motion: forces of the same places exist then.
std::vector<Pose> settled_pile(bool quick) {
    World world = pile_of(with_gravity({.contact_method = ContactMethod::Direct, .direct_budget = 2'000'000}), start_of_pile(quick ? 30 : 100));
    for (int i = 0; i < (quick ? 180 : 480); ++i) world.step(1.0 / 60.0);
    std::vector<Pose> poses;
    for (const BodyId body : moving_bodies(world)) poses.push_back(world.pose(body));
    return poses;
}

std::vector<double> densities_of(SolverKind kind) {
    if (kind == SolverKind::Heavy) return {1.0, 1e4};
    return std::vector<double>(static_cast<std::size_t>(kColumn), 1000.0);
}

// Of boxes of 1 m³ on each other.
std::vector<double> loads_of(const std::vector<double>& densities) {
    std::vector<double> loads(densities.size());
    double above = 0.0;
    for (std::size_t i = densities.size(); i-- > 0;) loads[i] = above += kGravity * densities[i];
    return loads;
}

}  // namespace

const char* to_string(SolverKind kind) noexcept {
    switch (kind) {
        case SolverKind::Column: return "column";
        case SolverKind::Heavy: return "heavy";
        case SolverKind::Pyramid: return "pyramid";
        case SolverKind::Arch: return "arch";
        case SolverKind::Pile: return "pile";
    }
    return "unknown";
}

std::span<const SolverKind> solver_kinds() {
    static constexpr std::array kKinds{SolverKind::Column, SolverKind::Heavy, SolverKind::Pyramid, SolverKind::Arch, SolverKind::Pile};
    return kKinds;
}

SolverCasePtr solver_case(SolverKind kind, bool quick) {
    auto out = std::make_shared<SolverCase>();
    out->kind = kind;
    if (kind == SolverKind::Pile) {
        out->make = [poses = settled_pile(quick)](const WorldDef& def) { return pile_of(with_gravity(def), poses); };
        return out;
    }
    const bool column = kind == SolverKind::Column || kind == SolverKind::Heavy;
    if (column) out->carried = loads_of(densities_of(kind));
    out->make = [kind, column](const WorldDef& def) {
        World world(with_gravity(def));
        add_floor(world);
        if (column) add_column(world, densities_of(kind));
        if (kind == SolverKind::Pyramid) add_pyramid(world);
        if (kind == SolverKind::Arch) add_arch(world);
        return world;
    };
    return out;
}

}  // namespace carom::accuracy
