// Two facing polygons, all sides at once, against one after the other: the same points, to the bit.
#include "oracle.hpp"

#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/polygon_contact.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

using namespace test;
using detail::FaceCorner;

// A convex polygon in a plane that leans a little against that of contact.
struct Drawn {
    std::vector<FaceCorner> corners;
    dvec3 normal{0.0};
    double offset = 0.0;
    [[nodiscard]] detail::FacePolygon polygon() const { return {corners, normal, offset}; }
};

// @param turn  +1: counter-clockwise about the plane's normal; -1: the other way round, as the second polygon is seen.
Drawn drawn(Random& r, std::size_t count, double turn, double step, const detail::ContactPlane& plane) {
    Drawn out;
    const dvec3 lean = glm::normalize(plane.normal + r.range(0.0, 0.2) * random_direction(r));
    out.normal = turn * lean;
    out.offset = r.range(-0.02, 0.02);
    const double start = r.range(0.0, 6.0), shift_u = r.range(-0.8, 0.8), shift_w = r.range(-0.8, 0.8);
    for (std::size_t k = 0; k < count; ++k) {
        const double angle = start + turn * 6.283185307179586 * static_cast<double>(k) / static_cast<double>(count);
        double u = shift_u + std::cos(angle), w = shift_w + 0.7 * std::sin(angle);
        if (step > 0.0) u = step * std::round(u / step), w = step * std::round(w / step);  // corners and sides that coincide
        const dvec3 flat = u * plane.axis_u + w * plane.axis_w;
        const double height = (turn * out.offset - glm::dot(lean, flat)) / glm::dot(lean, plane.normal);
        const auto number = static_cast<std::uint32_t>(k);
        out.corners.push_back({flat + height * plane.normal, u, w, number, 10 + number});
    }
    return out;
}

bool same(const detail::Candidate& a, const detail::Candidate& b) {
    return a.position == b.position && a.separation == b.separation && a.u == b.u && a.w == b.w && a.feature == b.feature;
}

TEST(PolygonLanes, AllSidesAtOnceGiveThePointsOfOneAfterTheOther) {
    Random r(31);
    std::size_t corners = 0, crossings = 0, none = 0, left_out = 0;
    for (int i = 0; i < 6000; ++i) {
        const detail::ContactPlane plane = detail::contact_plane(random_direction(r), r.range(0.0, 0.2), i % 2 == 0 ? 1e-9 : 0.0);
        const auto count = [&] { return static_cast<std::size_t>(r.range(3.0, 8.999)); };
        const double step = i % 3 == 0 ? 0.5 : 0.0;
        const Drawn first = drawn(r, count(), 1.0, step, plane), second = drawn(r, count(), -1.0, step, plane);
        std::vector<double> sides(2 * first.corners.size() * second.corners.size());
        std::vector<detail::Candidate> one_by_one, all;
        detail::collect_face_contact(first.polygon(), second.polygon(), plane, sides, one_by_one);
        detail::ContactPlane wide = plane;
        wide.margin = 10.0;
        detail::collect_face_contact(first.polygon(), second.polygon(), wide, sides, all);
        left_out += all.size() - one_by_one.size();
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            std::vector<detail::Candidate> at_once;
            detail::collect_face_contact(first.polygon(), second.polygon(), plane, at_once);
            ASSERT_EQ(at_once.size(), one_by_one.size()) << i << ", width " << width;
            for (std::size_t k = 0; k < at_once.size(); ++k)
                ASSERT_TRUE(same(at_once[k], one_by_one[k])) << i << ", point " << k << ", width " << width;
        }
        for (const detail::Candidate& c : one_by_one) {
            bool is_corner = false;
            for (std::uint32_t v = 0; v < 8; ++v) {
                is_corner |= c.feature == detail::feature_name(detail::FeatureKind::VertexOfFirst, v, 0) ||
                             c.feature == detail::feature_name(detail::FeatureKind::VertexOfSecond, 0, v);
            }
            ++(is_corner ? corners : crossings);
        }
        none += all.empty() ? 1 : 0;
    }
    set_simd_width(0);
    EXPECT_GT(corners, 10'000u);
    EXPECT_GT(crossings, 5'000u);
    EXPECT_GT(none, 50u);
    EXPECT_GT(left_out, 1'000u);
}

}  // namespace
}  // namespace carom
