// How deep the bodies of a world are in each other, from poses and shapes alone: never what the engine's manifolds say.
//
//   Penetration p = geometric_penetration(world);
//   print(p.polytopes.maximum, p.polytopes.mean);
#pragma once

#include <carom/dynamics/world.hpp>

#include <cstddef>

namespace carom::oracle {

/// Over the pairs that overlap.
struct PenetrationSummary {
    double maximum = 0.0;   ///< [m]; 0 if none overlaps
    double mean = 0.0;      ///< [m]; 0 if none overlaps
    std::size_t pairs = 0;  ///< that overlap by more than 0
};

struct Penetration {
    PenetrationSummary polytopes;  ///< boxes, hulls, cylinders and cones against each other: the least overlap over the separating axes
    PenetrationSummary round;      ///< spheres and capsules against each other and against boxes and hulls
    /// Everything against meshes and planes: how far the deepest sample (a corner of a box or hull, the end of a
    /// capsule's segment or the centre of a sphere, less the radius) lies behind the surface. Behind a mesh means:
    /// behind the nearest triangle, by its winding, and no deeper than the shape's own bounding radius; what has its
    /// middle behind a one-sided mesh is not in it. Corners of the mesh inside a body are not looked at, so it is a
    /// lower bound where ridges are sharp.
    PenetrationSummary terrain;
};

/// Which summaries to form; the others stay zero.
struct PenetrationSettings {
    bool polytopes = true;
    bool round = true;
    bool terrain = true;
};

/// Looks at every pair of shapes, or parts of compounds, of two bodies of which at least one is dynamic and whose layers and masks meet;
/// quarantined bodies are left out. Pairs come from a sort and sweep over exact boxes, so none is missed. Accuracy: see
/// <carom/studies/oracle/polytope.hpp>. Cost: O(n log n + candidates); 16,000 boxes in a heap take about 0.1 s.
/// Allocates; const, so several may run at once.
[[nodiscard]] Penetration geometric_penetration(const World& world, const PenetrationSettings& settings = {});

}  // namespace carom::oracle
