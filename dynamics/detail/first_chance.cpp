#include <carom/dynamics/detail/first_chance.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

// Shares of lengths that rounding may change, here and in a search; times are moved down by as much.
constexpr double kRounding = 0x1p-40;

dvec3 at(const Course& course, double t) noexcept { return course.at + (t - course.begin) * course.rate; }
double size_of(const dvec3& v) noexcept { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// @param span  until it may touch, from `from` on.
double early(double from, double span) noexcept {
    const double t = from + (1.0 - kRounding) * span - kRounding * from;
    return from + span > 1.0 + 2.0 * kRounding ? kNoChance : std::clamp(t, from, 1.0);
}

}  // namespace

Course course_of(const BodyPath& path) noexcept {
    const PathPiece& piece = path.piece(BodyPath::kWhole);
    const double span = piece.end - piece.begin;
    Course course{.at = piece.start.position, .begin = piece.begin, .play = piece.sway + piece.bend, .turn = size_of(piece.rotation)};
    if (span > 0.0) course.rate = piece.translation / span;
    return course;
}

// |d + s v|² = r², where what rounding may have made of the difference of large squares counts for earlier. NaN, of lengths whose squares overflow, is no
// chance that is known.
double first_chance(const Ball& a, const Ball& b, double from, double room) noexcept {
    const dvec3 between = at(*b.course, from) - at(*a.course, from), along = b.course->rate - a.course->rate;
    const double lengths =
        size_of(a.course->at) + size_of(b.course->at) + size_of(a.course->rate) + size_of(b.course->rate) + a.reach + b.reach;
    const double near =
        a.reach + b.reach + a.course->play + b.course->play + room + kRounding * (1.0 + a.course->turn + b.course->turn) * lengths;
    const double apart = glm::dot(between, between), square = near * near, closing = -glm::dot(between, along),
                 speed = glm::dot(along, along);
    const double left = apart - square - kRounding * (apart + square);
    if (!(left > 0.0)) return from;
    if (closing <= 0.0) return kNoChance;
    const double product = speed * left, root = closing * closing - product + kRounding * (closing * closing + product);
    if (root < 0.0) return kNoChance;
    const double span = left / (closing + std::sqrt(root));
    return span >= 0.0 ? early(from, span) : from;
}

double first_chance(const Ball& a, const Aabb& still, double from, double room) noexcept {
    const dvec3 start = at(*a.course, from);
    const double lengths = size_of(a.course->at) + size_of(a.course->rate) + a.reach;
    const double near = a.reach + a.course->play + room + kRounding * (1.0 + a.course->turn) * lengths;
    double first = 0.0, last = 1.0 - from;
    for (int k = 0; k < 3; ++k) {
        const double slack = near + kRounding * (std::abs(still.lower[k]) + std::abs(still.upper[k]));
        const double below = (still.lower[k] - slack) - start[k], above = start[k] - (still.upper[k] + slack);  // by how much it is outside
        const double rate = a.course->rate[k];
        if (below > 0.0) {
            if (!(rate > 0.0)) return kNoChance;
            first = std::max(first, below / rate);
        } else if (above > 0.0) {
            if (!(rate < 0.0)) return kNoChance;
            first = std::max(first, -above / rate);
        }
        if (rate > 0.0) last = std::min(last, -above / rate);  // where it leaves the slab
        if (rate < 0.0) last = std::min(last, below / rate);
    }
    if (first > last + kRounding * (first + std::abs(last))) return kNoChance;
    return first > 0.0 ? early(from, first) : from;
}

// As seen from B's centre of mass.
double first_chance(const Ball& a, const Ball& b, const Aabb& box, double from, double room) noexcept {
    const Course &course_a = *a.course, &course_b = *b.course;
    const double turned = b.reach * std::min(course_b.turn, 2.0),
                 rounding = kRounding * (1.0 + course_b.turn) * (size_of(course_b.at) + size_of(course_b.rate) + b.reach);
    const Course course{at(course_a, from) - (from - course_b.begin) * course_b.rate, from, course_a.rate - course_b.rate,
                        course_a.play + course_b.play, course_a.turn};
    return first_chance({&course, a.reach}, box, from, room + turned + rounding);
}

double first_chance(const Ball& a, const Course& plane, const dvec3& foot, const dvec3& normal, double from, double room) noexcept {
    const dvec3 start = at(*a.course, from), there = foot + (from - plane.begin) * plane.rate;
    const double lengths =
        size_of(a.course->at) + size_of(foot) + size_of(plane.at) + size_of(a.course->rate) + size_of(plane.rate) + a.reach;
    const double near = a.reach + a.course->play + plane.play + room + kRounding * (1.0 + a.course->turn) * lengths;
    const double height = glm::dot(normal, start - there) - near, closing = glm::dot(normal, plane.rate - a.course->rate);
    if (!(height > 0.0)) return from;
    return closing > 0.0 ? early(from, height / closing) : kNoChance;
}

}  // namespace carom::dynamics
