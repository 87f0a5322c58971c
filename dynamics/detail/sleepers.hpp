// Which bodies sleep, and which islands may. docs/dynamics.md has the criterion.
//
//   sleepers.watch(bodies, proxies, gravity, dt);   // after a step: how still is each body?
//   sleepers.fall_asleep(scene);                    // islands in which all have been still for long enough, and are held
//   sleepers.wake(slot, bodies);                    // the whole island
#pragma once

#include <carom/core/hash.hpp>
#include <carom/dynamics/detail/body_sizes.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/island_links.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/sleep_contacts.hpp>
#include <carom/dynamics/sleep_settings.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// Two bodies that something other than a contact holds together: they sleep and wake as one. Either may be without mass, or the world.
struct BodyLink {
    static constexpr std::uint32_t kWorld = ~std::uint32_t{0};
    std::uint32_t a = 0, b = 0;  ///< slots, or kWorld
};

/// @return what gravity pulls a body by along the axes that are free to it [m/s²].
[[nodiscard]] dvec3 free_pull(const BodyArrays& bodies, std::size_t slot, const dvec3& gravity) noexcept;

/// @return whether the body may wake others: it is dynamic and awake, or kinematic and moves.
[[nodiscard]] inline bool stirs(const BodyArrays& bodies, std::uint32_t slot) noexcept {
    if (bodies.roles[slot] != Role::Kinematic) return bodies.roles[slot] == Role::Dynamic;
    return bodies.states[slot].velocity != dvec3{0.0} || bodies.states[slot].spin != dvec3{0.0};
}

/// What islands are made of.
struct SleepScene {
    ContactSet& contacts;  ///< of the last step; those of what falls asleep are taken out
    BodyArrays& bodies;
    dvec3 gravity{0.0};
    std::span<const BodyLink> links{};
};

/// All but is_on() and count() are for worlds whose bodies may sleep.
class Sleepers {
public:
    explicit Sleepers(const SleepSettings& settings) : settings_(settings) {}
    [[nodiscard]] bool is_on() const noexcept { return settings_.enabled; }

    /// A body came to the slot.
    void begin(std::uint32_t slot, bool may_sleep, const BodyState& state);
    /// The shapes of some body are others.
    void note_shapes() noexcept { sizes_known_ = false; }
    /// A shape on a body without mass came or was put elsewhere: in the next step it wakes what it is near to.
    void note_placed(std::uint32_t proxy) { placed_.push_back(proxy); }

    /// Wakes the island of a body that sleeps; for one that is awake the time begins anew. Boxes follow with sync(), contacts with give_back().
    void wake(std::uint32_t slot, BodyArrays& bodies) noexcept;
    /// Wakes all, without the contacts that they had.
    void wake_all(BodyArrays& bodies) noexcept;
    /// Wakes what sleeps in touch with a body. Cost: O(contacts of what sleeps).
    void wake_touching(std::uint32_t slot, BodyArrays& bodies) noexcept;
    /// Before a step: wakes what lies on bodies without mass that move, and what is near to such as were placed.
    void wake_by_others(const ProxySet& proxies, double dt, BodyArrays& bodies);
    /// Wakes what a contact of this step joins to something that is awake and moves. @return whether there was any.
    bool wake_touched(const ContactSet& contacts, BodyArrays& bodies) noexcept;
    /// Puts the contacts of what woke since the last call into `to`. @return whether there was any.
    bool give_back(const BodyArrays& bodies, ContactSet& to);
    /// Makes boxes and filters those of bodies that are awake or asleep now.
    void sync(const BodyArrays& bodies, ProxySet& proxies) noexcept;

    /// Takes out pairs that nothing could come of: bodies without mass with each other, and with what sleeps where they stand still.
    static void drop_idle(const ProxySet& proxies, const BodyArrays& bodies, ScratchList<NumberedPair>& candidates);
    [[nodiscard]] static bool is_idle(const ProxySet& proxies, const BodyArrays& bodies, const NumberedPair& pair);
    /// After a step of `dt` [s]: measures how far each body that is awake has moved.
    void watch(const BodyArrays& bodies, const ProxySet& proxies, const dvec3& gravity, double dt);
    /// Puts islands to sleep in which every body has been still for long enough and is held. @return whether any fell asleep.
    bool fall_asleep(const SleepScene& scene);
    /// The same of the island of one body, whose bodies need only be still and held now. @return whether it sleeps.
    bool put_to_sleep(std::uint32_t slot, const SleepScene& scene);
    /// Impulses are those of a substep: where its length changes, so do they.
    void scale_impulses(float scale) noexcept;

