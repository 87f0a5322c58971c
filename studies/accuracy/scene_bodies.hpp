// The bodies of a world as plain values, so that every engine is given exactly the same ones.
//
//   SceneBodies bodies = scene_bodies(run.world);
#pragma once

#include <carom/dynamics/world.hpp>

#include <vector>

namespace carom::accuracy {

/// A shape that never moves.
struct FixedShape {
    Shape shape;
    Pose pose;              ///< in the world
    double friction = 0.0;  ///< two combine by the geometric mean
    double restitution = 0.0;
};

/// A dynamic body of one shape, given in the frame of its mass: origin at the centre of mass, axes along the principal ones.
/// Engines that want a diagonal inertia about the body's origin need nothing more.
struct MovingBody {
    Shape shape;
    Pose shape_in_mass;         ///< the shape's frame, which is also the frame of Carom's body, in the frame of the mass
    Pose pose;                  ///< of the frame of the mass, in the world
    double mass = 0.0;          ///< [kg]
    dvec3 moments{0.0};         ///< principal moments of inertia [kg m²]
    dvec3 linear_velocity{0.0};   ///< of the centre of mass [m/s]
    dvec3 angular_velocity{0.0};  ///< world axes [rad/s]
    double friction = 0.0;
    double restitution = 0.0;
};

struct SceneBodies {
    dvec3 gravity{0.0};  ///< [m/s²]
    std::vector<FixedShape> fixed;
    std::vector<MovingBody> moving;  ///< in order of creation
};

/// Reads a world through its public interface.
/// @param world  without kinematic bodies; each dynamic body has one shape, placed at the body's origin.
/// @throws std::invalid_argument for any other world.
[[nodiscard]] SceneBodies scene_bodies(const World& world);

/// @return the ids of the dynamic bodies, in the order of SceneBodies::moving.
[[nodiscard]] std::vector<BodyId> moving_bodies(const World& world);

}  // namespace carom::accuracy
