// Which boxes overlap, every pair looked at by itself: what broadphases are held against.
//
//   std::vector<ProxyPair> row = oracle::pairs_of_row(boxes, 17);
#pragma once

#include <carom/broadphase/proxy.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::oracle {

/// @param boxes  (n,) with lower <= upper, not NaN.
/// @param a  below n.
/// @return the pairs (a, b) with b > a whose closed boxes share a point, ascending. Cost: O(n).
[[nodiscard]] std::vector<ProxyPair> pairs_of_row(std::span<const FloatAabb> boxes, std::uint32_t a);

}  // namespace carom::oracle
