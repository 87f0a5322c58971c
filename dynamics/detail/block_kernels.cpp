#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/dynamics/detail/block_kernels.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes_doubles.hpp>
#include <carom/core/types.hpp>
#include <carom/dynamics/detail/block_kernels.hpp>

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using dynamics::Block6;
using dynamics::BlockColumns;
using dynamics::kBlockSize;
using dynamics::kBlockStride;
using dynamics::Vector6;

// Registers that hold a column: at 2 lanes the padding is left out.
constexpr int kParts = (kBlockSize + kDoubleLanes - 1) / kDoubleLanes;

HWY_INLINE const double* column_of(const Block6& block, int column) { return block.entries.data() + column * kBlockStride; }
HWY_INLINE double* column_of(Block6& block, int column) { return block.entries.data() + column * kBlockStride; }

// out -= b cᵀ
HWY_INLINE void subtract_product(Block6& out, const Block6& b, const Block6& c) {
    for (int part = 0; part < kParts; ++part) {
        const int row = part * kDoubleLanes;
        const Doubles b0 = load(column_of(b, 0) + row), b1 = load(column_of(b, 1) + row), b2 = load(column_of(b, 2) + row);
        const Doubles b3 = load(column_of(b, 3) + row), b4 = load(column_of(b, 4) + row), b5 = load(column_of(b, 5) + row);
        for (int column = 0; column < kBlockSize; ++column) {
            Doubles sum = load(column_of(out, column) + row);
            sum = sum - b0 * Doubles(c.at(column, 0));
            sum = sum - b1 * Doubles(c.at(column, 1));
            sum = sum - b2 * Doubles(c.at(column, 2));
            sum = sum - b3 * Doubles(c.at(column, 3));
            sum = sum - b4 * Doubles(c.at(column, 4));
            sum = sum - b5 * Doubles(c.at(column, 5));
            store(sum, column_of(out, column) + row);
        }
    }
}

// Lower factor in place, with the reciprocals of its diagonal on the diagonal. What is above the diagonal is overwritten by anything.
HWY_INLINE bool factorise_block(Block6& block) {
    for (int k = 0; k < kBlockSize; ++k) {
        const double pivot = block.at(k, k);
        if (!(pivot > 0.0) || !is_finite(pivot)) return false;
        const double inverse = 1.0 / std::sqrt(pivot);
        for (int row = 0; row < kBlockSize; row += kDoubleLanes) {
            store(load(column_of(block, k) + row) * Doubles(inverse), column_of(block, k) + row);
        }
        for (int column = k + 1; column < kBlockSize; ++column) {
            const Doubles factor(block.at(column, k));
            for (int row = 0; row < kBlockSize; row += kDoubleLanes) {
                store(load(column_of(block, column) + row) - load(column_of(block, k) + row) * factor, column_of(block, column) + row);
            }
        }
        block.at(k, k) = inverse;
    }
    return true;
}

// block <- block l⁻ᵀ
HWY_INLINE void divide_by_transposed(Block6& block, const Block6& l) {
    for (int row = 0; row < kBlockSize; row += kDoubleLanes) {
        for (int column = 0; column < kBlockSize; ++column) {
            Doubles sum = load(column_of(block, column) + row);
            for (int k = 0; k < column; ++k) sum = sum - load(column_of(block, k) + row) * Doubles(l.at(column, k));
            store(sum * Doubles(l.at(column, column)), column_of(block, column) + row);
        }
    }
}

// x <- l⁻¹ x
HWY_INLINE void solve_lower(const Block6& l, Vector6& x) {
    for (int k = 0; k < kBlockSize; ++k) {
        const double value = x[static_cast<std::size_t>(k)] * l.at(k, k);
        x[static_cast<std::size_t>(k)] = value;
        for (int row = k + 1; row < kBlockSize; ++row) x[static_cast<std::size_t>(row)] -= l.at(row, k) * value;
    }
}

// x <- l⁻ᵀ x
HWY_INLINE void solve_upper(const Block6& l, Vector6& x) {
    for (int k = kBlockSize - 1; k >= 0; --k) {
        double value = x[static_cast<std::size_t>(k)];
        for (int row = k + 1; row < kBlockSize; ++row) value -= l.at(row, k) * x[static_cast<std::size_t>(row)];
        x[static_cast<std::size_t>(k)] = value * l.at(k, k);
    }
}

// out -= m x
HWY_INLINE void subtract(Vector6& out, const Block6& m, const Vector6& x) {
    for (int row = 0; row < kBlockSize; row += kDoubleLanes) {
        Doubles sum = load(out.entries.data() + row);
        for (int k = 0; k < kBlockSize; ++k) sum = sum - load(column_of(m, k) + row) * Doubles(x[static_cast<std::size_t>(k)]);
        store(sum, out.entries.data() + row);
    }
}

// out -= mᵀ x
HWY_INLINE void subtract_transposed(Vector6& out, const Block6& m, const Vector6& x) {
    for (int k = 0; k < kBlockSize; ++k) {
        const double* const column = column_of(m, k);
        const double sum = ((column[0] * x[0] + column[1] * x[1]) + (column[2] * x[2] + column[3] * x[3])) + (column[4] * x[4] + column[5] * x[5]);
        out[static_cast<std::size_t>(k)] -= sum;
    }
}

bool Factorise(const BlockColumns& c) {
    const std::int32_t* target = c.targets.data();
    for (std::size_t column = 0; column < c.diagonals.size(); ++column) {
        Block6& diagonal = c.diagonals[column];
        if (!factorise_block(diagonal)) return false;
        const auto begin = static_cast<std::size_t>(c.starts[column]), end = static_cast<std::size_t>(c.starts[column + 1]);
        for (std::size_t i = begin; i < end; ++i) divide_by_transposed(c.values[i], diagonal);
        for (std::size_t i = begin; i < end; ++i) {
            const Block6& block = c.values[i];
            subtract_product(c.diagonals[static_cast<std::size_t>(c.rows[i])], block, block);
            for (std::size_t k = i + 1; k < end; ++k) subtract_product(c.values[static_cast<std::size_t>(*target++)], c.values[k], block);
        }
    }
    return true;
}

void Solve(const BlockColumns& c, std::span<Vector6> x) {
    const std::size_t count = c.diagonals.size();
    const auto begin = [&](std::size_t column) { return static_cast<std::size_t>(c.starts[column]); };
    for (std::size_t p = 0; p < count; ++p) {
        solve_lower(c.diagonals[p], x[p]);
        for (std::size_t i = begin(p); i < begin(p + 1); ++i) subtract(x[static_cast<std::size_t>(c.rows[i])], c.values[i], x[p]);
    }
    for (std::size_t p = count; p-- > 0;) {
        for (std::size_t i = begin(p); i < begin(p + 1); ++i) subtract_transposed(x[p], c.values[i], x[static_cast<std::size_t>(c.rows[i])]);
        solve_upper(c.diagonals[p], x[p]);
    }
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
HWY_EXPORT(Factorise);
HWY_EXPORT(Solve);

namespace dynamics {

bool factorise(const BlockColumns& columns) noexcept { return HWY_DYNAMIC_DISPATCH(Factorise)(columns); }
void solve(const BlockColumns& factor, std::span<Vector6> x) noexcept { HWY_DYNAMIC_DISPATCH(Solve)(factor, x); }

}  // namespace dynamics
}  // namespace carom
#endif
