// What the studies of the integrator add up to: the order that each candidate shows, and the spinning box against its limits.
//
//   std::vector<OrderRow> rows = order_rows(results);
#pragma once

#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/slope.hpp>

#include <span>
#include <string>
#include <vector>

namespace carom::accuracy {

/// What a series was to do and did.
enum class OrderVerdict : unsigned char {
    Passed,    ///< slope 2 or better, to 0.05; or, where a tolerance is asked for, within it
    Exact,     ///< rounding at every step
    Failed,    ///< of Carom's
    NotAsked,  ///< of a baseline or a peer, or of a quantity that the knob does not promise
};
[[nodiscard]] const char* to_string(OrderVerdict verdict) noexcept;

struct OrderRow {
    std::string study;
    Series series;  ///< over dt
    OrderVerdict verdict = OrderVerdict::NotAsked;
};
[[nodiscard]] std::vector<OrderRow> order_rows(std::span<const StudyResult> results);

/// The box of `single_body_spin` at dt = 1/60 s over 60 s.
inline constexpr double kMostSpinEnergy = 1e-6, kMostSpinMomentum = 1e-9;

/// The table of both.
[[nodiscard]] Digest integrator_digest(std::span<const StudyResult> results);

}  // namespace carom::accuracy
