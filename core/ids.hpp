// Generational ids: a stale id is found out, never mistaken for its successor.
//
//   BodyId id = world.create_body({});
//   if (id) { ... }                        // a null id is false
#pragma once

#include <compare>
#include <cstdint>

namespace carom {

/// A handle to one object. Slot 0 with generation 0 is null; live objects have generation >= 1.
template <class Tag>
struct Id {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;

    explicit operator bool() const noexcept { return generation != 0; }
    friend auto operator<=>(const Id&, const Id&) = default;
};

using BodyId = Id<struct BodyTag>;
using ShapeId = Id<struct ShapeTag>;
using JointId = Id<struct JointTag>;

}  // namespace carom
