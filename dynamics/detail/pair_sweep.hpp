// Two shapes on the recorded paths of a step: when they touched, when the middle of one came to the other, how far apart they stayed.
//
//   PairSweep sweep(paths, proxies, pair, path_a, path_b);
//   if (may_touch(sweep.first_contact().impact.status)) ...
#pragma once

#include <carom/dynamics/detail/continuous.hpp>
#include <carom/dynamics/detail/recorded_paths.hpp>

#include <optional>
#include <vector>

namespace carom::dynamics {

class PairSweep {
public:
    /// @param pair  in the order in which they are looked at; A is no plane. All but that outlive this.
    PairSweep(const ProxySet& proxies, const SweptPair& pair, RecordedPath& path_a, RecordedPath& path_b);

    [[nodiscard]] bool is_one_sided() const noexcept;

    /// The first contact of the two on their whole way; impacts are a little early: what has come as near as they come touches.
    [[nodiscard]] PathSearch first_contact(double separation = 0.0);
    /// The same, with both sides of a one-sided mesh.
    [[nodiscard]] PathSearch first_contact_with_both_sides();
    /// When A's middle first came to B, if it was not there before the step.
    [[nodiscard]] std::optional<double> middle_met();
    /// Whether A's middle is at B when the step is over.
    [[nodiscard]] bool middle_is_there();
    /// A distance that they kept, found by halves to a thousandth of itself.
    [[nodiscard]] double clearance();
    /// When conservative advancement looked from a time on until it found the contact of a level.
    [[nodiscard]] std::vector<double> looks(int level, double begin);
    /// How near a search comes [m].
    [[nodiscard]] double tolerance() const noexcept { return tolerance_; }

private:
    /// A shape as it is swept, and what it is made of where it cannot be taken as it is.
    struct Swept {
        Shape shape;
        Pose local;
        double reach = 0.0;
        std::optional<Aabb> still{};
    };
    [[nodiscard]] const Shape& with_both_sides();
    [[nodiscard]] PathSearch search(const Shape& b, int level, double separation) const;
    [[nodiscard]] PathSearch contact(const Shape& b, double separation);

    RecordedPath &path_a_, &path_b_;
    Swept a_, b_;
    std::optional<Shape> two_sided_;
    double tolerance_ = 0.0;
    Cores cores_;
};

}  // namespace carom::dynamics
