// The operations of core/lanes.hpp over arrays, behind run-time dispatch, for comparison with scalar code.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace carom::test {

enum class Unary { Negate, Abs, Sqrt };
enum class Binary { Add, Subtract, Multiply, Divide, Min, Max, CopySign };
enum class Comparison { Less, LessEqual, Greater, GreaterEqual, Equal, NotEqual };

/// out[i] = op(a[i]); the size is a multiple of 16 and the data 64-byte aligned, as everywhere below.
void run_unary(Unary op, std::span<const float> a, std::span<float> out);
void run_binary(Binary op, std::span<const float> a, std::span<const float> b, std::span<float> out);
/// out[i] = a[i] op b[i], through the mask bits.
void run_comparison(Comparison op, std::span<const float> a, std::span<const float> b, std::span<std::int32_t> out);
/// out[i] = a[i] < b[i] ? a[i] : b[i], through select.
void run_select(std::span<const float> a, std::span<const float> b, std::span<float> out);
void run_dot(const float* const a[3], const float* const b[3], std::span<float> out);
void run_cross(const float* const a[3], const float* const b[3], float* const out[3], std::size_t count);
/// Four columns of each row to four arrays.
void run_gather(const float* base, std::span<const std::int32_t> rows, std::size_t stride, std::size_t column,
                float* const out[4]);
void run_scatter(float* base, std::span<const std::int32_t> rows, std::size_t stride, std::size_t column,
                 const float* const in[4]);
/// Eight columns of each row grow by what eight arrays hold; rows >= limit are left alone.
void run_add_rows(float* base, std::span<const std::int32_t> rows, std::size_t stride, const float* const in[8], std::int32_t limit);
/// Indices of the values below `limit`. @return how many.
std::size_t run_compress(std::span<const float> values, float limit, std::span<std::int32_t> out);
/// The integer operations: out = {a + b, a - b, a & b, a | b, a ^ b, a < b, a == b, bits(float(a))}, each an array.
void run_integers(std::span<const std::int32_t> a, std::span<const std::int32_t> b, std::int32_t* const out[8]);
/// all, any, none and the bits of masks that hold in the first n lanes; false if anything is off.
bool masks_are_right();

}  // namespace carom::test
