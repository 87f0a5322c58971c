// What must hold for any bytes that StaticBvh::load is given: refused, or a tree whose queries stay in range. For the fuzzer and for
// tests.
//
//   EXPECT_EQ(test::static_bvh_file_fault(bytes), "");
#pragma once

#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/hash.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace carom::test {

/// Writes the checksum that the bytes ought to have, where they are long enough to have one.
inline void forge_checksum(std::vector<std::byte>& bytes) {
    constexpr std::size_t kHeader = 96, kAt = kHeader - 8;
    if (bytes.size() < kHeader) return;
    StateHash hash;
    hash.add(std::span(bytes).first(kAt));
    hash.add(std::span(bytes).subspan(kHeader));
    const std::uint64_t digest = hash.digest();
    for (std::size_t k = 0; k < 8; ++k) bytes[kAt + k] = static_cast<std::byte>(digest >> (8 * k));
}

/// Asks a loaded tree what a user would. @return what is wrong with its answers; empty if nothing is.
inline std::string fault_of_answers(const StaticBvh& bvh) {
    const Aabb box = bvh.bounds();
    if (is_empty(box)) return "a tree without extent";
    const dvec3 middle = 0.5 * (box.lower + box.upper), size = box.upper - box.lower;
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 direction{0.0};
        direction[axis] = 1.0;
        const dvec3 origin = middle - (size[axis] + 1.0) * direction;
        const MeshHit hit = closest_hit(bvh, {.origin = vec3(origin), .direction = vec3(direction)});
        if (hit && hit.triangle >= bvh.triangle_count()) return "a ray hits a triangle that is not there";
    }
    std::vector<bool> seen(bvh.triangle_count());
    bool in_range = true;
    overlapping_triangles(bvh, geo::Aabb<double>{box.lower, box.upper}, [&](std::uint32_t triangle) {
        in_range = in_range && triangle < seen.size() && !seen[triangle];
        if (in_range) seen[triangle] = true;
        return in_range;
    });
    if (!in_range) return "a triangle that is not there, or twice";
    for (const bool is_there : seen) {
        if (!is_there) return "the whole box misses a triangle";
    }
    if (const auto nearest = closest_point(bvh, middle); nearest && nearest->triangle >= seen.size()) return "the nearest triangle is not there";
    if (StaticBvh::load(bvh.save())) return "";
    return "what was loaded cannot be saved and loaded";
}

/// The bytes as they are, and with a checksum made to fit.
inline std::string static_bvh_file_fault(std::span<const std::byte> bytes) {
    std::vector<std::byte> forged(bytes.begin(), bytes.end());
    for (const bool forge : {false, true}) {
        if (forge) forge_checksum(forged);
        const Result<StaticBvh> loaded = StaticBvh::load(forged);
        if (!loaded) {
            if (loaded.error().code != ErrorCode::Parse) return "an error that is not Parse";
            continue;
        }
        if (std::string fault = fault_of_answers(*loaded); !fault.empty()) return fault;
    }
    return "";
}

}  // namespace carom::test
