// Steps that take so long on one thread, and so long on several.
#include <carom/dynamics/detail/share_choice.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace carom::dynamics {
namespace {

struct Sums {
    int shared = 0;
    double spent = 0.0;
};

/// The next steps; of those a few take much longer, as when somebody else had the processor.
Sums run(ShareChoice& choice, std::size_t bodies, double alone, double together, int steps) {
    Sums sum;
    for (int i = 0; i < steps; ++i) {
        const bool shared = choice.next(bodies);
        const double took = (shared ? together : alone) * (i % 37 == 5 ? 8.0 : 1.0);
        choice.took(took, shared);
        sum.shared += shared ? 1 : 0;
        sum.spent += shared ? together : alone;
    }
    return sum;
}

TEST(ShareChoice, TheFirstStepGoesByTheBodies) {
    EXPECT_FALSE(ShareChoice().next(ShareChoice::kManyBodies - 1));
    EXPECT_TRUE(ShareChoice().next(ShareChoice::kManyBodies));
}

TEST(ShareChoice, WhatIsLittleIsNeverShared) {
    ShareChoice choice;
    EXPECT_EQ(run(choice, 100, 0.1, 0.01, 5000).shared, 0);
}

TEST(ShareChoice, WhatIsMuchIsNeverTriedOnOne) {
    ShareChoice choice;
    EXPECT_EQ(run(choice, 4000, 8.0, 4.5, 5000).shared, 5000);
}

TEST(ShareChoice, InBetweenTheShorterIsKeptAtLittleCost) {
    for (const std::size_t bodies : {100u, 1000u}) {
        for (const double together : {0.25, 0.39, 0.45, 0.9}) {
            ShareChoice choice;
            const double alone = 0.4;
            const Sums sum = run(choice, bodies, alone, together, 4000);
            EXPECT_LT(sum.spent, 4000 * 1.03 * std::min(alone, together)) << together;
            if (together < 0.3) {
                EXPECT_GT(sum.shared, 3500);
            } else if (together > 0.41) {
                EXPECT_LT(sum.shared, 500);
            }
        }
    }
}

TEST(ShareChoice, FewBodiesWithMuchToDoAreSharedSoon) {
    ShareChoice choice;
    EXPECT_GT(run(choice, 50, 6.0, 3.5, 100).shared, 70);
}

TEST(ShareChoice, FollowsTheScene) {
    ShareChoice choice;
    run(choice, 1000, 6.0, 3.5, 300);
    EXPECT_EQ(run(choice, 1000, 6.0, 3.5, 300).shared, 300);
    EXPECT_LT(run(choice, 1000, 0.1, 0.13, 2000).shared, 100) << "all has gone";
    EXPECT_GT(run(choice, 1000, 6.0, 3.5, 2000).shared, 1900) << "and come again";
}

}  // namespace
}  // namespace carom::dynamics
