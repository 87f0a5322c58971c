// The factor in blocks against a dense one of Eigen; its cost as counted; the same bits at every width of the machine's lanes.
#include <carom/dynamics/detail/block_cholesky.hpp>

#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/dynamics/detail/minimum_degree.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <cstdint>
#include <utility>
#include <vector>

namespace carom::dynamics {
namespace {

constexpr int kN = kBlockSize;

struct Problem {
    std::int32_t rows = 0;
    std::vector<BlockEdge> edges;
    Eigen::MatrixXd matrix;
};

/// A positive definite matrix on a random graph: for each edge a random 6 x 12 J adds Jᵀ J, and each row its own Jᵀ J.
Problem random_problem(std::uint64_t seed, std::int32_t rows, int edges) {
    Random random(seed);
    Problem p{rows, {}, Eigen::MatrixXd::Zero(kN * rows, kN * rows)};
    const auto draw = [&](int columns) {
        Eigen::MatrixXd j(kN, columns);
        for (int r = 0; r < kN; ++r) {
            for (int c = 0; c < columns; ++c) j(r, c) = random.range(-1, 1);
        }
        return j;
    };
    for (std::int32_t row = 0; row < rows; ++row) {
        const Eigen::MatrixXd j = draw(kN);
        p.matrix.block(kN * row, kN * row, kN, kN) += j.transpose() * j + 0.1 * Eigen::MatrixXd::Identity(kN, kN);
    }
    while (static_cast<int>(p.edges.size()) < edges) {
        const auto a = static_cast<std::int32_t>(random.range(0, rows)), b = static_cast<std::int32_t>(random.range(0, rows));
        if (a == b) continue;
        p.edges.push_back({a, b});
        const Eigen::MatrixXd j = draw(2 * kN), k = j.transpose() * j;
        p.matrix.block(kN * a, kN * a, kN, kN) += k.topLeftCorner(kN, kN);
        p.matrix.block(kN * b, kN * b, kN, kN) += k.bottomRightCorner(kN, kN);
        p.matrix.block(kN * a, kN * b, kN, kN) += k.topRightCorner(kN, kN);
        p.matrix.block(kN * b, kN * a, kN, kN) += k.bottomLeftCorner(kN, kN);
    }
    return p;
}

/// Edges may be listed twice: the first of each pair of rows brings the whole entry.
void fill(const Problem& p, BlockCholesky& factor) {
    factor.clear();
    const auto copy = [&](Block6& block, std::int32_t row, std::int32_t column) {
        for (int r = 0; r < kN; ++r) {
            for (int c = 0; c < kN; ++c) block.at(r, c) = p.matrix(kN * row + r, kN * column + c);
        }
    };
    for (std::int32_t row = 0; row < p.rows; ++row) copy(factor.diagonal(row), row, row);
    for (std::size_t e = 0; e < p.edges.size(); ++e) {
        const BlockPlace place = factor.place(e);
        const auto [a, b] = p.edges[e];
        place.transposed ? copy(factor.block(place.index), b, a) : copy(factor.block(place.index), a, b);
    }
}

std::vector<Vector6> right_hand_side(const Problem& p) {
    std::vector<Vector6> x(static_cast<std::size_t>(p.rows));
    for (std::size_t row = 0; row < x.size(); ++row) {
        for (std::size_t i = 0; i < kN; ++i) x[row][i] = static_cast<double>(row) - 2.5 * static_cast<double>(i);
    }
    return x;
}

TEST(BlockCholesky, SolvesAsADenseFactorDoes) {
    for (const int edges : {0, 3, 12, 40, 150}) {
        const Problem p = random_problem(71 + static_cast<std::uint64_t>(edges), 14, edges);
        BlockCholesky factor;
        ASSERT_TRUE(factor.analyse(p.rows, p.edges, 1'000'000));
        fill(p, factor);
        ASSERT_TRUE(factor.factorise());
        std::vector<Vector6> x = right_hand_side(p);
        Eigen::VectorXd b(kN * p.rows);
        for (int i = 0; i < kN * p.rows; ++i) b(i) = x[static_cast<std::size_t>(i / kN)][static_cast<std::size_t>(i % kN)];
        factor.solve(x);
        const Eigen::VectorXd exact = p.matrix.llt().solve(b);
        for (int i = 0; i < kN * p.rows; ++i) {
            // Condition numbers are below 1e4 here.
            EXPECT_NEAR(x[static_cast<std::size_t>(i / kN)][static_cast<std::size_t>(i % kN)], exact(i), 1e-10 * exact.norm()) << edges << " edges";
        }
    }
}

TEST(BlockCholesky, AChainIsFactorisedWithoutFill) {
    std::vector<BlockEdge> edges;
    for (std::int32_t i = 0; i + 1 < 1000; ++i) edges.push_back({i + 1, i});
    BlockCholesky factor;
    ASSERT_TRUE(factor.analyse(1000, edges, 10'000));
    EXPECT_EQ(factor.blocks(), 999u);
    EXPECT_EQ(factor.operations(), 999u * 3 + 1);
}

TEST(BlockCholesky, RefusesWhatCostsMoreThanItMay) {
    const Problem p = random_problem(5, 30, 120);
    BlockCholesky factor;
    ASSERT_TRUE(factor.analyse(p.rows, p.edges, 1'000'000));
    const std::size_t cost = factor.operations();
    EXPECT_TRUE(factor.analyse(p.rows, p.edges, cost));
    EXPECT_FALSE(factor.analyse(p.rows, p.edges, cost - 1));
}

// Cliques, chains, grids and random graphs: the verdict is that of the whole order, and comes before it where what is left is known to cost too much.
TEST(MinimumDegree, TheVerdictIsThatOfTheWholeOrderAndComesEarly) {
    std::vector<std::pair<std::int32_t, std::vector<BlockEdge>>> graphs(3);
    graphs[0].first = 40, graphs[1].first = 300, graphs[2].first = 400;
    for (std::int32_t a = 0; a < 40; ++a) {
        for (std::int32_t b = 0; b < a; ++b) graphs[0].second.push_back({a, b});
    }
    for (std::int32_t i = 0; i + 1 < 300; ++i) graphs[1].second.push_back({i, i + 1});
    for (std::int32_t i = 0; i < 400; ++i) {
        if (i % 20 != 0) graphs[2].second.push_back({i - 1, i});
        if (i >= 20) graphs[2].second.push_back({i - 20, i});
    }
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto rows = static_cast<std::int32_t>(5 * seed);
        graphs.push_back({rows, random_problem(seed, rows, static_cast<int>(3 * seed * (1 + seed % 4))).edges});
    }
    for (const auto& [rows, edges] : graphs) {
        SCOPED_TRACE(testing::Message() << rows << " rows, " << edges.size() << " edges");
        EliminationOrder order;
        ASSERT_TRUE(order_by_minimum_degree(rows, edges, 1'000'000'000, order));
        const std::size_t cost = order.operations;
        EXPECT_TRUE(order_by_minimum_degree(rows, edges, cost, order));
        EXPECT_EQ(order.operations, cost);
        EXPECT_FALSE(order_by_minimum_degree(rows, edges, cost - 1, order));
    }
    EliminationOrder order;
    EXPECT_FALSE(order_by_minimum_degree(40, graphs[0].second, 40 * 41 * 42 / 6 - 1, order));  // a clique costs 1 + 3 + 6 + ... + 40 * 41 / 2
    EXPECT_TRUE(order.row_at.empty()) << "known from the first row";
    EXPECT_TRUE(order_by_minimum_degree(40, graphs[0].second, 40 * 41 * 42 / 6, order));
}

TEST(BlockCholesky, SaysThatAMatrixIsNotPositiveDefinite) {
    Problem p = random_problem(9, 6, 8);
    p.matrix(20, 20) = -1.0;
    BlockCholesky factor;
    ASSERT_TRUE(factor.analyse(p.rows, p.edges, 10'000));
    fill(p, factor);
    EXPECT_FALSE(factor.factorise());
    p.matrix(20, 20) = std::numeric_limits<double>::quiet_NaN();
    fill(p, factor);
    EXPECT_FALSE(factor.factorise());
}

TEST(BlockCholesky, SameBitsAtEverySimdWidth) {
    const Problem p = random_problem(3, 20, 45);
    std::vector<std::uint64_t> first;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        BlockCholesky factor;
        ASSERT_TRUE(factor.analyse(p.rows, p.edges, 1'000'000));
        fill(p, factor);
        ASSERT_TRUE(factor.factorise());
        std::vector<Vector6> x = right_hand_side(p);
        factor.solve(x);
        std::vector<std::uint64_t> bits;
        for (const Vector6& v : x) {
            for (std::size_t i = 0; i < kN; ++i) bits.push_back(std::bit_cast<std::uint64_t>(v[i]));
        }
        if (first.empty()) first = bits;
        EXPECT_EQ(bits, first) << "width " << width;
    }
    set_simd_width(0);
}

}  // namespace
}  // namespace carom::dynamics
