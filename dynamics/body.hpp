// What a user says to make bodies and shapes.
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/ids.hpp>
#include <carom/core/pose.hpp>
#include <carom/dynamics/continuous_settings.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace carom {

/// Static bodies never move; kinematic bodies move at the velocity they are given and push the dynamic ones; dynamic bodies
/// obey forces.
enum class BodyType : unsigned char { Static, Kinematic, Dynamic };
/// @return "static", "kinematic", "dynamic": as scene files spell it.
[[nodiscard]] const char* to_string(BodyType type) noexcept;

/// World axes along which a body does not move, or about which it does not turn; any of these, joined by |.
struct LockedAxes {
    static constexpr unsigned char None = 0, MoveX = 1, MoveY = 2, MoveZ = 4, TurnX = 8, TurnY = 16, TurnZ = 32, All = 63;
    static constexpr unsigned char Plane2D = MoveZ | TurnX | TurnY;  ///< what is left is a world in the plane of x and y
};

struct BodyDef {
    BodyType type = BodyType::Dynamic;
    dvec3 position{0.0};                    ///< of the body's origin [m]
    dquat orientation{kIdentityRotation};   ///< normalised on creation; its length must be within 1e-3 of 1
    dvec3 linear_velocity{0.0};             ///< of the centre of mass [m/s]
    dvec3 angular_velocity{0.0};            ///< world axes [rad/s]
    std::string name{};                     ///< for people: reports and views print it
    double gravity_scale = 1.0;             ///< of dynamic bodies: how much of the world's gravity pulls; finite, may be negative
    double linear_damping = 0.0;            ///< of dynamic bodies: without other forces v falls by exp(-c t), c >= 0 [1/s]
    double angular_damping = 0.0;           ///< the same of the angular momentum
    unsigned char locked = LockedAxes::None;  ///< of dynamic bodies
    Continuity continuity = Continuity::Automatic;  ///< of dynamic and kinematic bodies: whether they are followed along their paths
    bool can_sleep = true;                  ///< false, of dynamic bodies: it stays awake, and so does all that touches it
};

/// How the values of two shapes become that of their contact. A shape that names no rule leaves it to the other; where both name one, the
/// later in this list holds; where none does: friction GeometricMean, everything else Maximum.
enum class CombineRule : unsigned char { Average, GeometricMean, Minimum, Product, Maximum };
/// @return "average", "geometric_mean", "minimum", "product", "maximum": as scene files spell it.
[[nodiscard]] const char* to_string(CombineRule rule) noexcept;

/// How a shape is made of matter and meets others. The parts of a compound may have density, friction and restitution of their own.
struct ShapeDef {
    double density = 1000.0;         ///< [kg/m³] > 0; ignored on static and kinematic bodies
    float friction = 0.6f;           ///< Coulomb coefficient >= 0
    float restitution = 0.0f;        ///< in [0, 1]: speed after an impact over that before it
    std::optional<CombineRule> friction_rule{};
    std::optional<CombineRule> restitution_rule{};
    float rolling_resistance = 0.0f; ///< coefficient of rolling friction [m], 0 .. 1e30: the torque against rolling over the normal force. A ball of radius r rolls on slopes
                                     ///< steeper than rolling_resistance / r
    float torsion = 0.0f;            ///< the same against spinning about the contact's normal [m]; a round patch of radius a has 2/3 a times its friction
    std::optional<CombineRule> rolling_rule{};  ///< of both
    Pose local{};                    ///< of the shape in its body
    std::uint64_t layer = 1;         ///< bits this shape has
    std::uint64_t mask = ~std::uint64_t{0};  ///< bits it meets; both must agree

    friend bool operator==(const ShapeDef&, const ShapeDef&) = default;
};

}  // namespace carom
