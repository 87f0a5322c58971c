// Friction and restitution where a contact is: of a compound those of the part that it touches with.
//
//   Surface s = surface_of_part(proxy.surface, compound_of(proxy.shape), manifold.part_a);
#pragma once

#include <carom/collision/compound.hpp>
#include <carom/dynamics/body.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace carom::dynamics {

struct Surface {
    float friction = 0.0f;
    float restitution = 0.0f;
    std::optional<CombineRule> friction_rule{}, restitution_rule{};
};

/// @param usual  the rule where neither shape names one.
[[nodiscard]] inline float combine(float a, float b, std::optional<CombineRule> rule_a, std::optional<CombineRule> rule_b,
                                   CombineRule usual) noexcept {
    const std::optional<CombineRule> rule = std::max(rule_a, rule_b);  // none is less than any
    switch (rule.value_or(usual)) {
        case CombineRule::Average: return 0.5f * a + 0.5f * b;
        case CombineRule::GeometricMean: return std::sqrt(a * b);
        case CombineRule::Minimum: return std::min(a, b);
        case CombineRule::Product: return a * b;
        case CombineRule::Maximum: break;
    }
    return std::max(a, b);
}

/// @return the surface of a contact, whose rules mean nothing.
[[nodiscard]] inline Surface combine(const Surface& a, const Surface& b) noexcept {
    return {combine(a.friction, b.friction, a.friction_rule, b.friction_rule, CombineRule::GeometricMean),
            combine(a.restitution, b.restitution, a.restitution_rule, b.restitution_rule, CombineRule::Maximum)};
}

/// How a shape resists to rolling and spinning, as lengths [m].
struct Resistance {
    float rolling = 0.0f, torsion = 0.0f;
    std::optional<CombineRule> rule{};
};

[[nodiscard]] inline bool resists(const Resistance& r) noexcept { return r.rolling > 0.0f || r.torsion > 0.0f; }

/// @return the resistance of a contact, whose rule means nothing.
[[nodiscard]] inline Resistance combine(const Resistance& a, const Resistance& b) noexcept {
    return {combine(a.rolling, b.rolling, a.rule, b.rule, CombineRule::Maximum), combine(a.torsion, b.torsion, a.rule, b.rule, CombineRule::Maximum)};
}

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
    return {material.friction.value_or(whole.friction), material.restitution.value_or(whole.restitution), whole.friction_rule,
            whole.restitution_rule};
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
