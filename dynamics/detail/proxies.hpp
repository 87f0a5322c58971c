// Shapes as the step sees them. A proxy's number is its shape's slot, so one that comes, goes or changes touches no other.
//
//   put_proxy(proxies, proxy, filter);  drop_proxy(proxies, slot);
//   update_swept_bounds(proxies, bodies, motion, executor);
//   broadphase.update({proxies.boxes, proxies.filters, proxies.moved, proxies.removed}, executor);
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/ids.hpp>
#include <carom/core/pose.hpp>
#include <carom/dynamics/detail/body_state.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/part_surface.hpp>
#include <carom/dynamics/detail/scratch_pool.hpp>
#include <carom/narrowphase/collide.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace carom::dynamics {

/// What a body may do in this step. Quarantined bodies and empty slots are Absent; dynamic bodies that sleep are Asleep.
enum class Role : unsigned char { Absent, Static, Kinematic, Dynamic, Asleep };

/// Whether a body has mass, awake or not.
[[nodiscard]] constexpr bool has_mass(Role role) noexcept { return role == Role::Dynamic || role == Role::Asleep; }

/// Whether a box stays as it is until it is stale.
[[nodiscard]] constexpr bool lies_still(Role role) noexcept { return role == Role::Static || role == Role::Asleep; }

/// @return Absent for a value that is no BodyType.
[[nodiscard]] constexpr Role role_of(BodyType type) noexcept {
    switch (type) {
        case BodyType::Static: return Role::Static;
        case BodyType::Kinematic: return Role::Kinematic;
        case BodyType::Dynamic: return Role::Dynamic;
    }
    return Role::Absent;
}

/// A pose that is mostly none: one that is takes no memory.
class LocalPose {
public:
    LocalPose() = default;
    explicit LocalPose(const Pose& pose) : pose_(std::memcmp(&pose, &kNone, sizeof(Pose)) == 0 ? nullptr : std::make_unique<const Pose>(pose)) {}
    LocalPose(const LocalPose& other) : pose_(other.pose_ == nullptr ? nullptr : std::make_unique<const Pose>(*other.pose_)) {}
    LocalPose(LocalPose&&) noexcept = default;
    LocalPose& operator=(LocalPose other) noexcept {
        pose_.swap(other.pose_);
        return *this;
    }
    ~LocalPose() = default;

    [[nodiscard]] const Pose& get() const noexcept { return pose_ == nullptr ? kNone : *pose_; }
    /// [bytes], beside itself.
    [[nodiscard]] std::size_t memory() const noexcept { return pose_ == nullptr ? 0 : sizeof(Pose); }

private:
    static_assert(sizeof(Pose) == 7 * sizeof(double), "no bytes that mean nothing: zeros of either sign are told apart");
    static constexpr Pose kNone{};
    std::unique_ptr<const Pose> pose_;
};

struct Proxy {
    Shape shape;                   ///< a copy, which stays valid whatever comes and goes; what is large in it is shared
    LocalPose local;               ///< of the shape in its body's principal frame
    double reach = 0.0;            ///< farthest point from the centre of mass [m]
    Resistance resistance;
};

/// One that comes, with what ProxySet keeps of it in lists of their own.
struct NewProxy : Proxy {
    ShapeId id;
    BodyId owner;
    double extent = 0.0;           ///< smallest extent of the shape [m]
    Surface surface;
};

/// Bodies of a step, all indexed by slot.
struct BodyArrays {
    std::vector<BodyState> states;
    std::vector<BodyMass> masses;
    std::vector<Role> roles;
    std::vector<BodyTraits> traits;  ///< empty while no body asks for any or has locked axes, which costs nothing then
    std::vector<Pose> principals;    ///< of principal frames in their bodies' own; empty while no body has another than its own

    [[nodiscard]] Pose principal(std::size_t slot) const noexcept { return principals.empty() ? Pose{} : principals[slot]; }
    void set_principal(std::size_t slot, const Pose& frame) {
        if (principals.empty() && frame == Pose{}) return;
        if (principals.size() < states.size()) principals.resize(states.size());
        principals[slot] = frame;
    }

    /// @return what pulls a dynamic body beside its contacts [m/s²].
    [[nodiscard]] dvec3 acceleration(std::size_t slot, const dvec3& gravity) const noexcept {
        if (traits.empty()) return gravity;
        return gravity * traits[slot].gravity_scale + traits[slot].force * masses[slot].inverse_mass;
    }
    /// @return the same along the axes that are not locked.
    [[nodiscard]] dvec3 pull(std::size_t slot, const dvec3& gravity) const noexcept {
        return free_moves(masses[slot].locked) * acceleration(slot, gravity);
    }
};

