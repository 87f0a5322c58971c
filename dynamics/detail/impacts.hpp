// Impacts of what bounces, each at its own time inside the step and at the velocity it has there.
//
//   impacts.run(contacts, proxies, bodies, {gravity, dt});   // before the solver: new velocities, and pairs that nothing else holds
//   ... the solver and the free bodies take the step ...
//   impacts.place(bodies);                                   // where the impacts' times put the bodies
//
// An impulse J at the time t of a step takes a body to where it would be had it begun the step with the velocity v + J/m at the place
// x - t J/m. So an impact changes the velocity that the step begins with, and shifts the body at its end; the path in between is exact.
#pragma once

#include <carom/dynamics/detail/blow.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// Slower than this, over what gravity brings about in a step, is no impact.
inline constexpr double kSlowestImpact = 2.0;

/// Contacts that bounce, in double, on the paths that their bodies take by themselves over the step.
///
/// Impacts come in the order of their times. At each, all points that touch and approach at once form one problem: the least impulses that
/// stop the approach, times 1 + e (Moreau's and Newton's law; for e = 1 a reflection: Smith et al., Reflections on simultaneous impact, 2012,
/// sec. 4). That is repeated while somebody still approaches, so that a cradle sends out as many balls as came in, and what is
/// symmetric stays so. Energy never grows: points of unlike e that would gain some bounce by the least e among them. Friction follows each normal
/// impulse within its cone, against the sliding, at most to a stop.
///
/// Two balls that overlap and approach at the start met before, unseen (contacts are found as far ahead as the two move by themselves; a chain of
/// bodies at rest is found link by link, one a step): their impact is placed there, at most eight steps back.
///
/// Slower than twice what gravity brings about in a step is no impact: the solver's contacts take it up.
class Impacts {
public:
    /// Gives the bodies the velocities after their impacts. Marks ContactPair::flies, and lists in ContactSet::flying, where the two only pass or bounce off each other, and nothing else
    /// holds either of them: they are not the solver's.
    /// @param jointed  by slot: 1 for bodies that joints hold; empty where there are none.
    void run(ContactSet& contacts, const ProxySet& proxies, BodyArrays& bodies, const Motion& motion, std::span<const unsigned char> jointed);
    /// Marks the bodies that place() moves, by slot.
    void mark_placed(std::span<unsigned char> by_slot) const noexcept;
    /// Shifts and turns the bodies that had impacts.
    void place(BodyArrays& bodies) const;

    [[nodiscard]] std::size_t count() const noexcept { return count_; }  ///< points that bounced, in the last run
    [[nodiscard]] std::size_t left() const noexcept { return left_; }    ///< contacts whose impacts were too many, left to the solver
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(flyer_of_slot_, flyers_, bouncers_, touching_, events_, frontier_, active_, stack_); }

private:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    /// A body, on its way from the start of the step.
    struct Flyer : BlowBody {
        std::uint32_t slot = 0;
        bool dynamic = false;
        bool held = false;  ///< by a contact that is the solver's
        dvec3 center{0.0};
        dvec3 pull{0.0};             ///< acceleration: none where something supports it
        dvec3 shift{0.0}, turn{0.0}; ///< by impacts so far, as if at the start
        double last = 0.0;           ///< time of its last impact; negative: before the step [s]
        std::uint32_t first = 0, end = 0;  ///< in touching_
        std::uint32_t round = 0;           ///< in which it was last looked at
        dvec3 old_velocity{0.0}, old_spin{0.0};  ///< before the round
        bool hit = false;

        [[nodiscard]] dvec3 path(double time) const noexcept { return shift + (velocity + 0.5 * time * pull) * time; }
    };
    struct Point {
        dvec3 ra{0.0}, rb{0.0};        ///< from the centres of mass, at the start
        double gap = 0.0;              ///< at the start
        dvec3 arm_a{0.0}, arm_b{0.0};  ///< to one common point, at the impact: so that angular momentum is kept
        double mass = 0.0;             ///< felt along the normal
        double drift = 0.0;            ///< of the normal velocity by what pulls the two, from the start to the impact
        double before = 0.0;           ///< normal velocity before the round
        double impulse = 0.0;          ///< that stops the approach
        bool active = false;
    };
    /// A manifold with restitution.
    struct Bouncer {
        std::uint32_t a = 0, b = 0;  ///< flyers
        std::uint32_t pair = 0;
        dvec3 normal{0.0};
        dvec3 between{0.0};  ///< of two spheres: from centre to centre, at the start
        double restitution = 0.0, friction = 0.0;
        double touch = 0.0;    ///< gaps up to this count as touching [m]
        double radius_a = 0.0, radius_b = 0.0;  ///< of spheres; 0: others. The normal of two spheres follows their centres
        std::uint32_t count = 0;
        std::uint32_t version = 0;  ///< of its event
        std::uint32_t round = 0;    ///< in which it was last looked at
        bool two_spheres = false;
        std::array<Point, kMaxManifoldPoints> points{};
    };
    struct Event {
        double time;
        std::uint32_t bouncer, version;
    };

    void list(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies);
    [[nodiscard]] Bouncer make_bouncer(const ContactManifold& manifold, std::span<const ContactPoint> points, const ContactPair& pair, const ProxySet& proxies, const BodyArrays& bodies);
    std::uint32_t flyer_of(std::uint32_t slot, const BodyArrays& bodies);
    void note_support(const ContactSet& contacts) noexcept;
    void link_flyers();

    /// Of two spheres: from centre to centre.
    [[nodiscard]] dvec3 between_at(const Bouncer& bouncer, double time) const noexcept;
    [[nodiscard]] double gap_at(const Bouncer& bouncer, const Point& point, double time) const noexcept;
    [[nodiscard]] double rate_at(const Bouncer& bouncer, const Point& point, double time) const noexcept;
    /// Infinite where there is none within the step.
    [[nodiscard]] double time_of_hit(const Bouncer& bouncer, double from) const noexcept;
    [[nodiscard]] double time_of_hit(const Bouncer& bouncer, const Point& point, double from) const noexcept;
    void push_event(std::uint32_t bouncer, double from);
    void drain();

    /// Impacts at `time` from a bouncer on, round by round, while there is budget. @return whether there was a round.
    bool bounce(std::uint32_t bouncer, double time);
    void gather(double time);
    [[nodiscard]] bool activate(Bouncer& bouncer, double time) const noexcept;
    void reflect();
    void rub(const Bouncer& bouncer, const Point& point) noexcept;
    void commit(double time) noexcept;
    template <class Visit>
    void for_each_active(const Visit& visit);
    [[nodiscard]] dvec3 meeting_velocity(const Bouncer& bouncer, const Point& point) const noexcept;
    [[nodiscard]] double felt_mass(const Bouncer& bouncer, const Point& point, const dvec3& direction) const noexcept;
    void push(const Bouncer& bouncer, const Point& point, const dvec3& impulse) noexcept;

    [[nodiscard]] bool stays_apart(const Bouncer& bouncer, const BodyArrays& bodies) const noexcept;
    void mark_flying(ContactSet& contacts, const BodyArrays& bodies, std::span<const unsigned char> jointed);

    dvec3 gravity_{0.0};
    double dt_ = 0.0;
    double slow_ = 0.0;  ///< approaches up to this are no impacts [m/s]
    std::size_t count_ = 0, left_ = 0;
    std::int64_t budget_ = 0;  ///< looks at contacts and updates of points that are left for this step; a round may overdraw it
    std::uint32_t round_ = 0;
    std::vector<std::uint32_t> flyer_of_slot_;
    std::vector<Flyer> flyers_;
    std::vector<Bouncer> bouncers_;
    std::vector<std::uint32_t> touching_;  // bouncers of each flyer
    std::vector<Event> events_;            // a heap
    std::vector<std::uint32_t> frontier_;  // flyers that a round begins with, and comes to
    std::vector<std::uint32_t> active_;    // bouncers of a round
    std::vector<std::uint32_t> stack_;     // of flyers that something holds
    double now_ = 0.0;      // time of the round
    double fastest_ = 0.0;  // of all bodies [m/s]
};

}  // namespace carom::dynamics
