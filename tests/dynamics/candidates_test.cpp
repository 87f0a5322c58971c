// Candidates are listed in a step, and found anew when somebody asks for one after it.
#include <carom/core/random.hpp>
#include <carom/dynamics/detail/proxies.hpp>

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr double kDt = 1.0 / 60.0;

/// Boxes and balls strewn about, some at rest, some asleep, some fast, over two planes of which one moves.
struct Strewn {
    ProxySet set;
    BodyArrays bodies;
    Broadphase broadphase;
    SerialExecutor executor;
    ScratchPool pool;
    ScratchList<NumberedPair> listed{pool};
    CandidateParts parts;

    void add(const Shape& shape, Role role, const Pose& pose, const dvec3& velocity) {
        const auto slot = static_cast<std::uint32_t>(bodies.states.size());
        bodies.states.push_back({pose, velocity, dvec3{0.0}});
        bodies.masses.emplace_back();
        bodies.roles.push_back(role);
        NewProxy proxy;
        proxy.id = {slot, 1};
        proxy.owner = {slot, 1};
        proxy.shape = shape;
        proxy.reach = is_bounded(shape) ? bounding_radius(shape) : 0.0;
        proxy.extent = smallest_extent(shape);
        put_proxy(set, proxy, {.movable = role == Role::Dynamic});
    }
    explicit Strewn(Random& random) {
        const auto within = [&](double most) {
            return dvec3{random.range(-most, most), random.range(0.2, most), random.range(-most, most)};
        };
        add(Plane{{0, 1, 0}, 0}, Role::Static, {}, dvec3{0.0});
        add(Plane{{1, 0, 0}, 0}, Role::Kinematic, {{-2.0, 0, 0}, kIdentityRotation}, {0.5, 0, 0});
        constexpr Role kRoles[] = {Role::Dynamic, Role::Dynamic, Role::Asleep, Role::Static};
        for (int i = 0; i < 200; ++i) {
            const Shape shape = i % 3 == 0 ? Shape{Sphere{0.4f}} : Shape{Box{vec3{0.3f}}};
            const Role role = kRoles[i % 4];
            add(shape, role, {within(3.0), kIdentityRotation}, role == Role::Dynamic && i % 8 < 4 ? within(4.0) : dvec3{0.0});
        }
    }
    void list() {
        update_swept_bounds(set, bodies, {{0, -9.81, 0}, kDt}, {.share = 0.01}, executor);
        broadphase.update({set.boxes, set.filters, set.moved, set.removed}, executor);
        note_listed(set);
        list_candidates(set, bodies, broadphase.result().pairs, kDt, executor, parts, listed);
    }
};

TEST(Candidates, AreFoundAnewAfterTheStep) {
    Random random(7);
    Strewn scene(random);
    for (int step = 0; step < 3; ++step) {  // in the second what is slow has room
        scene.list();
        std::map<std::pair<std::uint32_t, std::uint32_t>, float> margins;
        for (const NumberedPair& pair : scene.listed) margins[{pair.a, pair.b}] = pair.margin;
        ASSERT_EQ(margins.size(), scene.listed.size());
        ASSERT_GT(margins.size(), 100u);
        // Some fall asleep and some wake when contacts are known: what was listed stays what it was.
        const std::vector<Role> roles = scene.bodies.roles;
        for (std::size_t slot = 0; slot < roles.size(); ++slot) {
            Role& role = scene.bodies.roles[slot];
            if (has_mass(role) && slot % 5 == 0) role = role == Role::Dynamic ? Role::Asleep : Role::Dynamic;
        }
        const auto slots = static_cast<std::uint32_t>(roles.size());
        std::size_t planes = 0;
        const auto check = [&](std::uint32_t a, std::uint32_t b) {
            const auto found = find_candidate(scene.set, scene.bodies, scene.broadphase.result().pairs, kDt, a, b);
            const auto known = margins.find({a, b});
            ASSERT_EQ(found.has_value(), known != margins.end()) << a << ", " << b;
            if (!found) return;
            EXPECT_EQ(found->margin, known->second) << a << ", " << b;
            planes += b < 2 ? 1 : 0;
        };
        for (std::uint32_t a = 2; a < slots; ++a) {
            for (const std::uint32_t plane : {0u, 1u}) check(a, plane);
            for (std::uint32_t b = a + 1; b < slots; ++b) check(a, b);
        }
        EXPECT_GT(planes, 5u);
        scene.bodies.roles = roles;
    }
}

}  // namespace
}  // namespace carom::dynamics
