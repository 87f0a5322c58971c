#include <carom/narrowphase/detail/box_distance.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

constexpr int kRounds = 6;        // nine of ten random pairs end in the first; one of 50,000 is left after the last
constexpr double kLevel = 1e-15;  // slopes below this are rounding
constexpr unsigned kInside = 0b111;

dvec3 clamped(const dvec3& v, const dvec3& half) noexcept {
    return {std::min(std::max(v.x, -half.x), half.x), std::min(std::max(v.y, -half.y), half.y), std::min(std::max(v.z, -half.z), half.z)};
}

// How far a point is below the nearest face; negative outside.
double depth_below(const dvec3& half, const dvec3& point) noexcept {
    return std::min(std::min(half.x - std::abs(point.x), half.y - std::abs(point.y)), half.z - std::abs(point.z));
}

// One of the boxes, in its own axes about its own centre.
struct Side {
    dvec3 half;
    dmat3 other_axes;
    dvec3 other_centre;
    dvec3 seen{0.0};    // the other's point
    dvec3 point{0.0};   // its own nearest to that
    unsigned free = 0;  // bits of the axes along which `seen` is between the faces: three inside, two over a face, one beside an edge

    [[nodiscard]] dvec3 place(const dvec3& of_other) const noexcept { return other_axes * of_other + other_centre; }
    void look_at(const dvec3& of_other) noexcept {
        seen = place(of_other);
        point = clamped(seen, half);
        free = (seen.x == point.x ? 1u : 0u) + (seen.y == point.y ? 2u : 0u) + (seen.z == point.z ? 4u : 0u);
    }
    [[nodiscard]] bool over_face() const noexcept { return std::popcount(free) == 2; }
    [[nodiscard]] bool beside_edge() const noexcept { return std::popcount(free) == 1; }
    [[nodiscard]] int face_axis() const noexcept { return std::countr_zero(~free); }
    [[nodiscard]] int edge_axis() const noexcept { return std::countr_zero(free); }
};

class Search {
public:
    Search(const vec3& half_a, const Pose& pose_a, const vec3& half_b, const Pose& pose_b, double tolerance) noexcept
        : axes_a_(glm::mat3_cast(pose_a.orientation)),
          axes_b_(glm::mat3_cast(pose_b.orientation)),
          between_(pose_b.position - pose_a.position),
          tolerance_(tolerance) {
        const dmat3 turn = glm::transpose(axes_a_) * axes_b_;
        a_ = {dvec3(half_a), turn, between_ * axes_a_};
        b_ = {dvec3(half_b), glm::transpose(turn), -(between_ * axes_b_)};
        const double size = glm::length(between_) + glm::length(a_.half) + glm::length(b_.half);
        is_usual_ = size > 1e-60 && size < 1e60;
        rounding_ = 0x1p-46 * size;  // as core_pair() has it
    }

    std::optional<DistanceResult> run() noexcept {
        if (!is_usual_) return {};
        a_.point = clamped(a_.other_centre, a_.half);
        for (result_.iterations = 1; result_.iterations <= kRounds; ++result_.iterations) {
            b_.look_at(a_.point);
            if (b_.free == kInside) return overlap_at(a_.point, b_.seen);
            a_.look_at(b_.point);
            if (a_.free == kInside) return overlap_at(a_.seen, b_.point);
            if (a_.over_face()) {
                go_down(a_, b_);
                if (a_.free == kInside) return overlap_at(a_.seen, b_.point);
            } else if (b_.over_face()) {
                go_down(b_, a_);
                if (b_.free == kInside) return overlap_at(a_.point, b_.seen);
            }
            if (a_.beside_edge() && b_.beside_edge()) meet_on_edges();
            if (!has_distance()) return {};
            if (has_bound(way_) || has_bound(feature_normal())) return result_;
        }
        return {};
    }

private:
    // Two places of one point, which is a member of one box: whether the other surely holds it. What the places are apart by counts too, for
    // axes that are not quite square. Half of the depth is for axes that are not quite of unit length.
    [[nodiscard]] std::optional<DistanceResult> overlap_at(const dvec3& in_a, const dvec3& in_b) noexcept {
        const double depth = std::max(depth_below(a_.half, in_a), depth_below(b_.half, in_b));
        const dvec3 gap = axes_a_ * in_a - (between_ + axes_b_ * in_b);
        if (!(0.5 * depth > rounding_ + std::abs(gap.x) + std::abs(gap.y) + std::abs(gap.z))) return {};
        return DistanceResult{.status = DistanceStatus::Overlap, .iterations = result_.iterations};  // without what an earlier round left
    }

    // The other box's point is over a face. Its lowest corner is nearest, where that is over the face as well. Otherwise the point goes down as far as
    // it may on its own face or edge, to where it ends or leaves what is over the face.
    void go_down(Side& face, Side& other) noexcept {
        const int k = face.face_axis();
        const double up = face.seen[k] > 0.0 ? 1.0 : -1.0;
        const dvec3 slope{up * face.other_axes[0][k], up * face.other_axes[1][k], up * face.other_axes[2][k]};
        const dvec3 corner{slope.x > 0.0 ? -other.half.x : other.half.x, slope.y > 0.0 ? -other.half.y : other.half.y,
                           slope.z > 0.0 ? -other.half.z : other.half.z};
        const dvec3 foot = face.place(corner);
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        if (std::abs(foot[p]) <= face.half[p] && std::abs(foot[q]) <= face.half[q] && up * foot[k] > -face.half[k]) {
            other.point = corner;
            other.free = 0;
            face.seen = foot;
            face.point = clamped(foot, face.half);
            if (up * foot[k] <= face.half[k]) face.free = kInside;
            return;
        }
        if (other.free != 0) slide_down(face, other, slope, k, up * face.half[k]);
    }

