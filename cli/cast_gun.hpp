// Where the casts of `carom cast` start and where they lead to: a seeded sequence round a target.
//
//   CastGun gun(target, settings);
//   const Ray ray = gun.next();
#pragma once

#include <carom/cli/cast_rays.hpp>
#include <carom/core/random.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>

namespace carom::cli {

/// Where casts start and where they lead to.
class CastGun {
public:
    CastGun(const CastTarget& target, const CastSettings& settings) : target_(target), aim_(settings.aim), random_(settings.seed) {
        center_ = 0.5 * (target.bounds.lower + target.bounds.upper);
        radius_ = 0.6 * glm::length(target.bounds.upper - target.bounds.lower);  // the box's corners are at 0.5
    }
    /// @return a ray of unit direction from outside of the target.
    Ray next() {
        const dvec3 from = on_sphere();
        const dvec3 to = aim_ == Aim::Chords ? on_sphere() : on_edge();
        return {.origin = from, .direction = glm::normalize(to - from)};
    }

    /// @return how far from one side of the sphere to the other [m].
    [[nodiscard]] double span() const noexcept { return 2.0 * radius_; }

private:
    dvec3 on_sphere() {
        for (;;) {
            const double x = random_.range(-1.0, 1.0), y = random_.range(-1.0, 1.0);
            const dvec3 p{x, y, random_.range(-1.0, 1.0)};
            const double length = glm::length(p);
            if (length > 0.1 && length < 1.0) return center_ + p * (radius_ / length);
        }
    }
    // Every third time a corner, otherwise a point of an edge.
    dvec3 on_edge() {
        const MeshData& data = target_.mesh->data;
        const auto index = static_cast<std::size_t>(random_.unit() * static_cast<double>(data.triangles.size()));
        const auto& t = data.triangles[index];
        return glm::mix(dvec3(data.vertices[t[0]]), dvec3(data.vertices[t[1]]), std::max(0.0, random_.range(-0.5, 1.0)));
    }

    const CastTarget& target_;
    Aim aim_;
    Random random_;
    dvec3 center_{0.0};
    double radius_ = 1.0;
};

}  // namespace carom::cli
