// Rooms of thin walls, as one closed surface and as the boxes that fill the walls, and the plain search for a way out of them.
//
//   const Walled room = walled(kFloor | kLeft, 0.03f);
//   Exits exits(std::array{solid_of(rod, pose, pose.position)}, solids_of(room, {}, pose.position));
//   double shortest = exits.least(random, 1000);
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/oracle/brute_force.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace carom::oracle {

/// The walls that a room of 1 m about the origin has, as bits; the side y = 0.5 is open.
enum WallBits : unsigned { kFloor = 1, kLeft = 2, kRight = 4, kBack = 8, kFront = 16, kAllWalls = 31 };

struct Wall {
    Box box;
    dvec3 centre{0.0};
};

struct Walled {
    MeshData surface;         ///< closed, corners shared
    std::vector<Wall> walls;  ///< each as wide as the room; they overlap where they meet
};

namespace walls_detail {

using Cell = std::array<int, 3>;

/// Of 27 cells, three along each axis, of which the outer ones are as thick as a wall.
inline bool is_full(const Cell& c, unsigned walls) {
    for (const int i : c) {
        if (i < 0 || i > 2) return false;
    }
    return (c[1] == 0 && (walls & kFloor)) || (c[0] == 0 && (walls & kLeft)) || (c[0] == 2 && (walls & kRight)) ||
           (c[2] == 0 && (walls & kBack)) || (c[2] == 2 && (walls & kFront));
}

inline std::uint32_t number(const Cell& c) { return static_cast<std::uint32_t>(16 * c[0] + 4 * c[1] + c[2]); }

inline void add_side(const Cell& cell, std::size_t axis, int side, MeshData& mesh) {
    std::array<Cell, 4> q{cell, cell, cell, cell};
    for (Cell& c : q) c[axis] += side;
    const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
    ++q[1][u], ++q[2][u], ++q[2][w], ++q[3][w];
    if (side == 0) std::swap(q[1], q[3]);
    mesh.triangles.push_back({number(q[0]), number(q[1]), number(q[2])});
    mesh.triangles.push_back({number(q[0]), number(q[2]), number(q[3])});
}

}  // namespace walls_detail

/// @param walls      of WallBits, at least one.
/// @param thickness  [m], below 0.5.
inline Walled walled(unsigned walls, float thickness) {
    using walls_detail::Cell;
    Walled room;
    const std::array<float, 4> x{-0.5f, -0.5f + thickness, 0.5f - thickness, 0.5f};
    for (std::size_t n = 0; n < 64; ++n) room.surface.vertices.push_back({x[n / 16], x[n / 4 % 4], x[n % 4]});
    for (int n = 0; n < 27; ++n) {
        const Cell cell{n / 9, n / 3 % 3, n % 3};
        if (!walls_detail::is_full(cell, walls)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const int side : {0, 1}) {
                Cell next = cell;
                next[axis] += side == 0 ? -1 : 1;
                if (!walls_detail::is_full(next, walls)) walls_detail::add_side(cell, axis, side, room.surface);
            }
        }
    }
    room.surface = weld(room.surface);  // corners that no triangle uses
    const float half = 0.5f * thickness;
    const auto add = [&](WallBits bit, int axis, double side) {
        if (!(walls & bit)) return;
        Wall wall{{{0.5f, 0.5f, 0.5f}}, dvec3{0.0}};
        wall.box.half_extents[axis] = half;
        wall.centre[axis] = side * (0.5 - static_cast<double>(half));
        room.walls.push_back(wall);
    };
    add(kFloor, 1, -1.0), add(kLeft, 0, -1.0), add(kRight, 0, 1.0), add(kBack, 2, -1.0), add(kFront, 2, 1.0);
    return room;
}

/// The walls where a pose puts the room, from `origin`.
inline std::vector<Solid> solids_of(const Walled& room, const Pose& pose, const dvec3& origin) {
    std::vector<Solid> solids;
    for (const Wall& wall : room.walls)
        solids.push_back(solid_of(wall.box, {transform_point(pose, wall.centre), pose.orientation}, origin));
    return solids;
}

/// How far the convex parts of A have to go along a direction until they are free of those of B, by all separating axes of every two.
class Exits {
public:
    Exits(std::span<const Solid> of_a, std::span<const Solid> of_b) {
        for (const Solid& a : of_a) {
            for (const Solid& b : of_b) add(a, b);
        }
    }

    /// @return the least length beyond which the two stay apart for a while: where they first are [m].
    [[nodiscard]] Real along(const RealVec& way) const {
        std::vector<std::array<Real, 2>> meeting;  // lengths between which two parts overlap
        for (const std::vector<Axis>& axes : pairs_) {
            Real from = -kInfinite, to = kInfinite;
            for (const Axis& axis : axes) {
                const Real rate = glm::dot(axis.normal, way);  // the gap shrinks by it
                if (std::abs(rate) < Real(1e-12)) {
                    if (axis.gap >= 0) to = from;
                } else if (rate > 0) {
                    from = std::max(from, axis.gap / rate);
                } else {
                    to = std::min(to, axis.gap / rate);
                }
            }
            if (from < to && to > 0) meeting.push_back({from, to});
        }
        std::ranges::sort(meeting);
        Real length = 0;
        for (const auto& [from, to] : meeting) {
            if (from > length) break;
            length = std::max(length, to);
        }
        return length;
    }

    /// @return the least of along(): over all axes, which a solid's normals are with both signs, and over `more` directions at random.
    [[nodiscard]] Real least(Random& random, int more) const {
        Real least = kInfinite;
        for (const std::vector<Axis>& axes : pairs_) {
            for (const Axis& axis : axes) least = std::min(least, along(axis.normal));
        }
        for (int i = 0; i < more; ++i) {
            RealVec way{Real(0)};
            do {
                for (int k = 0; k < 3; ++k) way[k] = Real(random.range(-1.0, 1.0));
            } while (length_of(way) > 1 || length_of(way) < Real(0.1));
            least = std::min(least, along(way / length_of(way)));
        }
        return least;
    }

    /// @return how deep the two are in each other once A is moved: of the two parts of which it is most, the least overlap; 0 where none overlap.
    [[nodiscard]] Real deepest_after(const RealVec& motion) const {
        Real deepest = 0;
        for (const std::vector<Axis>& axes : pairs_) {
            Real least = kInfinite;
            for (const Axis& axis : axes) least = std::min(least, glm::dot(axis.normal, motion) - axis.gap);
            deepest = std::max(deepest, least);
        }
        return deepest;
    }

private:
    struct Axis {
        RealVec normal;  // from A to B
        Real gap = 0;
    };

    void add(const Solid& a, const Solid& b) {
        std::vector<Axis>& axes = pairs_.emplace_back();
        const auto offer = [&](const RealVec& n) { axes.push_back({n, gap_along(a, b, n)}); };
        for (const RealVec& n : a.normals) offer(n);
        for (const RealVec& n : b.normals) offer(-n);
        for (const RealVec& e : a.edges) {
            for (const RealVec& f : b.edges) {
                const RealVec n = glm::cross(e, f);
                if (!(length_of(n) > Real(1e-9))) continue;
                offer(n / length_of(n));
                offer(-n / length_of(n));
            }
        }
    }

    std::vector<std::vector<Axis>> pairs_;
};

}  // namespace carom::oracle