/// Whose shape stands at a slot.
struct ProxyOwner {
    ShapeId shape;
    BodyId body;
};

/// What the solver wants to know of a shape.
struct ProxySurface {
    Surface surface;
    const Compound* compound = nullptr;  ///< whose parts may have surfaces of their own
    bool is_ball = false;                ///< a sphere about the centre of mass: it looks the same however it turns
};

/// @param part  as Manifold names it.
[[nodiscard]] inline Surface surface_of_part(const ProxySurface& surface, std::uint16_t part) noexcept {
    return surface_of_part(surface.surface, surface.compound, part);
}

/// Where a body was when the box of its shape was made for more than a step, and how far the shape's points may come from there until it has to be made anew.
struct Anchor {
    dvec3 position{0.0};
    dquat orientation = kIdentityRotation;
    double room = -1.0;  ///< [m]; negative: the box is of one step
    double pull = 0.0;   ///< what forces may do in a step, beside the room [m]
};

/// What stands at a slot.
enum class ProxyKind : unsigned char { None, Bounded, Plane };

/// All vectors but `planes`, `moved` and `removed` go by slot, and of one size.
struct ProxySet {
    std::vector<Proxy> by_slot;
    std::vector<ProxyKind> kinds;
    std::vector<ProxyFilter> filters;     ///< movable: of a dynamic body
    std::vector<FloatAabb> boxes;         ///< of bounded proxies, over the predicted motion, relative to `origin`
    std::vector<Pose> poses;              ///< in the world
    std::vector<const Shape*> shapes;     ///< null: the slot is free
    std::vector<std::uint32_t> bodies;    ///< slots of the owners
    std::vector<ProxySurface> surfaces;
    std::vector<ProxyOwner> owners;       ///< what contacts name: beside each other, which Proxies are not
    std::vector<double> extents;          ///< smallest ones [m]
    std::vector<double> motion;           ///< of bounded proxies: how far any point may move in the step [m]
    std::vector<unsigned char> stale;     ///< 1: came or changed since the last update: the box must be made anew although the body is static
    std::vector<unsigned char> listed;    ///< 1: the broadphase has a box of this slot
    std::vector<std::uint32_t> versions;  ///< how many proxies have stood there
    std::vector<unsigned char> boxlike;   ///< 1: a box, whose contacts with others are found anew as fast as they are carried along
    std::vector<unsigned char> bounces;   ///< 1: contacts with it may have restitution; that of two shapes that are 0 here has none
    std::vector<double> firmness;         ///< 1: faces, edges and corners; less where the shape is curved, and the normal of a contact turns as it moves
    std::vector<Anchor> anchors;
    std::vector<unsigned char> calm;      ///< 1: the box is the one of the update before, and holds the shape through this step as well
    std::vector<double> drift;            ///< of what is calm: how far a point may have come from where it was at its anchor [m]; 0 of what lies still
    std::vector<double> stay;             ///< of what has room: how far it may come before it is looked at again, less what forces do in a step; else 0 [m]
    std::vector<double> way;              ///< of what has room: how far any point may move in the step, which is less than `motion` [m]
    std::vector<std::uint32_t> rollers;   ///< slots of capsules, cylinders and cones about an axis through the centre of mass that are all their body has; as of the last update
    std::vector<std::uint32_t> planes;    ///< slots of the unbounded ones, ascending: the side list
    std::vector<std::uint32_t> moved;     ///< slots whose boxes the last update made anew, ascending
    std::vector<std::uint32_t> removed;   ///< slots that the broadphase has to let go
    dvec3 origin{0.0};                    ///< of the boxes
    bool changed = false;                 ///< proxies came or went since the last update

    [[nodiscard]] std::size_t memory() const noexcept;
};

/// Puts a proxy at its shape's slot, in place of what is there. Amortised O(1), but for planes, which are kept sorted.
void put_proxy(ProxySet& set, NewProxy proxy, const ProxyFilter& filter);
/// Frees a slot; nothing where it is free.
void drop_proxy(ProxySet& set, std::uint32_t slot);

/// @return whether each of the two has a layer that the other meets.
[[nodiscard]] inline bool filters_agree(const ProxyFilter& a, const ProxyFilter& b) noexcept { return (a.layer & b.mask) != 0 && (b.layer & a.mask) != 0; }

/// Predicted motion of a step.
struct Motion {
    dvec3 gravity{0.0};
    double dt = 0.0;
};

