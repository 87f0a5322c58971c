// The tolerances of the pair kernels, all relative, with the reason for each.
#pragma once

namespace carom::detail {

/// Sine of the angle between two edges below which their cross product is no axis. Leaving it out costs at most this times the
/// size in depth (the face axes decide up to the tilt); using it would amplify rounding by its inverse. 1e-7 keeps both below
/// 1e-6 of the size: 1e-7 and 4 * 2.2e-16 / 1e-7.
inline constexpr double kParallelSine = 1e-7;

/// An edge axis wins over a face axis only if it separates better by this share of the size: the accuracy that `collide` states. So
/// rounding never turns a face contact into an edge contact.
inline constexpr double kFacePreference = 1e-6;

/// What rounding may do to a separation that is computed in floats, as a share of the larger box's largest half extent: some ten
/// roundings of 6e-8 each, of terms that add up to a few half extents.
inline constexpr float kWideRounding = 1e-6f;

/// Boxes are worked on whole, in metres and in floats, where neither is longer than this many times what the other may reach, and the
/// longest half extent [m] lies between these. Others are cut, or measured in other units, first.
inline constexpr float kUnusualRatio = 8.0f;
inline constexpr float kSmallestUsual = 0x1p-20f;
inline constexpr float kLargestUsual = 0x1p20f;

/// The same as kFacePreference for separations in floats, of the half extent: twice their rounding.
inline constexpr float kWidePreference = 2e-6f;

/// Points outside a square of half side 1 by this much count as inside, where both were computed in floats.
inline constexpr float kWideInside = 1e-6f;

/// The same as kPointTolerance in floats, of the half extent.
inline constexpr float kWidePointTolerance = 4e-6f;

/// Points outside a polygon by this share of the size count as inside, so that no corner is lost between two half-open tests.
inline constexpr double kInsideTolerance = 1e-9;

/// Polytopes closer than this share of the size have no reliable direction between their closest points (rounding of 1e-16 of the
/// size over the distance: 1e-8 rad here); the axes decide instead. The step between the two answers is below this.
inline constexpr double kTouching = 1e-8;

/// Points of a patch this close to each other, as a share of the size, are one point; depths that differ by less are equal.
inline constexpr double kPointTolerance = 1e-6;

/// Where a choice of points is to be steady: the deepest of many may be left out if it is deeper than the four that span the patch by no more
/// than the share of their depth, and by no more than the cap, of the size. Corners that bear nothing sink below those that bear by a
/// tenth to a quarter of the depth; the cap keeps the depth of what is deep true.
inline constexpr double kSteadyShare = 0.3;
inline constexpr double kSteadyCap = 1e-3;

/// Squares of distances between points of a patch are equal from this share of the greatest on. Rounding to floats does less where the patch
/// is longer than a fiftieth of the size.
inline constexpr double kAsFar = 1.0 - 0x1p-14;

/// A point bears the name of a corner within this share of the shortest side of the faces.
inline constexpr double kSnap = 0.02;

/// The least cosine between the normal of contact and a face that points are taken from. Heights over the face are divided by it;
/// steeper faces fall away from the contact at once and have no further points within reach.
inline constexpr double kLeastSlope = 0.05;

/// Shapes that cross edges share points of their faces too where both face the normal to within acos(0.9) = 26 degrees. Beyond,
/// the faces fall away by 0.4 of the distance from the crossing, and their points would carry nothing.
inline constexpr double kFacingCosine = 0.9;

/// A face this square to the normal of contact (1.4e-3 rad) is the face that the other shape lies on.
inline constexpr double kSquareCosine = 1.0 - 1e-6;

/// Capsules whose axes enclose an angle of at most this sine touch along a line: two points. Halves of length h and radius r then
/// curve apart between the points by at most (0.03 h)^2 / (4 r), which the points do not show.
inline constexpr double kAlongSine = 0.03;

/// A surface counts as flat over an edge where it rises by at most this sine: normals that rounding tilts are still its own.
inline constexpr double kRidgeSine = 1e-5;

/// A normal this close to a triangle's own is that normal.
inline constexpr double kFaceCosine = 1.0 - 1e-10;

/// Contacts with triangles of a mesh whose normals lie this close make one manifold: for flat-sided shapes within 18 degrees, since
/// one face rests on all of them; for round shapes within 0.8 degrees, since each point has a normal of its own.
inline constexpr double kSameNormal = 0.95;
inline constexpr double kSameRoundNormal = 0.9999;

}  // namespace carom::detail
