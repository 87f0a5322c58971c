#include <carom/collision/detail/weld.hpp>

#include <carom/collision/detail/huge_page_allocator.hpp>

#include <bit>
#include <cstddef>

namespace carom {
namespace {

std::uint32_t hash_of(const vec3& v) noexcept {
    // Adding zero makes +0 of -0.
    const auto x = std::uint64_t{std::bit_cast<std::uint32_t>(v.x + 0.0f)};
    const auto y = std::uint64_t{std::bit_cast<std::uint32_t>(v.y + 0.0f)};
    const auto z = std::uint64_t{std::bit_cast<std::uint32_t>(v.z + 0.0f)};
    std::uint64_t h = (x | y << 32) * 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 32) ^ z) * 0xd6e8feb86659fd93u;
    return static_cast<std::uint32_t>(h >> 32);
}

}  // namespace

std::vector<std::uint32_t> first_at_position(std::span<const vec3> vertices) {
    constexpr std::uint32_t kFree = 0xffffffffu;
    const std::size_t size = std::bit_ceil(2 * vertices.size() + 1);
    const std::size_t mask = size - 1;
    HugePageVector<std::uint32_t> table(size, kFree);
    std::vector<std::uint32_t> first(vertices.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
        std::size_t slot = hash_of(vertices[i]) & mask;
        while (table[slot] != kFree && vertices[table[slot]] != vertices[i]) slot = (slot + 1) & mask;
        if (table[slot] == kFree) table[slot] = i;
        first[i] = table[slot];
    }
    return first;
}

}  // namespace carom