/// What is calm: it moves little, and its box is made for longer than a step.
struct CalmRule {
    double share = 0.0;  ///< of its smallest extent, how far it may come until the box is made anew; 0: nothing is calm but what lies still
    double most_closing = std::numeric_limits<double>::infinity();  ///< how fast two of the calm may close in on each other, over what pulls a body in a step
};

/// Boxes around the predicted motion: v dt along the velocity, |g| dt² + r min(|w| dt, 2) all round.
/// Fills in boxes, poses, shapes, motion, moved and removed: the boxes of what moves, came or was changed, and no others.
///
/// The origin is the middle of the dynamic bodies, about which float boxes lose least. It is chosen anew, and every box with it, only
/// when something came or went and the middle has left the origin by more than the size of the whole scene: until then floats round as
/// they would for a scene twice as large.
///
/// What moves in a step by less than a share of its smallest extent gets a box with so much room that it need not be made anew, nor given to
/// the broadphase, until a point has come that far from where it was: `calm`. Its `motion` says how far it may come from where it is by then.
void update_swept_bounds(ProxySet& set, const BodyArrays& bodies, const Motion& motion, const CalmRule& rule, Executor& executor);

/// Notes that the broadphase took over `moved` and `removed`, or that it did not: then the next update lists them again.
void note_listed(ProxySet& set) noexcept;
void note_refused(ProxySet& set) noexcept;
/// Notes that the broadphase was cleared: the next update lists all.
void note_cleared(ProxySet& set) noexcept;

/// @return how far a plane's surface may come towards a body about `point` in the step, by its own motion [m].
[[nodiscard]] double plane_motion(const BodyState& plane, const dvec3& point, double reach, double dt) noexcept;

/// The same of a plane's slot, towards the body of another.
[[nodiscard]] double motion_of_plane(const ProxySet& set, const BodyArrays& bodies, std::uint32_t plane, std::uint32_t other, double dt) noexcept;

/// @return the gap between the box of a bounded slot and how far the surface of a plane may come to it in the step [m]; 0 or less makes
/// them a pair.
[[nodiscard]] double gap_over_plane(const ProxySet& set, const BodyArrays& bodies, std::uint32_t bounded, std::uint32_t plane,
                                    double dt) noexcept;

/// What each thread listed of some slots; kept so that nothing is allocated.
struct alignas(64) CandidatePart {
    std::vector<NumberedPair> pairs;
};
using CandidateParts = std::vector<CandidatePart>;

/// Joins the broadphase's pairs, sorted by (a, b), and the pairs with planes into one list, sorted by key: the candidates for the
/// narrowphase, by slots. The margin is how far the two may close in the step, at most a quarter of the smaller shape's smallest
/// extent: contacts predicted from farther away would stop bodies that only pass by; and beside it, where both have room or lie still, what they may move
/// until they are looked at again. Otherwise that is in the next step.
void list_candidates(const ProxySet& set, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt, Executor& executor,
                     CandidateParts& parts, ScratchList<NumberedPair>& out);

/// After the step: what it listed of two slots, by a < b but for planes, which come last. Steps keep no list of them.
/// @return nothing where they were no candidate.
[[nodiscard]] std::optional<NumberedPair> find_candidate(const ProxySet& set, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt,
                                                         std::uint32_t a, std::uint32_t b);

/// @return how far the two may have come together from where their boxes were made before their contact is looked at again: `share` of the smaller shape's
/// smallest extent, less of a curved one's [m].
[[nodiscard]] inline double most_drift(const ProxySet& set, const NumberedPair& pair, double share) noexcept {
    return share * std::min(set.extents[pair.a] * set.firmness[pair.a], set.extents[pair.b] * set.firmness[pair.b]);
}

/// What tells a candidate of one step in the next: its key, and which proxies stood at the two slots.
struct CandidateName {
    std::uint64_t key = 0;
    std::uint32_t version_a = 0, version_b = 0;
};

/// Those of a step, and of the step before; kept so that nothing is allocated.
struct CandidateNames {
    std::vector<CandidateName> now, before;
};

/// Numbers each candidate by the same pair of the same two shapes in the step before, and gives it the slack `share` times the smaller
/// shape's smallest extent, but for two boxes, and for what bounces and is not calm: a contact ahead of its time would slow it down.
/// @return whether there are any but those: otherwise nothing is numbered.
[[nodiscard]] float slack_of(const ProxySet& set, double share, const NumberedPair& pair) noexcept;
bool name_candidates(const ProxySet& set, double share, std::span<NumberedPair> candidates, CandidateNames& names, Executor& executor);

/// @return the pair of a candidate.
[[nodiscard]] ContactPair contact_pair(const ProxySet& set, const NumberedPair& candidate) noexcept;

}  // namespace carom::dynamics
