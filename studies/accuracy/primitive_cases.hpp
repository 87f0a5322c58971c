// The cases of the studies of primitives: pairs of primitives, and what exact arithmetic says of them.
//
//   for (const PrimitivePart& part : primitive_parts(quick)) { PartSample s = part.in_float(); ... }
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace carom::accuracy {

/// One pass over the cases of a part.
struct PartSample {
    double time_s = 0.0;       ///< in the tests alone [s]
    double error_sum = 0.0;    ///< over the cases: 1 for a wrong verdict, else the error of the value, 1 at most
    std::size_t failures = 0;  ///< values that are not finite
};

/// Cases of one test under one condition.
struct PrimitivePart {
    std::string kind;       ///< "ray_sphere", ...
    std::string condition;  ///< "plain", "offset", "scale" or "touch"
    std::size_t count = 0;
    std::function<PartSample()> in_float;   ///< the inputs rounded to float where they are not floats already
    std::function<PartSample()> in_double;
};

/// @return every kind under every condition, with answers in 300 bits. docs/accuracy.md describes them. Always the same cases.
/// The error of t is relative to t; that of a distance to the larger of distance and size.
/// @param quick  a tenth of the cases.
[[nodiscard]] std::vector<PrimitivePart> primitive_parts(bool quick);

}  // namespace carom::accuracy
