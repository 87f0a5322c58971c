// Result, Status and the checks, with handlers that throw and handlers that return.
#include <carom/core/check.hpp>
#include <carom/core/result.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace carom {
namespace {

TEST(Result, HoldsAValueOrAnError) {
    Result<std::string> good(std::string("text"));
    ASSERT_TRUE(good);
    EXPECT_EQ(*good, "text");
    EXPECT_EQ(good->size(), 4u);
    EXPECT_THROW(static_cast<void>(good.error()), std::bad_variant_access);

    const Result<std::string> bad(Error{ErrorCode::Parse, "unexpected }", "scene.json:3"});
    ASSERT_FALSE(bad);
    EXPECT_EQ(bad.error().code, ErrorCode::Parse);
    EXPECT_EQ(bad.error().where, "scene.json:3");
    EXPECT_THROW(static_cast<void>(bad.value()), std::bad_variant_access);
}

TEST(Result, MovesItsValueOut) {
    Result<std::unique_ptr<int>> result(std::make_unique<int>(3));
    const std::unique_ptr<int> value = std::move(result).value();
    EXPECT_EQ(*value, 3);
}

TEST(Status, IsOkByDefault) {
    EXPECT_TRUE(Status{});
    EXPECT_TRUE(Status{}.ok());
    const Status bad(Error{ErrorCode::Io, "no such file", "a.obj"});
    EXPECT_FALSE(bad);
    EXPECT_EQ(bad.error().message, "no such file");
    EXPECT_THROW(static_cast<void>(Status{}.error()), std::bad_optional_access);
}

TEST(ErrorCode, NamesAreDistinct) {
    std::set<std::string> names;
    for (int code = 0; code <= static_cast<int>(ErrorCode::Io); ++code) names.insert(to_string(static_cast<ErrorCode>(code)));
    EXPECT_EQ(names.size(), static_cast<std::size_t>(ErrorCode::Io) + 1);
    EXPECT_FALSE(names.contains("unknown"));
    EXPECT_STREQ(to_string(ErrorCode::DeadId), "DeadId");
}

int guarded(int x) {
    CAROM_REQUIRE(x >= 0, ErrorCode::InvalidArgument, "x must not be negative", -1);
    return x * 2;
}

void guarded_void(bool fine, int& changed) {
    CAROM_REQUIRE(fine, ErrorCode::NotFinite, "not fine");
    ++changed;
}

TEST(Require, ThrowsByDefaultAndSaysWhere) {
    EXPECT_EQ(guarded(4), 8);
    try {
        guarded(-1);
        FAIL() << "nothing was thrown";
    } catch (const MisuseError& misuse) {
        EXPECT_EQ(misuse.error().code, ErrorCode::InvalidArgument);
        EXPECT_EQ(misuse.error().message, "x must not be negative");
        EXPECT_NE(misuse.error().where.find("guarded"), std::string::npos);
        EXPECT_NE(std::string(misuse.what()).find("x must not be negative"), std::string::npos);
    }
    EXPECT_THROW(guarded(-1), std::invalid_argument);
}

std::vector<Error> g_seen;

TEST(Require, ReturnsTheNullValueIfTheHandlerReturns) {
    g_seen.clear();
    const ErrorHandler before = set_error_handler([](const Error& error) { g_seen.push_back(error); });
    int changed = 0;
    EXPECT_EQ(guarded(-3), -1);
    guarded_void(false, changed);
    EXPECT_EQ(changed, 0);
    EXPECT_EQ(g_seen.size(), 2u);
    EXPECT_EQ(g_seen[1].code, ErrorCode::NotFinite);
    guarded_void(true, changed);
    EXPECT_EQ(changed, 1);
    EXPECT_EQ(g_seen.size(), 2u);
    EXPECT_NE(set_error_handler(nullptr), nullptr);
    EXPECT_THROW(guarded(-1), MisuseError);  // null brought the default back
    set_error_handler(before);
}

#if !defined(NDEBUG) || defined(CAROM_ENABLE_ASSERT)
TEST(AssertDeathTest, AbortsWithTheCondition) {
    ::testing::FLAGS_gtest_death_test_style = "threadsafe";
    EXPECT_DEATH(CAROM_ASSERT(1 + 1 == 3), "1 \\+ 1 == 3");
}
#else
TEST(Assert, IsNotEvaluatedInReleaseBuilds) {
    int evaluated = 0;
    CAROM_ASSERT(++evaluated > 0);
    EXPECT_EQ(evaluated, 0);
}
#endif

}  // namespace
}  // namespace carom
