// The contact problem of one island over one step, as numbers: what the direct solve is given and what it answers.
//
// The velocities v of the bodies minimise
//     1/2 |v - v*|²_M + Σ 1/2 R |λ_c|²,   λ_c = P(y_c),   y_c = λ̂_c - (u_c + b_c n_c) / R
// with v* what they would be without contact, u_c the velocity of B against A at the point, and P the nearest point of the friction cone
// {λ_n >= 0, |λ_t| <= μ λ_n}. It is convex and has one answer, at which M (v - v*) = Σ Jᵀ λ.
// Source: the family of Todorov (ICRA 2014) and Castro et al., An Unconstrained Convex Formulation of Compliant Contact (T-RO 2023); one R for
// all three directions, a friction impulse of the step before and a correction for sliding are ours (docs/dynamics.md).
#pragma once

#include <carom/core/pose.hpp>

#include <cstdint>
#include <vector>

namespace carom::dynamics {

inline constexpr std::int32_t kNoBody = -1;

struct DirectBody {
    double mass = 0.0;        ///< [kg]
    dmat3 inertia{0.0};       ///< about the centre of mass, world axes [kg m²]
    dvec3 free_velocity{0.0}, free_spin{0.0};  ///< v*: without contact, at the end of the step
    dvec3 velocity{0.0}, spin{0.0};            ///< in: a first guess; out: the answer
};

/// One point of contact. Either body may be kNoBody: something that does not give way.
struct DirectContact {
    std::int32_t a = kNoBody, b = kNoBody;
    dvec3 arm_a{0.0}, arm_b{0.0};  ///< from the centres of mass [m]
    dvec3 normal{0.0};             ///< unit, from A to B
    dvec3 drift{0.0};              ///< velocity of B against A at the point by what is no body of the island [m/s]
    double friction = 0.0;
    double bias = 0.0;             ///< b: the normal velocity below which the point pushes is -b [m/s]
    double softness = 0.0;         ///< R [m/s per N s] > 0
    dvec3 friction_guess{0.0};     ///< λ̂: tangential [N s]
    dvec3 impulse{0.0};            ///< out: λ, on B [N s]
};

struct DirectProblem {
    std::vector<DirectBody> bodies;
    std::vector<DirectContact> contacts;
};

}  // namespace carom::dynamics
