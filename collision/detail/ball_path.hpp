// The path of a ball through the wide hierarchy, and why no plane in float passes over a triangle that it meets.
//
// Any plane proves a step: with n any vector, h the most that a triangle has along it and R the radius, the ball is apart from the triangle
// while n . (o + s d) - h > R |n|, o its start and d its way. That is linear in s, so where it holds at t it does up to its root, or for ever.
// Nothing but time depends on how well n is chosen.
//
// Write u = 2^-24, D for the largest distance along an axis from o to the tree's box, A for the largest coordinate of o, r for the radius,
// all in the tree's coordinates; the largest component of d is in [1, 2), so no contact comes after s = D + r. Of the float gap, in units of u |n|:
//   h       corners are wrong by A + D an axis, sides by 2 D; dots of three by 3 of what they sum up: 22.6 D + 1.8 A
//   R |n|   the radius, root and product by 4.5 r; the difference of the two by 1.8 D + r
//   n . d   12.1 (D + r): the dot by 10.4, d itself by 1.8; times t 3.5 (D + r)
//   quotient  1.8 D
// and what narrowphase/sweep.hpp may call contact before it is one, 3e-7 of what it calls S: 8.8 D + 5.1 r. Together below 51 D + 2 A + 27 r,
// for which R is larger than r by 56 u (D + A + r). Squares below kLeastSquare would lose digits: such n prove nothing. Where squares overflow the
// gap is no number or none, and proves nothing either.
#pragma once

namespace carom {

/// What a ball has besides its ray (wide_ray.hpp), in the tree's coordinates.
struct BallPath {
    static constexpr float kLeastSquare = 1e-24f;
    static constexpr float kLeastRadius = 1e-25f;  ///< R: below it products may underflow

    float way[3];
    float radius;  ///< R
};

}  // namespace carom
