#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/lanes_kernels.cpp"
#include <hwy/foreach_target.h>

#include <carom/core/bundle.hpp>
#include <carom/core/lanes.hpp>

#include "core/lanes_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace carom::test::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

void unary(Unary op, std::span<const float> a, std::span<float> out) {
    for (std::size_t i = 0; i < a.size(); i += kLanes) {
        const Floats x = load(a.data() + i);
        switch (op) {
            case Unary::Negate: store(-x, out.data() + i); break;
            case Unary::Abs: store(abs(x), out.data() + i); break;
            case Unary::Sqrt: store(sqrt(x), out.data() + i); break;
        }
    }
}

void binary(Binary op, std::span<const float> a, std::span<const float> b, std::span<float> out) {
    for (std::size_t i = 0; i < a.size(); i += kLanes) {
        const Floats x = load_unaligned(a.data() + i);
        const Floats y = load(b.data() + i);
        Floats r;
        switch (op) {
            case Binary::Add: r = x + y; break;
            case Binary::Subtract: r = x - y; break;
            case Binary::Multiply: r = x * y; break;
            case Binary::Divide: r = x / y; break;
            case Binary::Min: r = min(x, y); break;
            case Binary::Max: r = max(x, y); break;
            case Binary::CopySign: r = copy_sign(x, y); break;
        }
        store_unaligned(r, out.data() + i);
    }
}

Mask compare(Comparison op, Floats x, Floats y) {
    switch (op) {
        case Comparison::Less: return x < y;
        case Comparison::LessEqual: return x <= y;
        case Comparison::Greater: return x > y;
        case Comparison::GreaterEqual: return x >= y;
        case Comparison::Equal: return x == y;
        case Comparison::NotEqual: break;
    }
    return x != y;
}

void comparison(Comparison op, std::span<const float> a, std::span<const float> b, std::span<std::int32_t> out) {
    for (std::size_t i = 0; i < a.size(); i += kLanes) {
        const unsigned mask = bits(compare(op, load(a.data() + i), load(b.data() + i)));
        for (std::size_t l = 0; l < kLanes; ++l) out[i + l] = static_cast<std::int32_t>((mask >> l) & 1u);
    }
}

void choose(std::span<const float> a, std::span<const float> b, std::span<float> out) {
    for (std::size_t i = 0; i < a.size(); i += kLanes) {
        const Floats x = load(a.data() + i);
        const Floats y = load(b.data() + i);
        store(select(x < y, x, y), out.data() + i);
    }
}

Floats3 load3(const float* const v[3], std::size_t i) { return {load(v[0] + i), load(v[1] + i), load(v[2] + i)}; }

void dots(const float* const a[3], const float* const b[3], std::span<float> out) {
    for (std::size_t i = 0; i < out.size(); i += kLanes) store(dot(load3(a, i), load3(b, i)), out.data() + i);
}

void crosses(const float* const a[3], const float* const b[3], float* const out[3], std::size_t count) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        const Floats3 r = cross(load3(a, i), load3(b, i));
        store(r.x, out[0] + i);
        store(r.y, out[1] + i);
        store(r.z, out[2] + i);
    }
}

void gather(const float* base, std::span<const std::int32_t> rows, std::size_t stride, std::size_t column,
            float* const out[4]) {
    for (std::size_t i = 0; i < rows.size(); i += kLanes) {
        Floats v[4];
        gather_rows(base, rows.data() + i, stride, column, v[0], v[1], v[2], v[3]);
        for (int k = 0; k < 4; ++k) store(v[k], out[k] + i);
    }
}

void scatter(float* base, std::span<const std::int32_t> rows, std::size_t stride, std::size_t column,
             const float* const in[4]) {
    for (std::size_t i = 0; i < rows.size(); i += kLanes) {
        scatter_rows(base, rows.data() + i, stride, column, load(in[0] + i), load(in[1] + i), load(in[2] + i),
                     load(in[3] + i));
    }
}

void add_to_rows(float* base, std::span<const std::int32_t> rows, std::size_t stride, const float* const in[8], std::int32_t limit) {
    for (std::size_t i = 0; i < rows.size(); i += kLanes) {
        Floats v[8];
        for (int k = 0; k < 8; ++k) v[k] = load(in[k] + i);
        add_rows(base, rows.data() + i, stride, v, limit);
    }
}

