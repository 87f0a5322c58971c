// Friction and restitution where a contact is: of a compound those of the part that it touches with.
//
//   Surface s = surface_of_part({proxy.friction, proxy.restitution}, compound_of(proxy.shape), manifold.part_a);
#pragma once

#include <carom/collision/compound.hpp>

#include <cstdint>

namespace carom::dynamics {

struct Surface {
    float friction = 0.0f;
    float restitution = 0.0f;
};

/// @return null for a shape that is no compound.
[[nodiscard]] inline const Compound* compound_of(const Shape& shape) noexcept {
    const CompoundPtr* compound = std::get_if<CompoundPtr>(&shape);
    return compound == nullptr ? nullptr : compound->get();
}

/// @param whole  of the shape, for what the part does not say and for shapes that are no compound.
/// @param part   as Manifold names it.
[[nodiscard]] inline Surface surface_of_part(const Surface& whole, const Compound* compound, std::uint16_t part) noexcept {
    if (compound == nullptr) return whole;
    const PartMaterial& material = compound->parts()[part].material;
    return {material.friction.value_or(whole.friction), material.restitution.value_or(whole.restitution)};
}

/// @return whether any point of the shape bounces. @param restitution  of its definition.
[[nodiscard]] inline bool bounces(const Shape& shape, float restitution) noexcept {
    const Compound* compound = compound_of(shape);
    if (compound == nullptr) return restitution > 0.0f;
    for (const CompoundPart& part : compound->parts()) {
        if (part.material.restitution.value_or(restitution) > 0.0f) return true;
    }
    return false;
}

}  // namespace carom::dynamics
