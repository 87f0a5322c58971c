// Friction and restitution where a contact is: of a compound those of the part that it touches with.
//
//   Surface s = surface_of(proxy, manifold.part_a);
#pragma once

#include <carom/collision/compound.hpp>
#include <carom/dynamics/detail/proxies.hpp>

namespace carom::dynamics {

struct Surface {
    float friction = 0.0f;
    float restitution = 0.0f;
};

/// @param part  of a compound, as Manifold names it; without meaning for other shapes.
[[nodiscard]] inline Surface surface_of(const Proxy& proxy, std::uint16_t part) noexcept {
    const CompoundPtr* compound = std::get_if<CompoundPtr>(&proxy.shape);
    if (compound == nullptr) return {proxy.friction, proxy.restitution};
    const PartMaterial& material = (*compound)->parts()[part].material;
    return {material.friction.value_or(proxy.friction), material.restitution.value_or(proxy.restitution)};
}

/// @return whether any point of the shape bounces. @param restitution  of its definition.
[[nodiscard]] inline bool bounces(const Shape& shape, float restitution) noexcept {
    const CompoundPtr* compound = std::get_if<CompoundPtr>(&shape);
    if (compound == nullptr) return restitution > 0.0f;
    for (const CompoundPart& part : (*compound)->parts()) {
        if (part.material.restitution.value_or(restitution) > 0.0f) return true;
    }
    return false;
}

}  // namespace carom::dynamics
