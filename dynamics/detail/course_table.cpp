#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/dynamics/detail/course_table.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes_doubles.hpp>
#include <carom/dynamics/detail/course_table.hpp>

#include <bit>
#include <cmath>
#include <span>

#ifndef CAROM_DYNAMICS_COURSE_TABLE_ONCE
#define CAROM_DYNAMICS_COURSE_TABLE_ONCE
namespace carom::dynamics {
namespace {

// Of lengths, and of their squares: more than first_chance() adds, which counts what rounding does for each radian of a step's turn, of which there are 7,000 at most.
constexpr double kLengthShare = 0x1p-26, kSquareShare = 0x1p-38;

double size_of(const dvec3& v) noexcept { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }
dvec3 at_start(const Course& course) noexcept { return course.at - course.begin * course.rate; }
double reach_of(const Ball& ball) noexcept {
    const Course& course = *ball.course;
    return ball.reach + course.play + kLengthShare * (size_of(course.at) + size_of(course.rate) + ball.reach);
}

/// Who asks.
struct Asker {
    dvec3 at{0.0}, rate{0.0};  ///< at `from`
    double from = 0.0, span = 0.0, reach = 0.0;
};

}  // namespace
}  // namespace carom::dynamics
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::dynamics::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

// Nearer than r at once; or coming nearer, and within r where they are nearest, or at the end if that is before. What is no number counts as near.
HWY_INLINE unsigned near_lanes(const CourseTable::CourseRows& rows, int lane, const Asker& asker) {
    const auto three = [lane](const DoubleBundle(&row)[3]) {
        return Doubles3{load(row[0].lane + lane), load(row[1].lane + lane), load(row[2].lane + lane)};
    };
    const Doubles3 rate = three(rows.rate), own{Doubles(asker.at.x), Doubles(asker.at.y), Doubles(asker.at.z)};
    const Doubles3 between = (three(rows.at) + rate * Doubles(asker.from)) - own;
    const Doubles3 along = rate - Doubles3{Doubles(asker.rate.x), Doubles(asker.rate.y), Doubles(asker.rate.z)};
    const Doubles r = load(rows.reach.lane + lane) + Doubles(asker.reach), share(kSquareShare), span(asker.span);
    const Doubles apart = dot(between, between), closing = -dot(between, along), speed = dot(along, along);
    const Doubles left = (apart - r * r) - share * (apart + r * r);
    const Doubles product = speed * left, square = closing * closing, root = (square - product) + share * (square + product);
    const Doubles at_end = (left - span * (closing + closing)) + span * span * speed,
                  slack = share * (apart + span * abs(closing) + span * span * speed);
    const DoubleMask goes_by = closing < speed * span;  // is nearest before the end
    const DoubleMask misses = (closing <= Doubles(0.0)) | (goes_by & (root < Doubles(0.0))) | ((!goes_by) & (at_end > slack));
    return bits(!((left > Doubles(0.0)) & misses));
}

void ListNear(std::span<const CourseTable::CourseRows> table, std::size_t count, const Asker& asker, std::vector<std::uint32_t>& found) {
    for (std::size_t b = 0; b < table.size(); ++b) {
        for (int lane = 0; lane < kDoubleBundleWidth; lane += kDoubleLanes) {
            for (unsigned left = near_lanes(table[b], lane, asker); left != 0; left &= left - 1) {
                const std::size_t k = b * kDoubleBundleWidth + static_cast<std::size_t>(lane + std::countr_zero(left));
                if (k < count) found.push_back(static_cast<std::uint32_t>(k));
            }
        }
    }
}

}  // namespace
}  // namespace carom::dynamics::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::dynamics {
HWY_EXPORT(ListNear);

void CourseTable::set(std::size_t k, const Ball& ball) noexcept {
    CourseRows& rows = rows_[k / kDoubleBundleWidth];
    const std::size_t lane = k % kDoubleBundleWidth;
    const dvec3 at = at_start(*ball.course);
    for (int i = 0; i < 3; ++i) rows.at[i].lane[lane] = at[i], rows.rate[i].lane[lane] = ball.course->rate[i];
    rows.reach.lane[lane] = reach_of(ball);
}

void CourseTable::list_near(const Ball& ball, double from, double to, double room, std::vector<std::uint32_t>& found) const {
    const Course& course = *ball.course;
    const Asker asker{course.at + (from - course.begin) * course.rate, course.rate, from, to - from, reach_of(ball) + room};
    HWY_DYNAMIC_DISPATCH(ListNear)(rows_, count_, asker, found);
}

}  // namespace carom::dynamics
#endif
