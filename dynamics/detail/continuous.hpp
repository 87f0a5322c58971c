// The continuous stage: bodies that moved far are followed along the paths that the solver gave them, and meet what is in their way.
//
//   continuous.prepare(slots, free);                 // before the free bodies move
//   continuous.depart(slot, state); ...; continuous.arrive(slot, state);
//   if (continuous.look(scene)) continuous.run(scene);   // after everybody has moved
//
// continuous.cpp has the bodies and their paths, continuous_near.cpp who is near one, continuous_search.cpp when two meet, continuous_events.cpp what comes of it.
//
// Impacts come in the order of their times. At each the two bodies get new velocities and new paths for the rest of the step, and all that is near these is
// asked for again: of the broadphase, and of those that have left the boxes it knows (strays).
//
// What touches at the start of a path is the solver's, or has just been struck. Of such a pair one is thinned until they are apart, and watched as what is left
// of it: no pair goes much deeper than it is without a blow. docs/continuous.md has the promise and its proof.
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/dynamics/continuous_settings.hpp>
#include <carom/dynamics/detail/body_path.hpp>
#include <carom/dynamics/detail/body_sizes.hpp>
#include <carom/dynamics/detail/course_table.hpp>
#include <carom/dynamics/detail/first_chance.hpp>
#include <carom/dynamics/detail/first_touch.hpp>
#include <carom/dynamics/detail/grouped_boxes.hpp>
#include <carom/dynamics/detail/least_shift.hpp>
#include <carom/dynamics/detail/meeting.hpp>
#include <carom/dynamics/detail/path_touch.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/step_paths.hpp>
#include <carom/dynamics/step_report.hpp>
#include <carom/narrowphase/collide.hpp>

#include <cstdint>
#include <deque>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace carom::dynamics {

/// What the stage sees of the world, whose bodies have moved.
struct ContinuousScene {
    const ProxySet& proxies;
    const Broadphase& broadphase;
    BodyArrays& bodies;
    double dt = 0.0;
    Executor& executor;
    FunctionRef<const Pose&(std::uint32_t slot)> start;             ///< of the principal frame, at the start of the step
    FunctionRef<const dvec3&(std::uint32_t slot)> start_velocity;
    FunctionRef<FreeMotion(std::uint32_t slot)> free_motion;
    FunctionRef<bool(std::uint32_t a, std::uint32_t b)> parted;     ///< by a joint: they do not meet
    FunctionRef<void(std::uint32_t slot)> wake;
};

/// Shapes, by their proxies; A has mass, if any of the two has.
struct SweptPair {
    std::uint32_t a = 0, b = 0;
};
/// @return the two in the order in which they are looked at: A is what is thinned. Of two with mass that is the thicker one, of which more is
/// left, but a mesh only if both are.
[[nodiscard]] SweptPair swept_order(const ProxySet& proxies, const std::vector<Role>& roles, std::uint32_t p, std::uint32_t q);
/// @return the smallest extent of the smaller one [m].
[[nodiscard]] double swept_size(const ProxySet& proxies, const SweptPair& pair);
/// @return how finely the path of a body is cut.
[[nodiscard]] PathSettings path_settings(const BodySize& size, double dt);
inline constexpr double kSweepToleranceShare = 1e-4;  // of the smallest extent: how near a search comes
inline constexpr int kLevelOfContacts = 4;  // at which contacts of the solver are watched
inline constexpr double kSweepRoomShare = 2.0 * kSweepToleranceShare;  // likewise: nearer than that nothing is without a chance to touch

class Continuous {
public:
    explicit Continuous(const ContinuousSettings& settings) : settings_(settings) {}

    /// A body came to the slot.
    void begin(std::uint32_t slot, Continuity continuity);
    [[nodiscard]] Continuity continuity(std::uint32_t slot) const noexcept { return slot < wishes_.size() ? wishes_[slot] : Continuity::Automatic; }
    /// The shapes of some body are others.
    void note_shapes() noexcept { sizes_known_ = false; }

