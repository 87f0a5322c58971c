// Contact problems that every method is given alike: bodies at rest, in places where they can stay, without any impulse to start from.
//
//   const SolverCasePtr column = solver_case(SolverKind::Column, false);
//   World world = column->make({.contact_method = ContactMethod::Direct});
#pragma once

#include <carom/dynamics/world.hpp>

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace carom::accuracy {

/// Column: 20 boxes. Heavy: 10,000 kg on 1 kg, boxes of one size. Pyramid: 10 rows. Arch: a half ring of 9 wedges, which friction and their own weight hold. Pile: 100
/// boxes in a bin as they came to rest.
enum class SolverKind : unsigned char { Column, Heavy, Pyramid, Arch, Pile };
[[nodiscard]] const char* to_string(SolverKind kind) noexcept;
[[nodiscard]] std::span<const SolverKind> solver_kinds();

struct SolverCase {
    SolverKind kind = SolverKind::Column;
    std::function<World(const WorldDef&)> make;  ///< the same places to the bit, all at rest; the definition's gravity is not used
    std::vector<double> carried{};  ///< by each dynamic body, in order of creation [N]: statics; empty where more than one answer is right
};
using SolverCasePtr = std::shared_ptr<const SolverCase>;

/// @param quick  a pile of 30 that came to rest for 3 s, and not of 100 for 8 s.
[[nodiscard]] SolverCasePtr solver_case(SolverKind kind, bool quick);

}  // namespace carom::accuracy
