#include <carom/core/hash.hpp>

#define XXH_INLINE_ALL  // the header alone: nothing to link, no symbols that could clash
#include <xxhash.h>

#include <bit>

namespace carom {

struct StateHash::State {
    XXH3_state_t xxh;
};

StateHash::StateHash() : state_(std::make_unique<State>()) { XXH3_64bits_reset(&state_->xxh); }
StateHash::~StateHash() = default;

void StateHash::add(std::span<const std::byte> bytes) noexcept {
    if (!bytes.empty()) XXH3_64bits_update(&state_->xxh, bytes.data(), bytes.size());
}

// Numbers enter little-endian on every machine.
void StateHash::add(std::uint64_t value) noexcept {
    std::byte bytes[8];
    for (std::size_t i = 0; i < 8; ++i) bytes[i] = static_cast<std::byte>(value >> (8 * i));
    add(std::span<const std::byte>(bytes));
}

void StateHash::add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }

void StateHash::add(const dvec3& value) noexcept {
    add(value.x);
    add(value.y);
    add(value.z);
}

void StateHash::add(const dquat& value) noexcept {
    add(value.w);
    add(value.x);
    add(value.y);
    add(value.z);
}

void StateHash::add(const Pose& value) noexcept {
    add(value.position);
    add(value.orientation);
}

std::uint64_t StateHash::digest() const noexcept { return XXH3_64bits_digest(&state_->xxh); }

std::string to_hex(std::uint64_t digest) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text(16, '0');
    for (std::size_t i = 0; i < 16; ++i) text[15 - i] = kDigits[(digest >> (4 * i)) & 15u];
    return text;
}

}  // namespace carom