    /// Before the step's bodies move by themselves: those in the slots `free`, of which different ones may then depart() and arrive() on different threads.
    void prepare(std::size_t slots, std::span<const std::uint32_t> free);
    void depart(std::uint32_t slot, const BodyState& state) noexcept { departures_[departure_of_slot_[slot]].start = state; }
    void arrive(std::uint32_t slot, const BodyState& state) noexcept { departures_[departure_of_slot_[slot]].end = state.pose.position; }
    /// Gives memory back where much more is held than the last step needed (room.hpp).
    void trim();
    [[nodiscard]] std::size_t memory() const noexcept;

    /// @return whether any body is to be followed. Cost: a few comparisons a body.
    [[nodiscard]] bool look(const ContinuousScene& scene);
    void run(const ContinuousScene& scene);
    [[nodiscard]] const ContinuousCounts& counts() const noexcept { return counts_; }
    /// Slots of the bodies that the last run() put elsewhere than where they had come.
    [[nodiscard]] std::span<const std::uint32_t> displaced() const noexcept { return displaced_; }

    /// Writes down how the bodies of a step moved, before run(), which adds what they meet, and after look(), if that is called at all.
    void record(const ContinuousScene& scene, StepPaths& paths);
    /// Whether the two came so little way against each other that neither's middle can have come to where the other was not near: as in a crowd that falls.
    [[nodiscard]] bool keep_company(const ContinuousScene& scene, std::uint32_t slot_a, std::uint32_t slot_b) const;

private:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};
    [[nodiscard]] static bool moves(Role role) noexcept { return role == Role::Dynamic || role == Role::Kinematic; }
    static constexpr double kSlowShare = 0.01;  // of the smallest extent, in a step: slower is no impact
    static constexpr double kSlowedTurn = 0.99 * kMostTurn;  // in a step: what spins faster is slowed down to that [rad]

    /// A body that moved by itself, and so along a path that is known.
    struct Departure {
        BodyState start;
        dvec3 end{0.0};
        std::uint32_t slot = 0;
    };
    /// Of the body, where it moved by itself in this step; otherwise null.
    [[nodiscard]] const Departure* departure_of(std::uint32_t slot) const noexcept {
        const std::uint32_t number = slot < departure_of_slot_.size() ? departure_of_slot_[slot] : kNone;
        return number < departures_.size() && departures_[number].slot == slot ? &departures_[number] : nullptr;
    }
    /// A body that is followed, or that is near one.
    struct Mover {
        std::uint32_t slot = 0;
        Flight flight;
        double since = 0.0;     ///< when the flight began
        bool flies = false;     ///< along `flight`; else along a chord, or not at all
        bool changed = false;   ///< by an impact
        bool stopped = false;   ///< where it had its last impact, until the step is over; unless something carries it
        bool crushed = false;   ///< nothing carries it any more
        bool slides = false;    ///< along `slide`, out of the way of something kinematic or of what that carries; it has no carrier then
        std::uint32_t carrier = kNone;  ///< a kinematic mover, along with which it goes since `since`
        dvec3 slide{0.0};       ///< [m] in a whole step
        int ways = 0;           ///< that it went, but for the first that carried it
        int impacts = 0;        ///< in sixteenths; a chord that is laid anew is none
        std::uint32_t version = 0;
        Ride ride;              ///< of what is carried
        BodyPath path;
        Course course;              ///< the path at a glance
    };
    /// What comes of an event to a body.
    struct Outcome {
        BodyState state;
        StopCause stop = StopCause::None;
        int account = 0;                ///< what goes to it, in sixteenths
        std::uint32_t carrier = kNone;  ///< along with which it goes, if it is stopped
        std::optional<dvec3> slide{};   ///< by which it goes, if it is: [m] in a whole step
    };
    /// Where one that is carried can go on.
    struct Way {
        dvec3 shift{0.0};               ///< until the step is over [m]
        std::uint32_t carrier = kNone;  ///< along with which it goes; kNone: it slides
    };
    struct Choice {
        std::uint32_t number = 0;  ///< of the mover
        Way way;
    };
    /// A point that something has in common with what stands in its way, and the planes that it has to stay before.
    struct Obstacle {
        dvec3 at{0.0};
        std::uint32_t carrier = kNone;  ///< that drives the other
        ShiftBound now, end;
    };
    using Pair = SweptPair;
    struct Event {
        double t = 0.0;
        Pair pair;
        int level = 0;
        std::uint32_t version_a = 0, version_b = 0;  ///< of the movers
        Impact impact;
        double bend = 0.0;  ///< of the two paths [m]

        /// A total order: first by time.
        static bool later(const Event& x, const Event& y) noexcept {
            return std::tie(x.t, x.pair.a, x.pair.b, x.level) > std::tie(y.t, y.pair.a, y.pair.b, y.level);
        }
    };

    /// Two that may meet from `t` on, by first_chance(): their time of impact is asked for when everything earlier has happened, if neither has been struck until then.
    struct Chance {
        double t = 0.0, from = 0.0;
        Pair pair;
        std::uint32_t version_a = 0, version_b = 0;  ///< of the movers

        static bool later(const Chance& x, const Chance& y) noexcept { return std::tie(x.t, x.pair.a, x.pair.b) > std::tie(y.t, y.pair.a, y.pair.b); }
    };

    void list_bodies(const ContinuousScene& scene);
    [[nodiscard]] bool has_plane(const ContinuousScene& scene, std::uint32_t slot) const;
    /// How far a point of a body may have come, and what is left to contacts [m].
    [[nodiscard]] double way_of(const ContinuousScene& scene, std::uint32_t slot) const;
    [[nodiscard]] double limit_of(const ContinuousScene& scene, std::uint32_t slot) const;
    /// Whether it moves along the integrator's path.
    [[nodiscard]] bool flies(const ContinuousScene& scene, std::uint32_t slot) const;
    [[nodiscard]] FollowFinding finding_of(const ContinuousScene& scene, std::uint32_t slot) const;
    [[nodiscard]] bool is_fast(const ContinuousScene& scene, std::uint32_t slot) const;
    /// Of a body that contacts made spin too fast. @return whether it can be followed then.
    bool slow_down(const ContinuousScene& scene, std::uint32_t slot);
    /// Of one that was struck, whose moments let it spin faster than it did then.
    void slow_at_end(const ContinuousScene& scene, BodyState& state);
    void list_strays(const ContinuousScene& scene);
    /// Of a stray, or of what has become one.
    void note_way(const ContinuousScene& scene, std::uint32_t slot, const BodyPath& path);
    [[nodiscard]] bool goes_astray(const ContinuousScene& scene, std::uint32_t slot) const;

    std::uint32_t mover_of(const ContinuousScene& scene, std::uint32_t slot);
    void lay_path(const ContinuousScene& scene, Mover& mover) const;
    /// @return what of the pull on a body that the solver moved made it faster [m/s²].
    [[nodiscard]] dvec3 pull_on(const ContinuousScene& scene, std::uint32_t slot) const;
    [[nodiscard]] BodyState state_at(const ContinuousScene& scene, const Mover& mover, double t) const;

    /// Whom the broadphase is asked for; planes and strays are visited in any case.
    enum class Ask : unsigned char { Everybody, StraysOnly };
    /// Each once. @param from, to  when; in a crowd what is not near then is passed over. @param near  a scratch list.
    void for_each_near(const ContinuousScene& scene, const Mover& mover, std::uint32_t proxy, Ask ask, double from, double to, std::vector<std::uint32_t>& near,
                       FunctionRef<void(std::uint32_t q)> visit) const;
    /// Pairs that the broadphase found for this step hold for who stayed in his boxes; who strayed asks anew.
    void search_from_start(const ContinuousScene& scene);
    /// Those of the broadphase's pairs with somebody fast and nobody astray, in parts that follow each other.
    void list_fast_pairs(const ContinuousScene& scene, std::span<const ProxyPair> found);
    /// Whether so much is fast, and goes so far, that asking who is where and when is less work than asking for boxes, if it is asked often.
    [[nodiscard]] bool may_crowd(const ContinuousScene& scene) const;
    /// Whether it is less for who is fast when the step begins.
    [[nodiscard]] bool crowds_at_start(const ContinuousScene& scene, bool complete) const;
    void list_courses(const ContinuousScene& scene);
    /// keep_company() of the rest of a step, by the velocities that the two have now.
    [[nodiscard]] bool stay_together(const ContinuousScene& scene, std::uint32_t slot_a, std::uint32_t slot_b) const;
    [[nodiscard]] bool may_meet(const ContinuousScene& scene, std::uint32_t p, std::uint32_t q) const;
    /// Of somebody who begins a path: who is near it, but for the body in the slot `skip`.
    struct Around {
        std::uint32_t mover = 0, skip = kNone;
    };
    void search_around(const ContinuousScene& scene, std::span<const Around> around, double from);
    void search_all(const ContinuousScene& scene, std::uint32_t mover, double from, std::uint32_t skip) {
        const Around one{mover, skip};
        search_around(scene, {&one, 1}, from);
    }
    /// Those who are fast when the step begins, with those who do not ask themselves.
    void search_first(const ContinuousScene& scene, bool all_ask);
    /// Searches in order those who may meet at once, and expects the others when it comes to that.
    void search_some(const ContinuousScene& scene, std::span<const Pair> pairs, double from);
    [[nodiscard]] double first_chance_of(const ContinuousScene& scene, const Pair& pair, double from) const;
    void take_chance(const ContinuousScene& scene);
    [[nodiscard]] PathSearch search_of(const ContinuousScene& scene, const Pair& pair, double from, int level);
    /// @param earliest  of the times that the search may find; they are not touching before.
    void search(const ContinuousScene& scene, const Pair& pair, double from, int level, double earliest = 0.0);
    void take_answer(const ContinuousScene& scene, const Pair& pair, const PathSearch& answer, bool met, double earliest);
    /// Two that are looked at together with others: many threads look, and one takes the answers in their order.
    struct Probe {
        Pair pair;
        std::uint32_t version_a = 0, version_b = 0;  ///< of the movers
        double chance = 0.0;
        bool met = false;
        std::optional<PathSearch> answer{};          ///< of those who may meet at once, unless who takes it is to ask
    };
    void look_together(const ContinuousScene& scene, std::span<Probe> probes, double from);
    void look(const ContinuousScene& scene, Probe& probe, double from);
    void take(const ContinuousScene& scene, const Probe& probe, double from);
    [[nodiscard]] bool is_current(const ContinuousScene& scene, const Pair& pair, std::uint32_t version_a, std::uint32_t version_b) const;
    [[nodiscard]] Pair order(const ContinuousScene& scene, std::uint32_t p, std::uint32_t q) const {
        return swept_order(scene.proxies, scene.bodies.roles, p, q);
    }
    [[nodiscard]] double size_of(const ContinuousScene& scene, const Pair& pair) const { return swept_size(scene.proxies, pair); }
    void search_deeper(const ContinuousScene& scene, const Pair& pair, double from, int level);
    [[nodiscard]] bool overlap_at_start(const ContinuousScene& scene, const Pair& pair, int level);

    void resolve(const ContinuousScene& scene, const Event& event);
    void find_points(const ContinuousScene& scene, const Event& event, const BodyState& a, const BodyState& b);
    void part(const ContinuousScene& scene, const Event& event, Pose& a, Pose& b);
    /// The share of a shift after which the middle of a body is at anybody's but `partner`'s.
    [[nodiscard]] double room_for(const ContinuousScene& scene, std::uint32_t slot, std::uint32_t partner, double t, const Pose& from, const dvec3& shift);
    void strike(const ContinuousScene& scene, std::uint32_t mover, double t, const Outcome& outcome);

    /// Two that are stopped or cannot be struck, of which something kinematic brings one against the other.
    void carry(const ContinuousScene& scene, const Event& event);
    /// Whether it stands, and would go along with the other.
    [[nodiscard]] bool may_ride(const ContinuousScene& scene, std::uint32_t slot) const;
    [[nodiscard]] bool can_board(const ContinuousScene& scene, std::uint32_t mover, std::uint32_t other) const;
    /// One that is stopped goes with the other from now on, or is crushed against it.
    void join(const ContinuousScene& scene, std::uint32_t mover, std::uint32_t other, double t, const BodyState& state);
    void crush(const ContinuousScene& scene, std::uint32_t mover, double t, const BodyState& state);
    /// Whether it moves on though it cannot be struck.
    [[nodiscard]] bool goes_on(const ContinuousScene& scene, std::uint32_t mover) const;
    [[nodiscard]] bool stands_in_the_way(const ContinuousScene& scene, std::uint32_t mover) const;
    void add_obstacle(const ContinuousScene& scene, std::uint32_t other, double t, const dvec3& at, const dvec3& normal);
    void list_obstacles(const ContinuousScene& scene, std::uint32_t mover, std::uint32_t other, double t, const BodyState& state);
    /// @param side  of meeting_.points: by which their normals point from the other to this one.
    [[nodiscard]] std::optional<Way> find_way(const ContinuousScene& scene, std::uint32_t mover, std::uint32_t other, double t,
                                              const BodyState& state, double side);
    /// @return whether either of two that meet, by meeting_.points, can go elsewhere: then `choice` is who, and where.
    [[nodiscard]] bool choose_way(const ContinuousScene& scene, std::uint32_t a, std::uint32_t b, double t, Choice& choice);
    void take_way(const ContinuousScene& scene, const Choice& choice, double t, const BodyState& state);
    /// What goes along with a mover that goes on.
    [[nodiscard]] std::uint32_t carrier_of(const ContinuousScene& scene, std::uint32_t mover) const;
    /// Whether the two go along with the same.
    [[nodiscard]] bool go_together(const ContinuousScene& scene, std::uint32_t a, std::uint32_t b) const;
    /// How it goes, whatever velocity it will have when the step is over.
    [[nodiscard]] BodyState motion_at(const ContinuousScene& scene, const Mover& mover, double t) const;
    [[nodiscard]] bool come_nearer(const ContinuousScene& scene, const Event& event);
    void note_leg(std::uint32_t mover, double end);
    void note_stop(const Mover& mover, double t, StopCause cause);
    void note_impact(const ContinuousScene& scene, const Event& event, bool blow);

    ContinuousSettings settings_;
    ContinuousCounts counts_;
    std::vector<Continuity> wishes_;           // by slot; only as far as a body wished for any
    std::vector<BodySize> sizes_;              // by slot
    std::vector<std::uint32_t> first_proxy_;   // by slot, and one more: in proxies_
    std::vector<std::uint32_t> proxies_;       // of all bodies
    double smallest_ = 0.0;                    // extent of a dynamic body [m]
    bool sizes_known_ = false;
    std::vector<Departure> departures_;        // at rest there are few
    std::vector<std::uint32_t> departure_of_slot_;  // of those that have one; of others any number

    std::vector<std::uint32_t> fast_;          // slots
    std::vector<unsigned char> is_fast_;       // by slot
    std::vector<std::uint32_t> strays_;        // slots
    GroupedBoxes stray_boxes_;                 // that their ways lie in; bodies of neighbouring slots mostly are near each other
    std::vector<std::uint32_t> number_of_stray_;  // by slot: in these
    std::vector<unsigned char> is_stray_;      // by slot
    std::vector<std::uint32_t> mover_of_slot_;
    bool crowd_ = false, no_crowd_ = false;    // the latter: it was looked at, and is none
    std::size_t looks_ = 0;                    // around movers, until that is known
    CourseTable courses_;                      // of proxies_
    struct alignas(64) Finder {                // what one thread finds
        std::vector<std::uint32_t> near;
        std::vector<Pair> pairs;
    };
    std::vector<Finder> finders_;
    std::vector<Probe> probes_;                // unless somebody has it
    std::vector<std::uint32_t> at_once_;       // of these
    struct alignas(64) FastPairs {             // what one thread found
        std::vector<Pair> pairs;
    };
    std::vector<FastPairs> fast_pairs_;
    std::deque<Mover> movers_;
    Mover shifted_;                            // looks for room
    BodyPath standing_;                        // of whom it may meet
    std::vector<std::uint32_t> displaced_;
    Uses runs_;
    std::size_t mover_count_ = 0;              // those beyond keep their memory
    std::vector<Event> events_;                // a heap
    std::vector<Chance> chances_;              // likewise
    std::int64_t budget_ = 0;                  // impacts that are left in this step
    std::int64_t pieces_left_ = 0;
    std::size_t most_pairs_ = 0;
    std::size_t most_chances_ = 0;
    std::size_t chance_count_ = 0;             // of this step
    Meeting meeting_;
    std::vector<Manifold> manifolds_;
    std::vector<Obstacle> obstacles_;
    Cores cores_;
    StepPaths* paths_ = nullptr;               // null: nothing is written down
};

}  // namespace carom::dynamics
