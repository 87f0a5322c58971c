// Every operation of the lanes gives scalar code's bits at every width that the machine has.
#include "core/lanes_kernels.hpp"

#include <carom/core/bundle.hpp>
#include <carom/core/check.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace carom::test {
namespace {

constexpr std::size_t kCount = 4096;

struct alignas(64) Array {
    float value[kCount] = {};
    [[nodiscard]] std::span<float> span() { return value; }
    [[nodiscard]] std::span<const float> span() const { return value; }
};
struct alignas(64) IntArray {
    std::int32_t value[kCount] = {};
};

/// Runs `body` once at every SIMD width, and goes back to the widest afterwards.
template <class F>
void at_every_width(F body) {
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        SCOPED_TRACE("width " + std::to_string(width));
        ASSERT_EQ(simd_width(), width);
        body();
    }
    set_simd_width(0);
}

const float kSpecial[] = {0.0f, -0.0f, 1.0f, -1.0f, 1.5f, 3.0f, 0x1p-149f, -0x1p-149f, 0x1.8p-130f, 0x1p-126f, 0x1.fffffep127f,
                          -0x1.fffffep127f, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN(), 16777217.0f};

/// Special values against each other first, then floats of random bits, so exponents of every size.
void fill(Array& a, Array& b) {
    Random random(0xCA40);
    for (std::size_t i = 0; i < kCount; ++i) {
        if (i < 256) {
            a.value[i] = kSpecial[i / 16];
            b.value[i] = kSpecial[i % 16];
        } else {
            a.value[i] = std::bit_cast<float>(static_cast<std::uint32_t>(random.unit() * 0x1p32));
            b.value[i] = std::bit_cast<float>(static_cast<std::uint32_t>(random.unit() * 0x1p32));
        }
    }
}

/// The same bits; NaNs match each other, since their sign and payload are not promised.
::testing::AssertionResult same(float got, float want) {
    if (std::isnan(got) && std::isnan(want)) return ::testing::AssertionSuccess();
    if (std::bit_cast<std::uint32_t>(got) == std::bit_cast<std::uint32_t>(want)) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << std::hexfloat << got << " is not " << want;
}

float scalar(Unary op, float a) {
    switch (op) {
        case Unary::Negate: return -a;
        case Unary::Abs: return std::fabs(a);
        case Unary::Sqrt: break;
    }
    return std::sqrt(a);
}

float scalar(Binary op, float a, float b) {
    switch (op) {
        case Binary::Add: return a + b;
        case Binary::Subtract: return a - b;
        case Binary::Multiply: return a * b;
        case Binary::Divide: return a / b;
        case Binary::Min: return a < b ? a : b;
        case Binary::Max: return a > b ? a : b;
        case Binary::CopySign: break;
    }
    return std::copysign(a, b);
}

bool scalar(Comparison op, float a, float b) {
    switch (op) {
        case Comparison::Less: return a < b;
        case Comparison::LessEqual: return a <= b;
        case Comparison::Greater: return a > b;
        case Comparison::GreaterEqual: return a >= b;
        case Comparison::Equal: return a == b;
        case Comparison::NotEqual: break;
    }
    return a != b;
}

TEST(Lanes, WidthsAreAscendingAndTheWidestIsTheDefault) {
    const std::vector<int> widths = available_simd_widths();
    ASSERT_FALSE(widths.empty());
    for (std::size_t i = 1; i < widths.size(); ++i) EXPECT_LT(widths[i - 1], widths[i]);
    EXPECT_EQ(simd_width(), widths.back());
    EXPECT_EQ(kBundleWidth % widths.back(), 0);
}