    // @param plane  where the face is along its axis k.
    void slide_down(Side& face, Side& other, const dvec3& slope, int k, double plane) noexcept {
        face.seen = face.place(other.point);  // which may have gone on since
        dvec3 way{0.0};
        double length = std::numeric_limits<double>::infinity();
        unsigned leaves_other = 0, leaves_face = 0;
        for (int j = 0; j < 3; ++j) {
            if ((other.free >> j & 1u) == 0 || !(std::abs(slope[j]) > kLevel)) continue;
            way[j] = -slope[j];
            const double to_end = (std::copysign(other.half[j], way[j]) - other.point[j]) / way[j];
            if (to_end < length) length = to_end, leaves_other = 1u << j;
        }
        if (leaves_other == 0) return;  // level
        const dvec3 along = face.other_axes * way;
        for (int i = 0; i < 3; ++i) {
            if (i == k || !(std::abs(along[i]) > kLevel)) continue;
            const double to_edge = (std::copysign(face.half[i], along[i]) - face.seen[i]) / along[i];
            if (to_edge < length) length = to_edge, leaves_face = 1u << i, leaves_other = 0;
        }
        const double to_plane = (plane - face.seen[k]) / along[k];
        const bool dives = to_plane < length;
        if (dives) {  // to the middle of what is below
            const double to_back = (-plane - face.seen[k]) / along[k];
            length = 0.5 * (to_plane + std::min(length, to_back));
        }
        other.point = clamped(other.point + length * way, other.half);
        face.seen = face.place(other.point);
        face.point = clamped(face.seen, face.half);
        face.free = dives ? kInside : face.free & ~leaves_face;
        other.free &= ~leaves_other;
    }

    // The nearest points of an edge of each box, ends included (Ericson 2005, sec. 5.1.9).
    void meet_on_edges() noexcept {
        const int i = a_.edge_axis(), j = b_.edge_axis();
        dvec3 from = a_.point, to = b_.point;
        from[i] = to[j] = 0.0;
        const dvec3& along = a_.other_axes[j];
        const dvec3 apart = a_.place(to) - from;
        const double cosine = along[i], across = glm::dot(apart, along);
        const double p = along[(i + 1) % 3], q = along[(i + 2) % 3];
        const double sine_sq = p * p + q * q;  // not 1 - cosine^2, where little would be left of nearly parallel edges
        const auto end = [](double x, double half) { return std::min(std::max(x, -half), half); };
        if (sine_sq > 0.0) b_.point[j] = end((cosine * apart[i] - across) / sine_sq, b_.half[j]);
        a_.point[i] = end(apart[i] + b_.point[j] * cosine, a_.half[i]);
        b_.point[j] = end(a_.point[i] * cosine - across, b_.half[j]);
    }

    // The distance of the two points, an upper bound, if they are farther apart than rounding.
    [[nodiscard]] bool has_distance() noexcept {
        result_.on_a = axes_a_ * a_.point;
        result_.on_b = between_ + axes_b_ * b_.point;
        way_ = result_.on_b - result_.on_a;
        length_ = glm::length(way_);
        result_.upper = length_ + rounding_;
        return length_ > 8.0 * rounding_;
    }

    // Square to the two features that the points are on, from A to B or zero.
    [[nodiscard]] dvec3 feature_normal() const noexcept {
        dvec3 n{0.0};
        if (a_.over_face()) {
            n = axes_a_[a_.face_axis()];
        } else if (b_.over_face()) {
            n = axes_b_[b_.face_axis()];
        } else if (a_.beside_edge() && b_.beside_edge()) {
            n = glm::cross(axes_a_[a_.edge_axis()], axes_b_[b_.edge_axis()]);
        }
        return glm::dot(n, way_) < 0.0 ? -n : n;
    }

    // Whether the support plane across `n` is as far off as the points are apart, but for rounding. Products of columns with a unit vector err by 8
    // roundings and are summed with three extents, in less than what core_pair() counts for two support points.
    [[nodiscard]] bool has_bound(const dvec3& n) noexcept {
        const double length = glm::length(n);
        if (!(length > 0.0)) return false;
        double gap = glm::dot(n, between_);
        for (int k = 0; k < 3; ++k) gap -= a_.half[k] * std::abs(glm::dot(n, axes_a_[k])) + b_.half[k] * std::abs(glm::dot(n, axes_b_[k]));
        result_.lower = std::max(0.0, gap / length - rounding_);
        if (!(result_.upper - result_.lower <= 3.0 * rounding_ + tolerance_ * result_.upper)) return false;
        result_.normal = n / length;
        return true;
    }

    dmat3 axes_a_, axes_b_;
    dvec3 between_;
    double tolerance_, rounding_ = 0.0, length_ = 0.0;
    bool is_usual_ = false;
    Side a_, b_;
    dvec3 way_{0.0};
    DistanceResult result_;
};

}  // namespace

std::optional<DistanceResult> box_distance(const vec3& half_a, const Pose& pose_a, const vec3& half_b, const Pose& pose_b,
                                           double tolerance) noexcept {
    return Search(half_a, pose_a, half_b, pose_b, tolerance).run();
}

}  // namespace carom::detail
