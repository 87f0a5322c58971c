// When two shapes first touch along the paths of their bodies.
//
//   PathSearch search{.a = {&path, &ball, &local, reach}, .b = {&other, &wall, &where, size}, .tolerance = 1e-6};
//   if (touch(search, 0.0, 1.0, cores)) search.t;
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/dynamics/detail/body_path.hpp>
#include <carom/dynamics/detail/first_touch.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace carom::dynamics {

/// Where a half-space is.
inline constexpr Aabb kEverywhere{dvec3{-std::numeric_limits<double>::infinity()}, dvec3{std::numeric_limits<double>::infinity()}};

/// A shape on a body that goes along a path.
struct PathShape {
    BodyPath* path = nullptr;
    const Shape* shape = nullptr;
    const Pose* local = nullptr;  ///< of the shape in the principal frame
    double reach = 0.0;           ///< farthest point from the centre of mass [m]
};

/// What is asked, and below what is found.
struct PathSearch {
    PathShape a, b;
    int level = 0;                ///< how far A is thinned: first_touch.hpp
    double from = 0.0;            ///< when the search begins, whatever part of it touch() is asked for
    double tolerance = 0.0;       ///< [m]
    double separation = 0.0;      ///< shapes this near count as touching [m]
    std::optional<Aabb> still{};  ///< about B, where that does not move
    std::vector<double>* looks =
        nullptr;  ///< where the times go at which conservative advancement looked before it was done, if they are wanted

    double t = 1.0;           ///< of the step, never later than the true time
    double bend = 0.0;        ///< of the two paths there [m]: the shapes are within separation + bend + tolerance
    Impact impact{};          ///< but for its t, which is of the last piece
    std::int64_t pieces = 0;  ///< of paths that were looked at
    int resumed = 0;          ///< looks that came to their cap and were taken up again where they were
};

/// As finely as it takes: a piece that may touch and bends too much is looked at by halves, the earlier first.
/// @return whether they may touch between the two times, which are within the paths.
[[nodiscard]] bool touch(PathSearch& search, double begin, double end, Cores& cores);

}  // namespace carom::dynamics
