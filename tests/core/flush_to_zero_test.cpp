// Numbers next to zero are zero while it lives, and no longer.
#include <carom/core/flush_to_zero.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace carom {
namespace {

/// Read anew each time: a compiler would work the products out beforehand.
volatile float small = std::numeric_limits<float>::min();
volatile float half = 0.5f;

float made() { return small * half; }
float taken() {
    volatile float denormal = std::numeric_limits<float>::denorm_min();
    const float grown = denormal * 1e30f;
    return grown;
}

TEST(FlushToZero, LastsAsLongAsItLives) {
#if defined(__SSE2__)
    EXPECT_GT(made(), 0.0f);
    EXPECT_GT(taken(), 0.0f);
    {
        const FlushToZero outer;
        EXPECT_EQ(made(), 0.0f);
        EXPECT_EQ(taken(), 0.0f);
        {
            const FlushToZero inner;
            EXPECT_EQ(made(), 0.0f);
        }
        EXPECT_EQ(made(), 0.0f) << "the outer one lives on";
    }
    EXPECT_GT(made(), 0.0f);
    EXPECT_GT(taken(), 0.0f);
#else
    GTEST_SKIP() << "this processor has no such setting here";
#endif
}

}  // namespace
}  // namespace carom
