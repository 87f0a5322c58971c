// Of two meshes that are deep in each other, a way that leads one out of the other.
//
//   if (auto way = ways.find(contact, b_in_a, tolerance)) { way->normal; way->separation; }
#pragma once

#include <carom/core/pose.hpp>
#include <carom/narrowphase/detail/mesh_leaders.hpp>

#include <optional>
#include <span>
#include <vector>

namespace carom::detail {

struct WayOutLimits {
    double deep = 0.0;       ///< what is not as deep is left to the leaders [m]
    double tolerance = 0.0;  ///< points this close are one [m]
};

/// Where two surfaces overlap: the corners of each behind the other, and where an edge of one passes through a triangle of the other, which
/// is a point of both. Along a direction the two stretches are apart after a motion by how far the one reaches over the other; whether that
/// frees the meshes, which go on beyond, is asked of all their triangles.
class WayOutFinder {
public:
    /// @param faces     within the margin, with which of them meet. @param meets  whether the meshes meet with the first moved by a vector.
    /// @return the way out, as a leader: the shortest motion along a normal of a triangle that meets, of one with a corner behind the other surface,
    /// of a leader, or of two edges that cross, of the kMostTries shortest, after which no two triangles meet. None where none is found, or
    /// where the leaders are right: none deeper than that, and together they lead out.
    [[nodiscard]] std::optional<Leader> find(const LeaderFinder& finder, const PlacedFaces& faces, const WayOutLimits& limits,
                                             FunctionRef<bool(const dvec3& motion)> meets);

    /// @return whether the last find() knew no way out, and the leaders together do not lead out either.
    [[nodiscard]] bool unfreed() const noexcept { return unfreed_; }

private:
    struct Way {
        dvec3 normal{0.0};
        double depth = 0.0;
        dvec3 deepest{0.0};  ///< of the first mesh, the farthest along the normal
        dvec3 highest{0.0};  ///< of the second, the farthest against it
    };

    [[nodiscard]] bool crosses_at_length(const LeaderFinder& finder, double deep) const;
    void collect_points(const LeaderFinder& finder, const PlacedFaces& faces);
    void collect_directions(const LeaderFinder& finder, const PlacedFaces& faces);
    void offer(const dvec3& normal);
    [[nodiscard]] Way way_along(const dvec3& normal) const;
    [[nodiscard]] Way refined(Way way) const;

    std::vector<dvec3> first_, second_;  // points of the two stretches
    std::vector<Way> ways_;
    std::vector<std::uint32_t> order_;  // ways that are left
    bool unfreed_ = false;
};

}  // namespace carom::detail
