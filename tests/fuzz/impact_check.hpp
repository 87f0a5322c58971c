// What must hold for any moving features of raw bits: times of impact that are never late, for the fuzzer and for tests, judged by the roots of
// their cubic, isolated in rationals.
//
//   EXPECT_EQ(test::impact_fault(bytes), "");
#pragma once

#include <fuzz/shapes_check.hpp>
#include <support/exact_impact.hpp>

#include <carom/narrowphase/deforming_triangles.hpp>

namespace carom::test {

[[nodiscard]] inline dvec3 draw_point(RawBytes& bytes) {
    const double x = bytes.coordinate(), y = bytes.coordinate();
    return {x, y, bytes.coordinate()};
}
/// @param coarse  on a grid of sixteenths, where ties are common and rationals short.
[[nodiscard]] inline dvec3 draw_corner(RawBytes& bytes, bool coarse) {
    if (!coarse) return draw_point(bytes);
    const auto step = [&] { return static_cast<double>(static_cast<std::int8_t>(bytes.byte())) / 16.0; };
    const double x = step(), y = step();
    return {x, y, step()};
}
[[nodiscard]] inline MovingPoint draw_moving(RawBytes& bytes, bool coarse) {
    const dvec3 start = draw_corner(bytes, coarse);
    return {start, bytes.byte() % 4 == 0 ? start : draw_corner(bytes, coarse)};
}
inline void draw(RawBytes& bytes, bool coarse, VertexFaceMotion& m) {
    m.vertex = draw_moving(bytes, coarse);
    for (MovingPoint& p : m.face) p = draw_moving(bytes, coarse);
    if (bytes.byte() % 8 == 0) m.face[1] = m.face[0];
}
inline void draw(RawBytes& bytes, bool coarse, EdgeEdgeMotion& m) {
    for (MovingPoint& p : m.a) p = draw_moving(bytes, coarse);
    for (MovingPoint& p : m.b) p = draw_moving(bytes, coarse);
    if (bytes.byte() % 8 == 0) m.a[1] = m.a[0];
}

[[nodiscard]] inline bool are_finite(const MovingPoint& p) { return is_finite(p.start) && is_finite(p.end); }
[[nodiscard]] inline bool are_finite(const VertexFaceMotion& m) {
    return are_finite(m.vertex) && are_finite(m.face[0]) && are_finite(m.face[1]) && are_finite(m.face[2]);
}
[[nodiscard]] inline bool are_finite(const EdgeEdgeMotion& m) {
    return are_finite(m.a[0]) && are_finite(m.a[1]) && are_finite(m.b[0]) && are_finite(m.b[1]);
}

/// What is wrong with an answer whatever it is about.
[[nodiscard]] inline std::string form_fault(const Impact& impact, bool good_input) {
    if ((impact.status == ImpactStatus::Invalid) == good_input) return good_input ? "good input is called Invalid" : "bad input is answered";
    if (!(impact.t >= 0.0 && impact.t <= 1.0)) return "t is not in [0, 1]";
    return is_finite(impact.point) && is_finite(impact.normal) ? "" : "an answer that is not finite";
}

/// All but raw bits is judged, of which the rationals would be long.
template <class Motion>
[[nodiscard]] std::string deforming_fault(RawBytes& bytes, RawBytes::Style style) {
    const bool judged = style != RawBytes::Style::Raw;
    Motion m;
    draw(bytes, style == RawBytes::Style::Tame, m);
    const Impact impact = time_of_impact(m);
    if (std::string fault = form_fault(impact, are_finite(m)); !fault.empty()) return fault;
    if (!judged) return "";
    const exact::FirstMeeting truth = exact::first_meeting(m);
    if (truth.verdict != exact::Verdict::Meet) return "";
    if (!may_touch(impact.status)) return "features that meet are called separated";
    return exact::number(impact.t) > truth.latest ? "features are met later than in truth" : "";
}

[[nodiscard]] inline std::string impact_fault(std::span<const std::uint8_t> data) {
    RawBytes bytes(data);
    const RawBytes::Style style = RawBytes::style_of(data);
    return bytes.byte() % 2 == 0 ? deforming_fault<VertexFaceMotion>(bytes, style) : deforming_fault<EdgeEdgeMotion>(bytes, style);
}

}  // namespace carom::test
