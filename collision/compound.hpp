// Compounds: one shape of several convex parts, built once, immutable, shared.
//
//   Result<CompoundPtr> dumbbell = Compound::build({{Sphere{0.3f}, {{-0.6, 0, 0}}}, {Sphere{0.3f}, {{0.6, 0, 0}}},
//                                                   {Capsule{0.1f, 0.6f}, {dvec3{0.0}, quarter_turn}}});
//   world.add_shape(body, *dumbbell);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/pose.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace carom {

/// What a part is made of. What it does not say is as the body's ShapeDef has it for the whole compound.
struct PartMaterial {
    std::optional<double> density{};     ///< [kg/m³] > 0
    std::optional<float> friction{};     ///< Coulomb coefficient >= 0
    std::optional<float> restitution{};  ///< in [0, 1]
};

struct CompoundPart {
    Shape shape;              ///< convex: any but plane, triangle mesh and compound
    Pose pose{};              ///< in the compound's frame; its orientation is normalised, of a length within 1e-3 of 1
    PartMaterial material{};
};

/// Convex parts in one frame, with a hierarchy of their boxes. Parts may overlap, touch or be apart. A part is known by its index in
/// the list that built the compound; RayHit::part and Manifold::part_a, part_b hold it.
class Compound {
public:
    static constexpr std::size_t kMaxParts = std::size_t{1} << 16;
    static constexpr double kFarthest = 1e15;  ///< [m], of any point of a part from the compound's origin

    /// @return the compound; Empty (no parts, or a null pointer in one), WrongType (a part that is not convex), NotFinite or
    /// InvalidArgument (sizes, pose and material of a part by the ranges above; too many parts; a part too far away).
    /// Cost: O(n log n).
    [[nodiscard]] static Result<CompoundPtr> build(std::vector<CompoundPart> parts);

    [[nodiscard]] std::span<const CompoundPart> parts() const noexcept { return parts_; }
    /// @return the box of all parts in the compound's frame, rounded outward to floats.
    [[nodiscard]] const Aabb& local_bounds() const noexcept { return bounds_; }

    /// Calls `visit` for every part whose box, rounded outward to floats, overlaps `box` (closed test, compound's frame) until it
    /// returns false. The order is fixed by the compound alone. Cost: O(log n + hits), no allocation, thread-safe.
    void overlap(const Aabb& box, FunctionRef<bool(std::uint32_t part)> visit) const;

    /// Calls `visit` for every part whose box the ray from `origin` along `direction` meets at a distance of at most `reach`, in lengths
    /// of `direction`; what `visit` returns is the reach from then on. Order and cost as above.
    void along(const dvec3& origin, const dvec3& direction, double reach, FunctionRef<double(std::uint32_t part)> visit) const;

    /// Visits the boxes of the hierarchy with their depth (root 0), parents first, for drawing.
    void visit_nodes(FunctionRef<void(const Aabb& box, int depth)> visit) const;

private:
    /// In depth-first order: the left child of node i is i + 1, the right one i + skip; 0 in a leaf.
    struct Node {
        std::array<float, 3> lower{};
        std::array<float, 3> upper{};
        std::uint32_t first = 0, count = 0;  ///< of its parts in order_
        std::uint32_t skip = 0;
    };
    /// Calls leaf(part) for the parts of all leaves under nodes that enter(box) lets in, until leaf returns false.
    template <class Enter, class Leaf>
    void descend(const Enter& enter, const Leaf& leaf) const;

    Compound() = default;
    std::vector<CompoundPart> parts_;
    std::vector<Node> nodes_;
    std::vector<Aabb> boxes_;           ///< of the parts, in the order of order_
    std::vector<std::uint32_t> order_;  ///< parts as the leaves hold them
    Aabb bounds_;
};

}  // namespace carom
