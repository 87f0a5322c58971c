#include <carom/narrowphase/detail/moving_boxes.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

constexpr double kEarlier = 1.0 - 0x1p-50, kLater = 1.0 + 0x1p-50;  // quotients of differences, rounded towards the safe side

constexpr std::size_t next(std::size_t k) noexcept { return k == 2 ? 0 : k + 1; }
std::size_t index(int k) noexcept { return static_cast<std::size_t>(k); }
std::array<double, 3> numbers(const dvec3& v) noexcept { return {v.x, v.y, v.z}; }

/// The span of t in which no axis parts the two.
class Meeting {
public:
    Meeting(double until, double rounding) noexcept : rounding_(rounding) { out_.t = 0.0, last_ = until; }

    /// @param height  of B's centre over A's along an axis at t = 0. @param rate  its change. @param reach  of both along it.
    /// @return whether they may still meet.
    bool narrow(int a, int b, double height, double rate, double reach) noexcept {
        const double room = reach + rounding_;
        const double sign = rate < 0.0 ? 1.0 : -1.0;
        const double far = sign * height, speed = std::abs(rate);  // comes down from `far`, to -room
        if (far > room) {
            const double from = (far - room) / speed * kEarlier;
            if (!(from <= last_)) return false;
            if (from > out_.t) out_.t = from, out_.axis = {a, b, sign};
        } else if (far < -room) {
            return false;
        }
        if (far + room < speed * last_) {
            last_ = std::min(last_, (far + room) / speed * kLater);
            if (last_ < out_.t) return false;
        }
        return true;
    }
    [[nodiscard]] const BoxSlide& slide() const noexcept { return out_; }

private:
    double rounding_, last_ = 1.0;
    BoxSlide out_;
};

}  // namespace

BoxAxes::BoxAxes(const BoxPlaces& places) noexcept : at_(places) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            c_[i][j] = glm::dot(at_.axes_a[static_cast<int>(i)], at_.axes_b[static_cast<int>(j)]);
            size_[i][j] = std::abs(c_[i][j]);
        }
    }
}

BoxSlide BoxAxes::slide(const dvec3& along, double until, double rounding) const noexcept {
    Meeting meeting(until, rounding);
    const Row a = numbers(at_.half_a), b = numbers(at_.half_b);
    const Row from_a = numbers(at_.between * at_.axes_a), from_b = numbers(at_.between * at_.axes_b);
    const Row rate_a = numbers(along * at_.axes_a), rate_b = numbers(along * at_.axes_b);
    BoxSlide passes;
    passes.passes = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const double reach = a[i] + (b[0] * size_[i][0] + b[1] * size_[i][1] + b[2] * size_[i][2]);
        if (!meeting.narrow(static_cast<int>(i), BoxAxis::kNone, from_a[i], rate_a[i], reach)) return passes;
    }
    for (std::size_t j = 0; j < 3; ++j) {
        const double reach = b[j] + (a[0] * size_[0][j] + a[1] * size_[1][j] + a[2] * size_[2][j]);
        if (!meeting.narrow(BoxAxis::kNone, static_cast<int>(j), from_b[j], rate_b[j], reach)) return passes;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t p = next(i), q = next(p);
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t k = next(j), l = next(k);
            const double height = from_a[q] * c_[p][j] - from_a[p] * c_[q][j], rate = rate_a[q] * c_[p][j] - rate_a[p] * c_[q][j];
            const double reach = (a[p] * size_[q][j] + a[q] * size_[p][j]) + (b[k] * size_[i][l] + b[l] * size_[i][k]);
            if (!meeting.narrow(static_cast<int>(i), static_cast<int>(j), height, rate, reach)) return passes;
        }
    }
    return meeting.slide();
}

