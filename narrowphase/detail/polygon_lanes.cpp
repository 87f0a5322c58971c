#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/polygon_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/bundle.hpp>
#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/polygon_contact.hpp>

#include <bit>
#include <cmath>
#include <cstdint>

#ifndef CAROM_NARROWPHASE_POLYGON_LANES_ONCE
#define CAROM_NARROWPHASE_POLYGON_LANES_ONCE
namespace carom::detail {
namespace {

constexpr std::size_t kMost = kDoubleBundleWidth;

// A polygon in the plane of contact, its corners in lanes and after them the first one again.
struct Outline {
    DoubleBundle u, w, next_u, next_w;
    std::size_t count = 0;
};

// How two outlines lie: bit k is corner k of the first or the side that begins there.
struct Crossings {
    DoubleBundle of_first[kMost];       // by corner of the second: on which side of each side of the first it lies
    DoubleBundle of_second[kMost];      // by side of the second: on which side of it each corner of the first lies
    std::uint32_t inside_first = 0;     // corners of the first over the second
    std::uint32_t inside_second = 0;    // a bit each corner of the second
    std::uint32_t crossed[kMost] = {};  // by side of the second: those of the first that cross it
};

}  // namespace
}  // namespace carom::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

// One step of lanes: corners and sides of the first from `lane` on, against all of the second.
struct Step {
    std::uint32_t inside_first = 0, over_first[kMost] = {}, behind_first[kMost] = {}, behind_second[kMost] = {};
};

HWY_INLINE Step compare(const Outline& first, const Outline& second, double tolerance, int lane, Crossings& out) {
    const Doubles u = load(first.u.lane + lane), w = load(first.w.lane + lane), zero(0.0);
    const Doubles along_u = load(first.next_u.lane + lane) - u, along_w = load(first.next_w.lane + lane) - w;
    const Doubles least = Doubles(-tolerance) * (abs(along_u) + abs(along_w));
    Step step;
    step.inside_first = ~0u;
    for (std::size_t m = 0; m < second.count; ++m) {
        const double from_u = second.u.lane[m], from_w = second.w.lane[m];
        const double side_u = second.next_u.lane[m] - from_u, side_w = second.next_w.lane[m] - from_w;
        const Doubles of_first = along_u * (Doubles(from_w) - w) - along_w * (Doubles(from_u) - u);
        const Doubles of_second = Doubles(-side_u) * (w - Doubles(from_w)) - Doubles(-side_w) * (u - Doubles(from_u));
        const Doubles least_of_second(-tolerance * (std::abs(side_u) + std::abs(side_w)));
        store(of_first, out.of_first[m].lane + lane);
        store(of_second, out.of_second[m].lane + lane);
        step.over_first[m] = bits(of_first >= least);
        step.inside_first &= bits(of_second >= least_of_second);
        step.behind_first[m] = bits(of_first < zero);
        step.behind_second[m] = bits(of_second < zero);
    }
    return step;
}

void CompareOutlines(const Outline& first, const Outline& second, double tolerance, Crossings& out) {
    const std::uint32_t all = (1u << first.count) - 1;
    std::uint32_t over_first[kMost] = {}, behind_first[kMost] = {}, behind_second[kMost] = {};
    for (int lane = 0; lane < static_cast<int>(kMost); lane += kDoubleLanes) {
        const Step step = compare(first, second, tolerance, lane, out);
        out.inside_first |= (step.inside_first & ((1u << kDoubleLanes) - 1)) << lane;
        for (std::size_t m = 0; m < second.count; ++m) {
            over_first[m] |= step.over_first[m] << lane;
            behind_first[m] |= step.behind_first[m] << lane;
            behind_second[m] |= step.behind_second[m] << lane;
        }
    }
    out.inside_first &= all;
    for (std::size_t m = 0; m < second.count; ++m) {
        if ((over_first[m] & all) == all) out.inside_second |= 1u << m;
        const std::uint32_t here = behind_second[m] & all, next = here >> 1 | (here & 1) << (first.count - 1);
        out.crossed[m] = (here ^ next) & (behind_first[m] ^ behind_first[m + 1 < second.count ? m + 1 : 0]) & all;
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(CompareOutlines);

namespace {

void fill(const FacePolygon& polygon, Outline& out) {
    out.count = polygon.corners.size();
    for (std::size_t k = 0; k < out.count; ++k) {
        const FaceCorner& c = polygon.corners[k];
        const std::size_t before = (k == 0 ? out.count : k) - 1;
        out.u.lane[k] = out.next_u.lane[before] = c.u;
        out.w.lane[k] = out.next_w.lane[before] = c.w;
    }
}

}  // namespace

void collect_face_contact(const FacePolygon& first, const FacePolygon& second, const ContactPlane& plane, std::vector<Candidate>& points) {
    Outline a, b;
    fill(first, a);
    fill(second, b);
    Crossings found;
    HWY_DYNAMIC_DISPATCH(CompareOutlines)(a, b, plane.tolerance, found);
    const double slope_a = glm::dot(first.normal, plane.normal), slope_b = glm::dot(second.normal, plane.normal);
    for (std::uint32_t left = found.inside_first; left != 0; left &= left - 1) {
        add_corner(first.corners[static_cast<std::size_t>(std::countr_zero(left))], second, slope_b, plane, 1.0, points);
    }
    for (std::uint32_t left = found.inside_second; left != 0; left &= left - 1) {
        add_corner(second.corners[static_cast<std::size_t>(std::countr_zero(left))], first, slope_a, plane, -1.0, points);
    }
    std::uint32_t crossing = 0;  // sides of the first
    for (std::size_t m = 0; m < b.count; ++m) crossing |= found.crossed[m];
    for (; crossing != 0; crossing &= crossing - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(crossing)), k1 = k + 1 < a.count ? k + 1 : 0;
        for (std::size_t m = 0; m < b.count; ++m) {
            if ((found.crossed[m] >> k & 1) == 0) continue;
            const std::size_t m1 = m + 1 < b.count ? m + 1 : 0;
            add_crossing(first, k, second, m, {found.of_first[m].lane[k], found.of_first[m1].lane[k]},
                         {found.of_second[m].lane[k], found.of_second[m].lane[k1]}, plane, points);
        }
    }
}

}  // namespace carom::detail
#endif
