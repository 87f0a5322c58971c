// What a moving shape meets in a world: the words of World::cast_shape() and its like.
//
//   ShapeCast step{.shape = Capsule{0.4f, 0.5f}, .motion = {.start = player, .translation = dt * velocity}, .filter = {.ignored = body}};
//   std::optional<WorldImpact> hit = world.cast_shape(step);
//   if (hit) player = pose_at(step.motion, hit->impact.t);
#pragma once

#include <carom/core/ids.hpp>
#include <carom/core/result.hpp>
#include <carom/narrowphase/shape_cast.hpp>

#include <cstdint>

namespace carom {

/// Which shapes of a world a cast meets: those that all of this agrees to.
struct CastFilter {
    std::uint64_t layer = ~std::uint64_t{0};  ///< bits the cast has: the shape's mask must share one
    std::uint64_t mask = ~std::uint64_t{0};   ///< bits it meets: the shape's layer must share one
    BodyId ignored{};                         ///< a body that is passed through: the one that is moved, say; null: none
    /// Null: all others are wanted. A pure function; a batch calls it from any thread.
    bool (*wanted)(void* context, BodyId body, ShapeId shape) = nullptr;
    void* context = nullptr;
};

/// A convex shape and how it moves while the world stands still.
struct ShapeCast {
    Shape shape;                      ///< sphere, box, capsule, hull, cylinder or cone
    RigidMotion motion{};             ///< world axes; may turn. The start's orientation is normalised, of a length within 1e-3 of 1
    CastFilter filter{};
    TimeOfImpactSettings settings{};
};

/// @return what makes a cast unfit: NotFinite (motion), InvalidArgument (sizes of the shape, positions and ways beyond 1e30 m, turns beyond 1e9 rad,
/// the orientation's length, settings out of range), WrongType (a plane, mesh or compound cast) or Empty (a null hull).
[[nodiscard]] Status validate(const ShapeCast& cast);

/// What a cast meets. The impact is Touching, Overlapping (at t = 0) or Clamped: then nothing is met before t, and what is after it is not
/// known, see TimeOfImpactSettings::most_checks.
struct WorldImpact {
    BodyId body;
    ShapeId shape;
    ShapeImpact impact;  ///< point and normal in the world, from the cast shape to this one
};

}  // namespace carom
