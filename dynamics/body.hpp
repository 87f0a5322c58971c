// What a user says to make bodies and shapes.
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/ids.hpp>
#include <carom/core/pose.hpp>

#include <cstdint>
#include <string>

namespace carom {

/// Static bodies never move; kinematic bodies move at the velocity they are given and push the dynamic ones; dynamic bodies
/// obey forces.
enum class BodyType : unsigned char { Static, Kinematic, Dynamic };
/// @return "static", "kinematic", "dynamic": as scene files spell it.
[[nodiscard]] const char* to_string(BodyType type) noexcept;

struct BodyDef {
    BodyType type = BodyType::Dynamic;
    dvec3 position{0.0};                    ///< of the body's origin [m]
    dquat orientation{kIdentityRotation};   ///< normalised on creation; its length must be within 1e-3 of 1
    dvec3 linear_velocity{0.0};             ///< of the centre of mass [m/s]
    dvec3 angular_velocity{0.0};            ///< world axes [rad/s]
    std::string name{};                     ///< for people: reports and views print it
};

/// How a shape is made of matter and meets others. The parts of a compound may have density, friction and restitution of their own.
struct ShapeDef {
    double density = 1000.0;         ///< [kg/m³] > 0; ignored on static and kinematic bodies
    float friction = 0.6f;           ///< Coulomb coefficient >= 0; two shapes combine by the geometric mean
    float restitution = 0.0f;        ///< in [0, 1]; two shapes combine by the larger
    Pose local{};                    ///< of the shape in its body
    std::uint64_t layer = 1;         ///< bits this shape has
    std::uint64_t mask = ~std::uint64_t{0};  ///< bits it meets; both must agree
};

}  // namespace carom
