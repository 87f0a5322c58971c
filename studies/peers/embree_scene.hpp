// A mesh in Embree, for rays one by one on one thread.
//
//   EmbreeScene peer(mesh, EmbreeSettings{.robust = true, .high_quality = false});
//   EmbreeHit hit = peer.closest_hit(ray);
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/collision/primitives.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

namespace carom::peers {

struct EmbreeSettings {
    bool robust = false;        ///< RTC_SCENE_FLAG_ROBUST
    bool high_quality = false;  ///< RTC_BUILD_QUALITY_HIGH, else MEDIUM
};

struct EmbreeHit {
    float t = std::numeric_limits<float>::infinity();
    std::uint32_t triangle = 0xffffffffu;
};

class EmbreeScene {
public:
    /// Copies the mesh and builds. @throws std::runtime_error where Embree refuses.
    EmbreeScene(const MeshData& mesh, const EmbreeSettings& settings);
    ~EmbreeScene();

    [[nodiscard]] EmbreeHit closest_hit(const geo::Ray<float>& ray) const noexcept;
    [[nodiscard]] static std::string version();

private:
    struct Handles;
    std::unique_ptr<Handles> handles_;
};

}  // namespace carom::peers
