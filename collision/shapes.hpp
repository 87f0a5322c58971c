// The shapes that collide, as plain values in a frame of their own.
//
//   Shape crate = Box{{0.5f, 0.5f, 0.5f}};
//   Shape stone = *ConvexHull::build(points);        // heavy shapes are immutable and shared
#pragma once

#include <carom/core/result.hpp>
#include <carom/core/types.hpp>

#include <memory>
#include <variant>

namespace carom {

class Compound;      // <carom/collision/compound.hpp>
class ConvexHull;    // <carom/collision/convex_hull.hpp>
class TriangleMesh;  // <carom/collision/triangle_mesh.hpp>

/// A ball about the origin. radius > 0 [m].
struct Sphere {
    float radius = 0.5f;
    friend bool operator==(const Sphere&, const Sphere&) = default;
};

/// A box about the origin, along the axes. Each half extent > 0 [m].
struct Box {
    vec3 half_extents{0.5f};
    friend bool operator==(const Box&, const Box&) = default;
};

/// All points within `radius` of the segment (0, -half_segment, 0)..(0, half_segment, 0). radius > 0, half_segment >= 0 [m].
struct Capsule {
    float radius = 0.25f;
    float half_segment = 0.25f;
    friend bool operator==(const Capsule&, const Capsule&) = default;
};

/// The half-space dot(normal, x) <= offset: solid below the plane. `normal` of unit length to 1e-5; offset [m]. Unbounded, so
/// it lives only on static and kinematic bodies and outside the broadphase.
struct Plane {
    vec3 normal{0.0f, 1.0f, 0.0f};
    float offset = 0.0f;
    friend bool operator==(const Plane&, const Plane&) = default;
};

/// A solid cylinder about the origin, along y: x² + z² <= radius², |y| <= half_height. Both > 0 [m], neither more than
/// kMaxSlenderness times the other.
struct Cylinder {
    float radius = 0.5f;
    float half_height = 0.5f;
    friend bool operator==(const Cylinder&, const Cylinder&) = default;
};

/// A solid cone along y: its tip at (0, half_height, 0), its base the disc of `radius` about (0, -half_height, 0). Both > 0 [m],
/// neither more than kMaxSlenderness times the other. Its centre of mass is at (0, -half_height / 2, 0).
struct Cone {
    float radius = 0.5f;
    float half_height = 0.5f;
    friend bool operator==(const Cone&, const Cone&) = default;
};

/// The largest ratio of the two sizes of a cylinder or cone: beyond, its moments of inertia and its contacts are lost to rounding.
inline constexpr float kMaxSlenderness = 1e4f;

using CompoundPtr = std::shared_ptr<const Compound>;
using ConvexHullPtr = std::shared_ptr<const ConvexHull>;
using TriangleMeshPtr = std::shared_ptr<const TriangleMesh>;

/// Any shape. The order of the alternatives is the order of ShapeType.
using Shape = std::variant<Sphere, Box, Capsule, Plane, ConvexHullPtr, TriangleMeshPtr, Cylinder, Cone, CompoundPtr>;

enum class ShapeType : unsigned char { Sphere, Box, Capsule, Plane, ConvexHull, TriangleMesh, Cylinder, Cone, Compound };
inline constexpr int kShapeTypeCount = 9;
static_assert(std::variant_size_v<Shape> == kShapeTypeCount);

[[nodiscard]] inline ShapeType type_of(const Shape& shape) noexcept { return static_cast<ShapeType>(shape.index()); }

/// @return the type's name in snake_case, as scene files spell it: "sphere", "box", "capsule", "plane", "convex_hull",
/// "triangle_mesh", "cylinder", "cone", "compound".
[[nodiscard]] const char* to_string(ShapeType type) noexcept;

/// @return true for the shapes that a compound is made of: all but plane, triangle mesh and compound.
[[nodiscard]] inline bool is_convex_solid(ShapeType type) noexcept {
    return type != ShapeType::Plane && type != ShapeType::TriangleMesh && type != ShapeType::Compound;
}

/// @return false for a plane only.
[[nodiscard]] inline bool is_bounded(const Shape& shape) noexcept { return type_of(shape) != ShapeType::Plane; }

/// Checks the ranges above: finite, positive sizes, no cylinder or cone too slender, unit normal, non-null pointer.
/// @return NotFinite, InvalidArgument or Empty with a message that names the field.
[[nodiscard]] Status validate(const Shape& shape);

}  // namespace carom
