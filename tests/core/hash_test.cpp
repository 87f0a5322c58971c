#include <carom/core/hash.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string_view>
#include <vector>

namespace carom {
namespace {

std::uint64_t hash_of(std::string_view text) {
    StateHash hash;
    hash.add(std::as_bytes(std::span(text.data(), text.size())));
    return hash.digest();
}

TEST(StateHash, IsXxh3) {
    EXPECT_EQ(to_hex(hash_of("")), "2d06800538d394c2");  // the published value of XXH3_64bits of nothing
    EXPECT_NE(hash_of("a"), hash_of("b"));
}

TEST(StateHash, DependsOnBitsAndOrderAlone) {
    std::vector<std::byte> bytes(1000);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7);
    StateHash whole, parts;
    whole.add(std::span<const std::byte>(bytes));
    for (std::size_t i = 0; i < bytes.size(); i += 13) {
        parts.add(std::span<const std::byte>(bytes).subspan(i, std::min<std::size_t>(13, bytes.size() - i)));
    }
    EXPECT_EQ(whole.digest(), parts.digest());
    StateHash ab, ba;
    ab.add(1.0), ab.add(2.0);
    ba.add(2.0), ba.add(1.0);
    EXPECT_NE(ab.digest(), ba.digest());
}

TEST(StateHash, TellsEveryBitApart) {
    const auto of = [](double x) {
        StateHash hash;
        hash.add(x);
        return hash.digest();
    };
    EXPECT_NE(of(0.0), of(-0.0));
    EXPECT_NE(of(1.0), of(1.0 + std::numeric_limits<double>::epsilon()));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(of(nan), of(-nan));
}

TEST(StateHash, APoseIsItsNumbersInOrder) {
    const Pose pose{{1.0, -2.0, 3.0}, {0.5, 0.1, 0.2, 0.3}};
    StateHash together, apart, number;
    together.add(pose);
    for (const double x : {1.0, -2.0, 3.0, 0.5, 0.1, 0.2, 0.3}) apart.add(x);
    EXPECT_EQ(together.digest(), apart.digest());
    number.add(std::uint64_t{0x0102030405060708});
    const unsigned char little[] = {8, 7, 6, 5, 4, 3, 2, 1};
    StateHash bytes;
    bytes.add(std::as_bytes(std::span(little)));
    EXPECT_EQ(number.digest(), bytes.digest());
}

TEST(StateHash, DigestMayBeAskedMidway) {
    StateHash asked, straight;
    asked.add(1.0);
    const std::uint64_t midway = asked.digest();
    EXPECT_EQ(asked.digest(), midway);
    asked.add(2.0);
    straight.add(1.0), straight.add(2.0);
    EXPECT_EQ(asked.digest(), straight.digest());
    EXPECT_NE(asked.digest(), midway);
}

TEST(ToHex, IsSixteenLowerCaseDigits) {
    EXPECT_EQ(to_hex(0), "0000000000000000");
    EXPECT_EQ(to_hex(0x0123456789abcdefu), "0123456789abcdef");
    EXPECT_EQ(to_hex(~std::uint64_t{0}), "ffffffffffffffff");
}

}  // namespace
}  // namespace carom