    [[nodiscard]] std::size_t count() const noexcept { return count_; }  ///< of bodies that sleep
    /// @return how many fell asleep, or woke, since the last call.
    [[nodiscard]] std::size_t take_fallen() noexcept;
    [[nodiscard]] std::size_t take_woken() noexcept;
    /// Of what sleeps.
    [[nodiscard]] const ContactSet& contacts() const noexcept { return asleep_; }
    /// Adds what the future of a body depends on.
    void add_to(StateHash& hash, std::uint32_t slot) const noexcept;
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    /// How still a body has been, by halves of the time that is asked for.
    struct Stillness {
        Pose from{};               ///< where this half began
        dvec3 velocity{0.0};       ///< after the last step
        dvec3 spin{0.0};
        double motion = 0.0;       ///< the farthest that a point has come from there [m]
        double before = 0.0;       ///< the same of the half before this
        double since = 0.0;        ///< how long the half has lasted [s]
        double pulled = 0.0;       ///< what the last step changed the velocity of any point by, over dt [m/s²]
        std::uint32_t steps = 0;   ///< of this half
        unsigned char halves = 0;  ///< before this one in which it was still, and ever more so; 2 are enough
    };
    /// What is known of an island, at its root.
    struct Findings {
        bool restless = false;  ///< some body moves, is held by nothing or may not sleep
        bool anchored = false;  ///< something that cannot give way holds it
    };

    static void start_anew(Stillness& s, const BodyState& state) noexcept;
    void watch_one(std::size_t slot, const BodyArrays& bodies, const dvec3& gravity, double dt) noexcept;
    [[nodiscard]] bool is_over(const Stillness& s) const noexcept;
    [[nodiscard]] double most_motion(std::size_t slot, double pull) const noexcept;
    [[nodiscard]] bool rests_alone(std::size_t slot, const BodyArrays& bodies, double pull) const noexcept;
    [[nodiscard]] bool is_still_now(std::size_t slot, double pull) const noexcept;
    void look_at_touch(const SleepScene& scene);
    /// @param a, b  slots, or BodyLink::kWorld.
    void touch(const BodyArrays& bodies, std::uint32_t a, std::uint32_t b, bool holds) noexcept;
    /// @param wait  whether bodies must have been still for the whole time.
    void look_at_bodies(const SleepScene& scene, bool wait);
    void look_at_islands(const SleepScene& scene, bool wait);
    bool take_islands(const SleepScene& scene, std::uint32_t first_root, std::uint32_t last_root);
    void wake_near(const ProxySet& proxies, std::uint32_t proxy, double dt, BodyArrays& bodies);

    SleepSettings settings_;
    std::vector<Stillness> still_;             // by slot
    std::vector<BodySize> sizes_;              // by slot
    std::vector<unsigned char> may_sleep_;     // by slot
    std::vector<std::uint32_t> ring_;          // by slot: the next body of the island that sleeps
    std::vector<std::uint32_t> last_;          // by root: of the ring so far
    std::vector<unsigned char> touched_;       // by slot
    std::vector<Findings> findings_;           // by root
    std::vector<std::uint32_t> placed_;        // slots of shapes
    IslandLinks links_;
    ContactSet asleep_;
    ContactMover mover_;
    std::size_t count_ = 0, fallen_ = 0, woken_ = 0;
    double since_look_ = 0.0;                  // at islands [s]
    bool any_ready_ = false;                   // some body has been still for long enough
    bool sizes_known_ = false;
    bool roles_changed_ = false;               // boxes and filters are those of other roles
    bool contacts_wait_ = false;               // for give_back()
};

}  // namespace carom::dynamics
