// Shapes as the step sees them: one entry a shape, in the order of the shapes' slots.
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/ids.hpp>
#include <carom/core/pose.hpp>
#include <carom/dynamics/detail/body_state.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/narrowphase/collide.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// What a body may do in this step. Quarantined bodies and empty slots are Absent.
enum class Role : unsigned char { Absent, Static, Kinematic, Dynamic };

/// @return Absent for a value that is no BodyType.
[[nodiscard]] constexpr Role role_of(BodyType type) noexcept {
    switch (type) {
        case BodyType::Static: return Role::Static;
        case BodyType::Kinematic: return Role::Kinematic;
        case BodyType::Dynamic: return Role::Dynamic;
    }
    return Role::Absent;
}

struct Proxy {
    ShapeId id;
    BodyId owner;
    std::uint32_t body = 0;        ///< slot of the owner
    const Shape* shape = nullptr;
    Pose local{};                  ///< of the shape in its body's principal frame
    double reach = 0.0;            ///< farthest point from the centre of mass [m]
    double extent = 0.0;           ///< smallest extent of the shape [m]
    float friction = 0.0f, restitution = 0.0f;
    ProxyFilter filter;            ///< movable: of a dynamic body
};

/// Bodies of a step, all indexed by slot.
struct BodyArrays {
    std::vector<BodyState> states;
    std::vector<BodyMass> masses;
    std::vector<Role> roles;
};

struct ProxySet {
    std::vector<Proxy> bounded;       ///< boxes in the broadphase
    std::vector<Proxy> unbounded;     ///< planes: the side list
    std::vector<FloatAabb> boxes;     ///< of `bounded`, over the predicted motion, relative to `origin`
    std::vector<ProxyFilter> filters; ///< of `bounded`
    std::vector<std::uint32_t> moved; ///< of `bounded`, those whose boxes were made anew
    std::vector<Pose> poses;          ///< of `bounded`, in the world
    std::vector<double> motion;       ///< of `bounded`: how far any point may move in the step [m]
    dvec3 origin{0.0};                ///< of the boxes
    bool static_boxes_stale = true;   ///< static bodies' boxes must be made anew
};

/// Predicted motion of a step.
struct Motion {
    dvec3 gravity{0.0};
    double dt = 0.0;
};

/// Boxes around the predicted motion: v dt along the velocity, |g| dt² + r min(|w| dt, 2) all round.
/// Fills in boxes, poses, motion and moved.
void update_swept_bounds(ProxySet& proxies, const BodyArrays& bodies, const Motion& motion, Executor& executor);

/// @return the middle of the dynamic shapes: the origin about which float boxes lose least.
[[nodiscard]] dvec3 middle_of_motion(const ProxySet& proxies, const BodyArrays& bodies);

/// @return how far a plane's surface may come towards a body about `point` in the step, by its own motion [m].
[[nodiscard]] double plane_motion(const BodyState& plane, const dvec3& point, double reach, double dt) noexcept;

/// Joins the broadphase's pairs, sorted by (a, b), and the pairs with planes into one list, sorted by key.
void gather_pairs(const ProxySet& proxies, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt,
                  std::vector<ContactPair>& pairs);

/// Lists the pairs with poses and margins for the narrowphase. The margin is how far the two may close in the step, at most a
/// quarter of the smaller shape's smallest extent: contacts predicted from farther away would stop bodies that only pass by.
void list_shape_pairs(const ProxySet& proxies, const BodyArrays& bodies, std::span<const ContactPair> pairs, double dt,
                      Executor& executor, std::vector<ShapePair>& out);

/// @return proxy `index` of a pair: planes are numbered after the bounded ones.
[[nodiscard]] inline const Proxy& proxy_at(const ProxySet& proxies, std::uint32_t index) noexcept {
    return index < proxies.bounded.size() ? proxies.bounded[index] : proxies.unbounded[index - proxies.bounded.size()];
}

}  // namespace carom::dynamics