#if defined(__x86_64__) && defined(__GNUC__)
TEST(Lanes, TheProcessorsWidthsAreFound) {
    const std::vector<int> widths = available_simd_widths();
    const auto has = [&](int width) { return std::find(widths.begin(), widths.end(), width) != widths.end(); };
    EXPECT_EQ(has(8), __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"));
    EXPECT_EQ(has(16), __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"));
}
#endif

TEST(Lanes, AWidthThatIsMissingIsRefusedAndChangesNothing) {
    set_simd_width(available_simd_widths().front());
    const int before = simd_width();
    EXPECT_THROW(set_simd_width(3), MisuseError);
    EXPECT_THROW(set_simd_width(-1), MisuseError);
    EXPECT_THROW(set_simd_width(32), MisuseError);
    EXPECT_EQ(simd_width(), before);
    set_simd_width(0);
    EXPECT_EQ(simd_width(), available_simd_widths().back());
}

TEST(Lanes, UnaryOperationsMatchScalarBits) {
    auto a = std::make_unique<Array>(), b = std::make_unique<Array>(), out = std::make_unique<Array>();
    fill(*a, *b);
    at_every_width([&] {
        for (const Unary op : {Unary::Negate, Unary::Abs, Unary::Sqrt}) {
            run_unary(op, a->span(), out->span());
            for (std::size_t i = 0; i < kCount; ++i) {
                ASSERT_TRUE(same(out->value[i], scalar(op, a->value[i]))) << "op " << int(op) << " of " << a->value[i];
            }
        }
    });
}

TEST(Lanes, BinaryOperationsMatchScalarBits) {
    auto a = std::make_unique<Array>(), b = std::make_unique<Array>(), out = std::make_unique<Array>();
    fill(*a, *b);
    at_every_width([&] {
        for (const Binary op : {Binary::Add, Binary::Subtract, Binary::Multiply, Binary::Divide, Binary::Min, Binary::Max,
                                Binary::CopySign}) {
            run_binary(op, a->span(), b->span(), out->span());
            for (std::size_t i = 0; i < kCount; ++i) {
                ASSERT_TRUE(same(out->value[i], scalar(op, a->value[i], b->value[i])))
                    << "op " << int(op) << " of " << a->value[i] << " and " << b->value[i];
            }
        }
    });
}

TEST(Lanes, ComparisonsAndSelectMatchScalarCode) {
    auto a = std::make_unique<Array>(), b = std::make_unique<Array>(), out = std::make_unique<Array>();
    auto truth = std::make_unique<IntArray>();
    fill(*a, *b);
    at_every_width([&] {
        for (const Comparison op : {Comparison::Less, Comparison::LessEqual, Comparison::Greater, Comparison::GreaterEqual,
                                    Comparison::Equal, Comparison::NotEqual}) {
            run_comparison(op, a->span(), b->span(), truth->value);
            for (std::size_t i = 0; i < kCount; ++i) {
                ASSERT_EQ(truth->value[i] == 1, scalar(op, a->value[i], b->value[i]))
                    << "op " << int(op) << " of " << a->value[i] << " and " << b->value[i];
            }
        }
        run_select(a->span(), b->span(), out->span());
        for (std::size_t i = 0; i < kCount; ++i) {
            ASSERT_TRUE(same(out->value[i], a->value[i] < b->value[i] ? a->value[i] : b->value[i]));
        }
        EXPECT_TRUE(masks_are_right());
    });
}

TEST(Lanes, DotAndCrossRoundInTheStatedOrder) {
    auto arrays = std::make_unique<Array[]>(9);
    for (std::size_t k = 0; k < 6; k += 2) fill(arrays[k], arrays[k + 1]);
    Random random(7);
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t i = kCount / 2; i < kCount; ++i) arrays[k].value[i] = static_cast<float>(random.range(-2.0, 2.0));
    }
    const float* const a[3] = {arrays[0].value, arrays[2].value, arrays[4].value};
    const float* const b[3] = {arrays[1].value, arrays[3].value, arrays[5].value};
    float* const out[3] = {arrays[6].value, arrays[7].value, arrays[8].value};
    at_every_width([&] {
        run_cross(a, b, out, kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            for (int k = 0; k < 3; ++k) {
                const int p = (k + 1) % 3, q = (k + 2) % 3;
                const float left = a[p][i] * b[q][i], right = a[q][i] * b[p][i];
                ASSERT_TRUE(same(out[k][i], left - right));
            }
        }
        run_dot(a, b, {out[0], kCount});
        for (std::size_t i = 0; i < kCount; ++i) {
            const float x = a[0][i] * b[0][i], y = a[1][i] * b[1][i], z = a[2][i] * b[2][i];
            const float xy = x + y;
            ASSERT_TRUE(same(out[0][i], xy + z));
        }
    });
}

TEST(Lanes, RowsComeAndGoInLaneOrder) {
    constexpr std::size_t kRows = 97, kStride = 12, kColumn = 4, kReads = 256;
    struct alignas(64) Table {
        float value[kRows * kStride];
    };
    auto table = std::make_unique<Table>(), copy = std::make_unique<Table>(), want = std::make_unique<Table>();
    for (std::size_t i = 0; i < kRows * kStride; ++i) table->value[i] = static_cast<float>(i);
    Random random(0x9a7);
    std::vector<std::int32_t> rows(kReads);
    for (auto& row : rows) row = static_cast<std::int32_t>(random.unit() * double(kRows));  // with repeats
    auto arrays = std::make_unique<Array[]>(4);
    float* const out[4] = {arrays[0].value, arrays[1].value, arrays[2].value, arrays[3].value};
    at_every_width([&] {
        run_gather(table->value, rows, kStride, kColumn, out);
        for (std::size_t i = 0; i < kReads; ++i) {
            for (std::size_t k = 0; k < 4; ++k) {
                ASSERT_EQ(out[k][i], static_cast<float>(static_cast<std::size_t>(rows[i]) * kStride + kColumn + k));
            }
        }
        for (std::size_t i = 0; i < kReads; ++i) {  // lanes now differ even where they share a row
            for (std::size_t k = 0; k < 4; ++k) out[k][i] = static_cast<float>(i * 4 + k) + 0.5f;
        }
        *copy = *want = *table;
        run_scatter(copy->value, rows, kStride, kColumn, out);
        for (std::size_t i = 0; i < kReads; ++i) {
            for (std::size_t k = 0; k < 4; ++k) want->value[static_cast<std::size_t>(rows[i]) * kStride + kColumn + k] = out[k][i];
        }
        for (std::size_t i = 0; i < kRows * kStride; ++i) ASSERT_EQ(copy->value[i], want->value[i]) << i;
    });
}

