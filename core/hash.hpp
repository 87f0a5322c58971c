// A 64-bit hash of state, for telling whether two runs are the same to the bit.
//
//   StateHash hash;
//   hash.add(pose.position);
//   std::uint64_t digest = hash.digest();
#pragma once

#include <carom/core/pose.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace carom {

/// Streaming hash (XXH3, 64 bits). Depends on the bits and their order only; -0 and +0 differ, as do NaN payloads.
class StateHash {
public:
    StateHash();
    ~StateHash();
    StateHash(const StateHash&) = delete;
    StateHash& operator=(const StateHash&) = delete;

    void add(std::span<const std::byte> bytes) noexcept;
    void add(std::uint64_t value) noexcept;
    void add(double value) noexcept;
    void add(const dvec3& value) noexcept;
    void add(const dquat& value) noexcept;
    void add(const Pose& value) noexcept;
    [[nodiscard]] std::uint64_t digest() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// @return 16 lower-case hexadecimal digits.
[[nodiscard]] std::string to_hex(std::uint64_t digest);

}  // namespace carom
