// Boxes as the rows that lanes read: many at once are those of one at a time, to the bit.
#include "oracle.hpp"

#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace carom {
namespace {

using namespace test;

TEST(BoxLines, ManyAreThoseOfOneToTheBit) {
    Random r(31);
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    for (int i = 0; i < 150; ++i) {
        const double reach = std::pow(10.0, r.range(-6.0, i % 10 == 0 ? 40.0 : 8.0));
        poses.push_back({random_direction(r) * reach, random_rotation(r)});
        shapes.push_back(i % 7 == 3 ? Shape{Sphere{1.0f}} : Shape{Box{vec3(random_direction(r))}});
    }
    std::vector<const Shape*> placed;
    std::vector<std::uint32_t> numbers, places;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        placed.push_back(&shapes[i]);
        if (std::holds_alternative<Box>(shapes[i])) numbers.push_back(static_cast<std::uint32_t>(i));
    }
    ASSERT_NE(numbers.size() % 16, 0u);
    for (std::size_t k = 0; k < numbers.size(); ++k) places.push_back(static_cast<std::uint32_t>((7 * k + 3) % numbers.size()));
    ASSERT_NE(numbers.size() % 7, 0u);  // so that each place is taken once
    int far = 0;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (const std::size_t count : {numbers.size(), std::size_t{1}, std::size_t{0}}) {
            detail::BoxLine untouched{};
            untouched.axis[0][0] = 7.0f;
            std::vector<detail::BoxLine> lines(shapes.size(), untouched);
            detail::write_box_lines({placed, poses}, std::span(numbers).first(count), std::span(places).first(count), lines);
            std::vector<detail::BoxLine> expected(shapes.size(), untouched);
            for (std::size_t k = 0; k < count; ++k) expected[places[k]] = detail::box_line(std::get<Box>(shapes[numbers[k]]), poses[numbers[k]]);
            for (std::size_t i = 0; i < lines.size(); ++i) {
                if (expected[i].position[0][3] != 0.0f) {  // beyond floats: nothing else there means anything
                    ASSERT_EQ(lines[i].position[0][3], 1.0f);
                    ++far;
                } else {
                    ASSERT_EQ(std::memcmp(&lines[i], &expected[i], sizeof(detail::BoxLine)), 0) << i << ", width " << width;
                }
            }
        }
    }
    set_simd_width(0);
    EXPECT_GT(far, 0);
}

}  // namespace
}  // namespace carom
