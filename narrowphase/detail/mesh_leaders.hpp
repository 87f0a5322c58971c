// Where two meshes touch: the pairs of features that carry contacts of their own.
//
//   finder.find(first, second, limits, faces);
//   for (const Leader& leader : finder.leaders) ...
//
// A leader is a corner of one mesh and the nearest point of the other, or a crossing of two edges, such that both surfaces are locally
// highest towards each other along its normal. Of surfaces that are apart these are the local minima of the distance; of surfaces that
// overlap, the ways in which a stretch of one may leave the other.
#pragma once

#include <carom/core/radix_sort.hpp>
#include <carom/narrowphase/detail/mesh_side.hpp>
#include <carom/narrowphase/detail/placed_faces.hpp>

#include <cstdint>
#include <vector>

namespace carom::detail {

struct Leader {
    dvec3 normal{0.0, 1.0, 0.0};  ///< unit, from the first mesh to the second
    double separation = 0.0;      ///< along it [m]
    dvec3 position{0.0};          ///< midway between the surfaces
    std::uint64_t feature = 0;
    bool is_crossing = false;     ///< of two edges
    bool used = false;
    bool of_whole = false;  ///< a way out of the whole: nothing is deeper along it
};

/// What bounds the search for leaders.
struct LeaderLimits {
    double margin = 0.0;     ///< separations up to this count [m]
    double depth = 0.0;      ///< deeper overlaps are not looked for [m]
    double tolerance = 0.0;  ///< points this close are one [m]
};

class LeaderFinder {
public:
    std::vector<Leader> leaders;
    std::vector<dvec3> behind_second, behind_first;  ///< vertices of the first mesh behind the second surface, and the other way round
    std::vector<dvec3> normals_behind;               ///< of triangles at them, from the first to the second
    double deepest = 0.0;                            ///< of these vertices, from the surface [m]
    bool incomplete = false;                         ///< the search stopped at a cap, or found overlaps and no way out of them

    /// Replaces `leaders`. `faces` are those within the margin of each other, `meeting` the pairs of triangles that meet.
    void find(const MeshSide& first, const MeshSide& second, const LeaderLimits& limits, const PlacedFaces& faces,
              std::span<const TrianglePair> meeting);

    /// The least that parts two triangles that meet, where nothing else was found.
    void add_parting(const MeshSide& first, const MeshSide& second, const TrianglePair& meeting);

    /// The vertex of `mover` in the frame of the pair, against `surface`. @return the way out, though `mover` may not allow it.
    void add_way_out(const MeshSide& mover, std::uint32_t vertex, const SurfacePoint& nearest, bool mover_is_first);

private:
    struct Crossing {
        std::uint64_t name = 0;
        dvec3 on_first{0.0}, on_second{0.0}, normal{0.0};
        double separation = 0.0;
    };

    /// A vertex to look at, with the nearest point of the other surface that is known.
    struct Visit {
        std::uint32_t vertex = 0;
        double nearest_sq = 0.0;
        dvec3 nearest{0.0};
    };

    void queue_near(const PlacedFaces& faces, bool mover_is_first);
    void look_at_vertex(const MeshSide& mover, const MeshSide& surface, const Visit& visit, bool mover_is_first);
    void collect_crossings(const PlacedFaces& faces);
    void add_crossing(const PlacedFace& a, std::size_t i, const PlacedFace& b, std::size_t j, double reach);
    void judge_crossings(const MeshSide& first, const MeshSide& second);
    void drop_spared(const MeshSide& first, const MeshSide& second);
    [[nodiscard]] bool spares(const Leader& other, const Leader& leader, const MeshSide& first, const MeshSide& second) const;
    void judge_crossing(const MeshSide& first, const MeshSide& second, const Crossing& crossing);
    Visit& note(std::uint32_t vertex);

    LeaderLimits limits_;
    bool overlapping_ = false;
    std::vector<Visit> queue_;
    std::vector<std::uint32_t> rounds_, places_;  // by vertex: the round in which it was queued, and where
    std::uint32_t round_ = 0;
    std::vector<Crossing> crossings_;
    std::vector<std::uint64_t> names_;          // of the crossings
    std::vector<std::uint32_t> order_;          // of the crossings by name
    RadixScratch sort_scratch_;
    std::vector<SurfaceFace> faces_;
    std::vector<Leader> blocked_;               // ways out that the surface of the vertex does not allow
};

/// Two meshes of which contacts are sought.
struct MeshContact {
    MeshSide first, second;
    std::vector<TrianglePair> near, meeting;
    PlacedFaces faces;
    LeaderFinder finder;
};

}  // namespace carom::detail