BoxAxis BoxAxes::longest(const BoxRates& rates, double rounding) const noexcept {
    const Row a = numbers(at_.half_a), b = numbers(at_.half_b);
    const dvec3 &between = at_.between, &along = rates.along;
    const Row from_a = numbers(between * at_.axes_a), from_b = numbers(between * at_.axes_b);
    const Row rate_a = numbers((along - glm::cross(rates.turn_a, between)) * at_.axes_a);
    const Row rate_b = numbers((along - glm::cross(rates.turn_b, between)) * at_.axes_b);
    const Row turn = numbers((rates.turn_b - rates.turn_a) * at_.axes_a);
    std::array<Row, 3> d, grow;  // the rates of c_ and size_
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t p = next(i), q = next(p);
        for (std::size_t j = 0; j < 3; ++j) {
            d[i][j] = turn[p] * c_[q][j] - turn[q] * c_[p][j];
            grow[i][j] = c_[i][j] < 0.0 ? -d[i][j] : d[i][j];
        }
    }
    BoxAxis best;
    double most = 0.0;
    const auto offer = [&](int of_a, int of_b, double height, double gap, double rate) {
        // The root of gap + rate s - bend s^2.
        const double s = 2.0 * gap / (std::sqrt(rate * rate + 4.0 * rates.bend * gap) - rate);
        if (s > most) most = s, best = {of_a, of_b, height < 0.0 ? -1.0 : 1.0};
    };
    const auto signed_by = [](double height, double rate) { return height < 0.0 ? -rate : rate; };
    for (std::size_t i = 0; i < 3; ++i) {
        const double gap = std::abs(from_a[i]) - (a[i] + (b[0] * size_[i][0] + b[1] * size_[i][1] + b[2] * size_[i][2]));
        if (!(gap > rounding)) continue;
        const double rate = signed_by(from_a[i], rate_a[i]) - (b[0] * grow[i][0] + b[1] * grow[i][1] + b[2] * grow[i][2]);
        offer(static_cast<int>(i), BoxAxis::kNone, from_a[i], gap, rate);
    }
    for (std::size_t j = 0; j < 3; ++j) {
        const double gap = std::abs(from_b[j]) - (b[j] + (a[0] * size_[0][j] + a[1] * size_[1][j] + a[2] * size_[2][j]));
        if (!(gap > rounding)) continue;
        const double rate = signed_by(from_b[j], rate_b[j]) - (a[0] * grow[0][j] + a[1] * grow[1][j] + a[2] * grow[2][j]);
        offer(BoxAxis::kNone, static_cast<int>(j), from_b[j], gap, rate);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t p = next(i), q = next(p);
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t k = next(j), l = next(k);
            const double height = from_a[q] * c_[p][j] - from_a[p] * c_[q][j];
            const double gap = std::abs(height) - ((a[p] * size_[q][j] + a[q] * size_[p][j]) + (b[k] * size_[i][l] + b[l] * size_[i][k]));
            if (!(gap > rounding)) continue;
            const double lift = (rate_a[q] * c_[p][j] + from_a[q] * d[p][j]) - (rate_a[p] * c_[q][j] + from_a[p] * d[q][j]);
            const double spread = (a[p] * grow[q][j] + a[q] * grow[p][j]) + (b[k] * grow[i][l] + b[l] * grow[i][k]);
            offer(static_cast<int>(i), static_cast<int>(j), height, gap, signed_by(height, lift) - spread);
        }
    }
    return best;
}

dvec3 BoxAxes::normal(const BoxAxis& axis) const noexcept {
    if (axis.b == BoxAxis::kNone) return axis.sign * at_.axes_a[axis.a];
    if (axis.a == BoxAxis::kNone) return axis.sign * at_.axes_b[axis.b];
    const dvec3 n = glm::cross(at_.axes_a[axis.a], at_.axes_b[axis.b]);
    const double length = glm::length(n);
    return length > 0.0 ? (axis.sign / length) * n : dvec3{0.0};
}

BoxTouch BoxAxes::touch(const BoxAxis& axis, const dvec3& shift, double enough) const noexcept {
    constexpr int kMostRounds = 4;
    const dvec3 between = at_.between + shift;
    BoxTouch touch = foremost(axis, between);
    for (int round = 0; round < kMostRounds && touch.distance > enough; ++round) {
        const dvec3 on_a = at_.axes_a * glm::clamp(touch.on_b * at_.axes_a, -at_.half_a, at_.half_a);
        touch.on_b = between + at_.axes_b * glm::clamp((on_a - between) * at_.axes_b, -at_.half_b, at_.half_b);
        touch.distance = glm::length(touch.on_b - on_a);
    }
    return touch;
}

BoxTouch BoxAxes::foremost(const BoxAxis& axis, const dvec3& between) const noexcept {
    const dvec3 n = normal(axis);
    // The corners that are foremost: of A along n, of B against it; of the edges, their middles.
    dvec3 a{0.0}, b{0.0};
    for (int k = 0; k < 3; ++k) {
        if (axis.b == BoxAxis::kNone || k != axis.a) a[k] = glm::dot(n, at_.axes_a[k]) < 0.0 ? -at_.half_a[k] : at_.half_a[k];
        if (axis.a == BoxAxis::kNone || k != axis.b) b[k] = glm::dot(n, at_.axes_b[k]) < 0.0 ? at_.half_b[k] : -at_.half_b[k];
    }
    if (axis.b == BoxAxis::kNone) {
        const dvec3 corner = between + at_.axes_b * b, seen = corner * at_.axes_a;
        return {corner, glm::length(glm::clamp(seen, -at_.half_a, at_.half_a) - seen)};
    }
    if (axis.a == BoxAxis::kNone) {
        const dvec3 seen = (at_.axes_a * a - between) * at_.axes_b, foot = glm::clamp(seen, -at_.half_b, at_.half_b);
        return {between + at_.axes_b * foot, glm::length(foot - seen)};
    }
    // Ericson, Real-Time Collision Detection (2005), sec. 5.1.9; the ends by clamping, since edges that touch do so between them.
    const dvec3 &u = at_.axes_a[axis.a], &v = at_.axes_b[axis.b];
    const dvec3 from = at_.axes_a * a, to = between + at_.axes_b * b, apart = to - from;
    const double cosine = c_[index(axis.a)][index(axis.b)], along = glm::dot(apart, u), across = glm::dot(apart, v);
    const dvec3 square = glm::cross(u, v);
    const double sine_sq = glm::dot(square, square), half_a = at_.half_a[axis.a], half_b = at_.half_b[axis.b];
    double s = 0.0;
    if (sine_sq > 0.0) s = std::clamp((cosine * along - across) / sine_sq, -half_b, half_b);
    const double r = std::clamp(along + s * cosine, -half_a, half_a);
    s = std::clamp(r * cosine - across, -half_b, half_b);
    return {to + s * v, glm::length((to + s * v) - (from + r * u))};
}

}  // namespace carom::detail