std::size_t compress(std::span<const float> values, float limit, std::span<std::int32_t> out) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < values.size(); i += kLanes) {
        const Ints index = lane_numbers() + Ints{static_cast<std::int32_t>(i)};
        count += compress_store(index, load(values.data() + i) < limit, out.data() + count);
    }
    return count;
}

void integers(std::span<const std::int32_t> a, std::span<const std::int32_t> b, std::int32_t* const out[8]) {
    for (std::size_t i = 0; i < a.size(); i += kLanes) {
        const Ints x = load(a.data() + i);
        const Ints y = load_unaligned(b.data() + i);
        store(x + y, out[0] + i);
        store(x - y, out[1] + i);
        store(x & y, out[2] + i);
        store(x | y, out[3] + i);
        store(x ^ y, out[4] + i);
        store(select(x < y, Ints{1}, Ints{0}), out[5] + i);
        store(select(x == y, Ints{1}, Ints{0}), out[6] + i);
        store(as_ints(to_floats(x)), out[7] + i);
    }
}

bool masks() {
    bool right = true;
    for (int n = 0; n <= kLanes; ++n) {
        const Mask m = first_lanes(n);
        right = right && bits(m) == (1u << n) - 1u && any(m) == (n > 0) && none(m) == (n == 0) && all(m) == (n == kLanes);
        const Mask rest = !m;
        right = right && bits(rest) == (((1u << kLanes) - 1u) & ~bits(m)) && all(m | rest) && none(m & rest);
        right = right && bits(select(m, rest, m)) == 0;
    }
    return right;
}

}  // namespace
}  // namespace carom::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace carom::test {

HWY_EXPORT(unary);
HWY_EXPORT(binary);
HWY_EXPORT(comparison);
HWY_EXPORT(choose);
HWY_EXPORT(dots);
HWY_EXPORT(crosses);
HWY_EXPORT(gather);
HWY_EXPORT(scatter);
HWY_EXPORT(add_to_rows);
HWY_EXPORT(compress);
HWY_EXPORT(integers);
HWY_EXPORT(masks);

void run_unary(Unary op, std::span<const float> a, std::span<float> out) { HWY_DYNAMIC_DISPATCH(unary)(op, a, out); }
void run_binary(Binary op, std::span<const float> a, std::span<const float> b, std::span<float> out) {
    HWY_DYNAMIC_DISPATCH(binary)(op, a, b, out);
}
void run_comparison(Comparison op, std::span<const float> a, std::span<const float> b, std::span<std::int32_t> out) {
    HWY_DYNAMIC_DISPATCH(comparison)(op, a, b, out);
}
void run_select(std::span<const float> a, std::span<const float> b, std::span<float> out) {
    HWY_DYNAMIC_DISPATCH(choose)(a, b, out);
}
void run_dot(const float* const a[3], const float* const b[3], std::span<float> out) {
    HWY_DYNAMIC_DISPATCH(dots)(a, b, out);
}
void run_cross(const float* const a[3], const float* const b[3], float* const out[3], std::size_t count) {
    HWY_DYNAMIC_DISPATCH(crosses)(a, b, out, count);
}
void run_gather(const float* base, std::span<const std::int32_t> rows, std::size_t stride, std::size_t column,
                float* const out[4]) {
    HWY_DYNAMIC_DISPATCH(gather)(base, rows, stride, column, out);
}
void run_scatter(float* base, std::span<const std::int32_t> rows, std::size_t stride, std::size_t column,
                 const float* const in[4]) {
    HWY_DYNAMIC_DISPATCH(scatter)(base, rows, stride, column, in);
}
void run_add_rows(float* base, std::span<const std::int32_t> rows, std::size_t stride, const float* const in[8], std::int32_t limit) {
    HWY_DYNAMIC_DISPATCH(add_to_rows)(base, rows, stride, in, limit);
}
std::size_t run_compress(std::span<const float> values, float limit, std::span<std::int32_t> out) {
    return HWY_DYNAMIC_DISPATCH(compress)(values, limit, out);
}
void run_integers(std::span<const std::int32_t> a, std::span<const std::int32_t> b, std::int32_t* const out[8]) {
    HWY_DYNAMIC_DISPATCH(integers)(a, b, out);
}
bool masks_are_right() { return HWY_DYNAMIC_DISPATCH(masks)(); }

}  // namespace carom::test

#endif  // HWY_ONCE
