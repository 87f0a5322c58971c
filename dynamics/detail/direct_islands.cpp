#include <carom/dynamics/detail/direct_islands.hpp>

#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <limits>

namespace carom::dynamics {
namespace {

/// A soft contact may sag by this share of the smallest extent before its island counts as stiff.
constexpr double kSagShare = 1e-3;
/// A contact that bore so many times the weight of its island stopped a fall in the step before. That is no force to start from where the solve
/// does not converge, nor is what the direct solve left, or what bodies that move had; what rests and was solved softly keeps its impulses, and does not
/// notice that it was tried.
constexpr double kStruck = 1.5;
/// With more manifolds than that, and none solved directly, every sixteenth step is looked at: stiff piles do not come up in less.
constexpr std::size_t kManyManifolds = 512;
constexpr std::uint64_t kLookEvery = 16;
/// Islands have to come to rest first: no body may move by more than this share of the smallest extent in a step. Small ones that soft contacts
/// would squash are tried as they are.
constexpr double kCalmShare = 0.02;
constexpr std::uint32_t kFewBodies = 8;
constexpr double kSquashed = 10.0;  // times the sag that is stiff
/// After a solve that did not converge an island is left alone for 1, 2, 4, ... steps, one of few bodies for 64 at most: to try takes as long as some
/// fifty to a hundred soft steps of it, so what never converges costs a tenth to a fifth more. After one that was too dear for 1,024.
constexpr std::uint64_t kLongestWaitOfFew = 64, kLongestWait = 512, kLongestRefusal = 1024;
/// A graph of so many bodies and links cannot be factorised in the budget: one operation for each at the least, and these piles have fill.
constexpr std::size_t kLeastOperations = 8;
/// An island that was too dear is so again while it has more than 15/16 of the bodies and of the contacts between them that it had: finding out takes as
/// long as a few steps of it.
constexpr std::size_t kShrunk = 16;
/// All factorisations of a solve together may take this many times what one may, but four are always free.
constexpr std::size_t kMostFactorisations = 20;
/// What has not converged by then mostly will not; large islands cost too much to find out.
constexpr int kMostIterations = 60, kMostOfLarge = 25;
/// Of larger islands it is seen early: those that converge miss at most 0.15 of this multiple of the tolerance after five iterations (65 solves of 77 to 210 bodies), those
/// that do not at least 6 times it (173 of heaps of 61 to 300).
constexpr std::size_t kManyBodies = 60;
constexpr int kEarlyLook = 5;
constexpr double kEarlyMost = 8e6;
/// An island that was not stiff for so long is forgotten.
constexpr std::uint64_t kForgetAfter = 256;

/// The force that the stiffness of a contact was chosen for is at first that much above what it bears; it may fall to the share.
constexpr double kLoadRoom = 1.5, kLeastLoadShare = 0.125;
/// No contact is softer than for this share of the island's largest load.
constexpr double kLeastOfIsland = 1.0 / 1024.0;

/// What a contact may come to bear soon: the weight of the lighter body.
double least_load(const ContactPair& pair, const BodyArrays& bodies, const dvec3& gravity, double most) {
    const double inverse = std::max(bodies.masses[pair.body_a.slot].inverse_mass, bodies.masses[pair.body_b.slot].inverse_mass);
    return std::max(glm::length(gravity) / inverse, kLeastOfIsland * most);
}

/// Whether the bodies are free to move, do not bounce and roll without resistance: what is locked, joined, flies or resists is the soft solver's.
bool is_plain(const DirectWorld& world, std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> manifolds) {
    for (const std::uint32_t m : manifolds) {
        const ContactPair& pair = world.contacts.pairs[world.contacts.manifolds[m].pair];
        if (pair.flies || resists(world.proxies.by_slot[pair.proxy_a()].resistance) || resists(world.proxies.by_slot[pair.proxy_b()].resistance)) return false;
    }
    return std::ranges::all_of(bodies, [&](std::uint32_t slot) {
        return world.bodies.masses[slot].locked == LockedAxes::None && (world.jointed.empty() || world.jointed[slot] == 0);
    });
}

SagLaw law_of(const DirectStep& step) { return {step.gravity, step.dt, step.substep(), step.contact_rate, kSagShare}; }

}  // namespace

void DirectIslands::clear() noexcept {
    stiff_.release();
    std::ranges::fill(held_, static_cast<unsigned char>(0));
    any_held_ = false;
    counts_ = {};
}

bool DirectIslands::choose(const DirectWorld& world, const DirectStep& step, const DirectChoice& choice) {
    const bool any = list_tasks(world, step, choice);
    stiff_.release();
    if (!any && counts_.waiting == 0) links_.drop_islands();  // large ones are not looked at again for some steps
    return any;
}

bool DirectIslands::list_tasks(const DirectWorld& world, const DirectStep& step, const DirectChoice& choice) {
    const bool many = world.contacts.manifolds.size() > kManyManifolds && !any_held_ && counts_.waiting + counts_.fell_back == 0;
    std::swap(held_, held_before_);
    held_.assign(world.bodies.roles.size(), 0);
    held_before_.resize(world.bodies.roles.size(), 0);
    any_held_ = false;
    counts_ = {};
    tasks_.clear();
    const std::uint64_t number = step_++;
    method_ = choice.method;
    const bool impulses = choice.method == ContactMethod::Impulses;
    if (choice.method == ContactMethod::Soft || (!impulses && glm::length(step.gravity) == 0.0)) return false;
    const bool all = impulses || choice.method == ContactMethod::Direct;
    if (!all && many && number % kLookEvery != 0) return false;
    if (!impulses && !stiff_.look(world.contacts, world.proxies, world.bodies, law_of(step), held_before_) && !all) return false;
    if (all) all_.assign(world.contacts.manifolds.size(), 1);
    gathers_.note();
    links_.link(world.contacts, world.bodies.roles);
    links_.gather(world.contacts, world.bodies.roles, all ? all_ : stiff_.marks());
    local_of_slot_.assign(world.bodies.roles.size(), kNoBody);
    std::erase_if(memories_, [&](const std::unique_ptr<Memory>& m) { return m->last_step + kForgetAfter < step_; });
    for (const Island& island : links_.islands()) impulses ? put_down(island, world, step) : consider(island, world, step, choice);
    return !tasks_.empty();
}

DirectIslands::Memory& DirectIslands::memory_of(std::uint32_t root) {
    auto found = std::ranges::lower_bound(memories_, root, {}, [](const std::unique_ptr<Memory>& m) { return m->root; });
    if (found == memories_.end() || (*found)->root != root) {
        found = memories_.insert(found, std::make_unique<Memory>());
        (*found)->root = root;
    }
    (*found)->last_step = step_;
    return **found;
}

void DirectIslands::leave_alone(Memory& memory, std::uint64_t most) const noexcept {
    memory.wait = std::min(std::max<std::uint64_t>(2 * memory.wait, 1), most);
    memory.wait_until = step_ + 1 + memory.wait;
}

void DirectIslands::consider(const Island& island, const DirectWorld& world, const DirectStep& step, const DirectChoice& choice) {
    const std::span<const std::uint32_t> bodies = links_.bodies(island), manifolds = links_.manifolds(island);
    const IslandShape shape = look_at_island(world, bodies, manifolds, step);
    const std::size_t taken = tasks_.size();
    if (is_plain(world, bodies, manifolds)) take_if_stiff(island, shape, world, step, choice);
    if (tasks_.size() == taken) forget_lost_loads(bodies, manifolds, shape.weight, world);
}

// What pressed when the direct solve had it may have gone since. Were the soft solver to begin with the impulses of a million times the weight, its passes would not
// take them back.
void DirectIslands::forget_lost_loads(std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> manifolds, double weight,
                                      const DirectWorld& world) const {
    if (!was_held(bodies)) return;
    for (const std::uint32_t m : manifolds) {
        if (stiff_.loads()[m] > kStruck * weight) std::ranges::fill(world.contacts.impulses_of(m), PointImpulse{});
    }
}

bool DirectIslands::was_held(std::span<const std::uint32_t> bodies) const {
    return std::ranges::any_of(bodies, [&](std::uint32_t slot) { return held_before_[slot] != 0; });
}

void DirectIslands::take_if_stiff(const Island& island, const IslandShape& shape, const DirectWorld& world, const DirectStep& step,
                                  const DirectChoice& choice) {
    const std::span<const std::uint32_t> bodies = links_.bodies(island), manifolds = links_.manifolds(island);
    // An impact presses harder than the island weighs, but not for long.
    const SagLaw law = law_of(step);
    double most = 0.0, excess = 0.0, pressed = 0.0;
    for (const std::uint32_t m : manifolds) {
        const ContactPair& pair = world.contacts.pairs[world.contacts.manifolds[m].pair];
        pressed = std::max(pressed, stiff_.loads()[m]);
        const double load = std::min(stiff_.loads()[m], shape.weight);
        most = std::max(most, load);
        excess = std::max(excess, law.excess(pair, world.proxies, world.bodies, load));
    }
    const bool kept = held_before_[bodies.front()] != 0;
    if (choice.method == ContactMethod::Automatic && excess <= (kept ? 0.5 : 1.0)) return;
    ++counts_.stiff;
    Memory& memory = memory_of(bodies.front());
    if (shape.impact) {
        ++counts_.moving;
        return;
    }
    if (memory.wait_until > step_) {
        ++(memory.too_large ? counts_.too_large : counts_.waiting);
        return;
    }
    const bool calm = shape.top_speed * step.dt <= kCalmShare * shape.extent || (bodies.size() <= kFewBodies && excess > kSquashed);
    if (!calm && !kept) {
        ++counts_.moving;
        return;
    }
    memory.rested = !was_held(bodies) && pressed <= kStruck * shape.weight && shape.top_speed * step.dt <= kCalmShare * shape.extent;
    memory.stiffness = stiffness_of(shape, step);
    memory.too_large = !analyse(memory, island, world, choice.budget);
    if (memory.too_large) {
        ++counts_.too_large;
        leave_alone(memory, kLongestRefusal);
        return;
    }
    for (std::size_t i = 0; i < manifolds.size(); ++i) {
        // A stiffness that stays keeps the factor: it follows the load with room to either side.
        const ContactPair& pair = world.contacts.pairs[world.contacts.manifolds[manifolds[i]].pair];
        const double load = std::max(stiff_.loads()[manifolds[i]], least_load(pair, world.bodies, step.gravity, most));
        if (load > memory.loads[i] || load < kLeastLoadShare * memory.loads[i]) memory.loads[i] = kLoadRoom * load;
    }
    memory.stiffness.tolerances.most_iterations = bodies.size() <= kFewBodies ? kMostIterations : kMostOfLarge;
    memory.stiffness.tolerances.early_look = bodies.size() > kManyBodies ? kEarlyLook : 0;
    memory.stiffness.tolerances.early_most = kEarlyMost * memory.stiffness.tolerances.speed_tolerance;
    memory.stiffness.tolerances.most_factorisations =
        static_cast<int>(std::clamp(kMostFactorisations * choice.budget / memory.newton.operations(), std::size_t{4}, std::size_t{60}));
    tasks_.push_back({island, &memory});
}

void DirectIslands::put_down(const Island& island, const DirectWorld& world, const DirectStep& step) {
    const std::span<const std::uint32_t> bodies = links_.bodies(island), manifolds = links_.manifolds(island);
    if (!is_plain(world, bodies, manifolds)) return;
    const IslandShape shape = look_at_island(world, bodies, manifolds, step);
    if (shape.impact) return;
    for (std::size_t i = 0; i < bodies.size(); ++i) local_of_slot_[bodies[i]] = static_cast<std::int32_t>(i);
    Memory& memory = memory_of(bodies.front());
    memory.stiffness = {kSlopShare * shape.extent, kBaumgarteSteps * step.dt, std::numeric_limits<double>::infinity(), shape.height, {}};
    memory.loads.assign(manifolds.size(), 1.0);  // of no meaning where contacts are rigid
    tasks_.push_back({island, &memory});
}

bool DirectIslands::analyse(Memory& memory, const Island& island, const DirectWorld& world, std::size_t budget) {
    const std::span<const std::uint32_t> bodies = links_.bodies(island), manifolds = links_.manifolds(island);
    for (std::size_t i = 0; i < bodies.size(); ++i) local_of_slot_[bodies[i]] = static_cast<std::int32_t>(i);
    const auto link_of = [&](std::uint32_t m) {
        const ContactPair& pair = world.contacts.pairs[world.contacts.manifolds[m].pair];
        return ContactLink{local_of_slot_[pair.body_a.slot], local_of_slot_[pair.body_b.slot], world.contacts.solved_points(m)};
    };
    std::size_t joints = 0;
    for (const std::uint32_t m : manifolds) joints += link_of(m).a != kNoBody && link_of(m).b != kNoBody ? 1 : 0;
    const bool has_shrunk = kShrunk * bodies.size() < (kShrunk - 1) * memory.refused_bodies || kShrunk * joints < (kShrunk - 1) * memory.refused_joints;
    const bool is_large = std::max(bodies.size(), joints) > budget / kLeastOperations;
    if (is_large || (step_ < memory.refused_until && !has_shrunk)) {  // never of what is analysed and the same still; its links are not listed
        memory.analysed = false;
        return false;
    }
    new_links_.clear();
    for (const std::uint32_t m : manifolds) new_links_.push_back(link_of(m));
    const bool known = memory.analysed && std::ranges::equal(memory.slots, bodies) && memory.links == new_links_;
    if (known) return true;
    memory.analysed = false;
    const std::size_t orders = memory.newton.orders();
    memory.analysed = memory.newton.analyse(bodies.size(), new_links_, budget);
    counts_.ordered += memory.newton.orders() - orders;
    if (!memory.analysed) {
        std::vector<ContactLink>().swap(new_links_);  // it was long, and there will not be another such one soon
        memory.refused_until = step_ + kLongestRefusal;
        memory.refused_bodies = bodies.size(), memory.refused_joints = joints;
        return false;
    }
    memory.refused_until = 0;
    memory.slots.assign(bodies.begin(), bodies.end());
    memory.links = new_links_;
    memory.loads.assign(manifolds.size(), 0.0);
    return true;
}

bool DirectIslands::solve_directly(Memory& memory, const IslandLists& island, const DirectWorld& world, const DirectStep& step) {
    fill_problem(world, island, memory.stiffness, step, memory.problem);
    memory.result = memory.newton.solve(memory.problem, memory.stiffness.tolerances);
    if (!memory.result.converged && !memory.rested) {
        for (const std::uint32_t m : island.manifolds) std::ranges::fill(world.contacts.impulses_of(m), PointImpulse{});
    }
    return memory.result.converged;
}

void DirectIslands::solve_by_impulses(Memory& memory, const IslandLists& island, const DirectWorld& world, const DirectStep& step) {
    fill_problem(world, island, memory.stiffness, step, memory.problem);
    const double slop = memory.stiffness.sag / (step.dt + memory.stiffness.relaxation);
    for (DirectContact& c : memory.problem.contacts) {
        if (c.bias < 0.0) c.bias = std::min(c.bias + slop, 0.0);
    }
    guess_impulses(world, island.manifolds, step, memory.problem);
    memory.impulses.solve(memory.problem, step.substeps);
}

void DirectIslands::solve(const DirectWorld& world, const DirectStep& step, Executor& executor) {
    executor.parallel_for(tasks_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Memory& memory = *tasks_[i].memory;
            const std::span<const std::uint32_t> bodies = links_.bodies(tasks_[i].island), manifolds = links_.manifolds(tasks_[i].island);
            const IslandLists island{bodies, manifolds, local_of_slot_, memory.loads};
            if (method_ == ContactMethod::Impulses) {
                solve_by_impulses(memory, island, world, step);
            } else if (!solve_directly(memory, island, world, step)) {
                continue;
            }
            apply_solution(memory.problem, bodies, manifolds, step, world);
            for (const std::uint32_t slot : bodies) held_[slot] = 1;
        }
    });
    if (method_ == ContactMethod::Impulses) {
        any_held_ = true;
        return;
    }
    for (const Task& task : tasks_) {
        Memory& memory = *task.memory;
        counts_.iterations += static_cast<std::size_t>(memory.result.iterations);
        counts_.factorisations += static_cast<std::size_t>(memory.result.factorisations);
        counts_.operations += static_cast<std::size_t>(memory.result.factorisations) * memory.newton.operations();
        if (memory.result.converged) {
            ++counts_.solved;
            memory.wait = 0;
            any_held_ = true;
        } else {
            ++counts_.fell_back;
            leave_alone(memory, links_.bodies(task.island).size() <= kFewBodies ? kLongestWaitOfFew : kLongestWait);
        }
    }
}

void DirectIslands::trim() noexcept {
    if (gathers_.take_seldom()) links_.drop_islands();
}

std::size_t DirectIslands::memory() const noexcept {
    std::size_t sum = links_.memory() + stiff_.memory() + held_by(all_, held_, held_before_, local_of_slot_, memories_, tasks_, new_links_);
    for (const std::unique_ptr<Memory>& m : memories_) {
        sum += sizeof(Memory) + held_by(m->slots, m->links, m->loads, m->problem.bodies, m->problem.contacts) + m->newton.memory() + m->impulses.memory();
    }
    return sum;
}

}  // namespace carom::dynamics