TEST(Lanes, RowsGrowByTheirLanesUpToTheLimit) {
    constexpr std::size_t kRows = 64, kStride = 16;
    constexpr std::int32_t kLimit = 57;
    struct alignas(64) Table {
        float value[kRows * kStride];
    };
    auto table = std::make_unique<Table>(), copy = std::make_unique<Table>();
    Random random(0xadd);
    for (float& value : table->value) value = static_cast<float>(random.unit() - 0.5);
    std::vector<std::int32_t> rows(kRows);
    for (std::size_t i = 0; i < kRows; ++i) rows[i] = static_cast<std::int32_t>((i * 37) % kRows);  // each once
    auto arrays = std::make_unique<Array[]>(8);
    const float* in[8];
    for (std::size_t k = 0; k < 8; ++k) {
        in[k] = arrays[k].value;
        for (std::size_t i = 0; i < kRows; ++i) arrays[k].value[i] = static_cast<float>(random.unit() - 0.5);
    }
    at_every_width([&] {
        *copy = *table;
        run_add_rows(copy->value, rows, kStride, in, kLimit);
        for (std::size_t i = 0; i < kRows; ++i) {
            const std::size_t first = static_cast<std::size_t>(rows[i]) * kStride;
            for (std::size_t k = 0; k < kStride; ++k) {
                const float grown = k < 8 && rows[i] < kLimit ? table->value[first + k] + in[k][i] : table->value[first + k];
                ASSERT_EQ(copy->value[first + k], grown) << rows[i] << ' ' << k;
            }
        }
    });
}

TEST(Lanes, CompressKeepsTheOrder) {
    auto a = std::make_unique<Array>(), b = std::make_unique<Array>();
    auto out = std::make_unique<std::int32_t[]>(kCount + kBundleWidth);
    fill(*a, *b);
    at_every_width([&] {
        const std::size_t count = run_compress(a->span(), 0.5f, {out.get(), kCount + kBundleWidth});
        std::size_t next = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            if (a->value[i] < 0.5f) {
                ASSERT_LT(next, count);
                ASSERT_EQ(out[next++], static_cast<std::int32_t>(i));
            }
        }
        EXPECT_EQ(next, count);
    });
}

TEST(Lanes, IntegersMatchScalarCodeAndWrap) {
    auto a = std::make_unique<IntArray>(), b = std::make_unique<IntArray>();
    auto arrays = std::make_unique<IntArray[]>(8);
    Random random(0x1e7);
    const std::int32_t special[] = {0, 1, -1, std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min(),
                                    16777217, 7, -8};
    for (std::size_t i = 0; i < kCount; ++i) {
        a->value[i] = i < 64 ? special[i / 8] : static_cast<std::int32_t>(random.range(-0x1p31, 0x1p31));
        b->value[i] = i < 64 ? special[i % 8] : static_cast<std::int32_t>(random.range(-0x1p31, 0x1p31));
    }
    std::int32_t* out[8];
    for (int k = 0; k < 8; ++k) out[k] = arrays[static_cast<std::size_t>(k)].value;
    at_every_width([&] {
        run_integers(a->value, b->value, out);
        for (std::size_t i = 0; i < kCount; ++i) {
            const std::int32_t x = a->value[i], y = b->value[i];
            const auto ux = static_cast<std::uint32_t>(x), uy = static_cast<std::uint32_t>(y);
            const std::int32_t want[8] = {static_cast<std::int32_t>(ux + uy), static_cast<std::int32_t>(ux - uy), x & y, x | y,
                                          x ^ y, x < y, x == y, std::bit_cast<std::int32_t>(static_cast<float>(x))};
            for (int k = 0; k < 8; ++k) ASSERT_EQ(out[k][i], want[k]) << "op " << k << " of " << x << " and " << y;
        }
    });
}

}  // namespace
}  // namespace carom::test
