#include <carom/dynamics/detail/pair_sweep.hpp>

#include <carom/collision/triangle_mesh.hpp>

#include <limits>
#include <utility>

namespace carom::dynamics {
PairSweep::PairSweep(const ProxySet& proxies, const SweptPair& pair, RecordedPath& path_a, RecordedPath& path_b)
    : path_a_(path_a), path_b_(path_b) {
    const Proxy &a = proxies.by_slot[pair.a], &b = proxies.by_slot[pair.b];
    a_ = {a.shape, a.local.get(), a.reach};
    b_ = {b.shape, b.local.get(), b.reach};
    const double size = swept_size(proxies, pair);
    tolerance_ = kSweepToleranceShare * (size < std::numeric_limits<double>::infinity() ? size : a.reach);
    if (type_of(b.shape) == ShapeType::Plane) b_.still = kEverywhere;
}

bool PairSweep::is_one_sided() const noexcept {
    const TriangleMeshPtr* const mesh = std::get_if<TriangleMeshPtr>(&b_.shape);
    return mesh != nullptr && (*mesh)->is_one_sided();
}

const Shape& PairSweep::with_both_sides() {
    if (!is_one_sided()) return b_.shape;
    if (!two_sided_) {
        const TriangleMesh& mesh = *std::get<TriangleMeshPtr>(b_.shape);
        two_sided_ = TriangleMesh::build(mesh.vertices(), mesh.triangles()).value();
    }
    return *two_sided_;
}

PathSearch PairSweep::search(const Shape& b, int level, double separation) const {
    PathSearch search{.a = {nullptr, &a_.shape, &a_.local, a_.reach}, .b = {nullptr, &b, &b_.local, b_.reach}};
    search.level = level;
    search.separation = separation;
    search.tolerance = tolerance_;
    search.still = b_.still;
    return search;
}

PathSearch PairSweep::contact(const Shape& b, double separation) {
    PathSearch found = search(b, 0, separation + tolerance_);
    const bool met = touch_along(path_a_, path_b_, found, cores_);
    if (!met) found.impact = Impact{};
    // What is there when a later piece begins touches at that time, and not from the start.
    if (met && found.t > 0.0 && found.impact.status == ImpactStatus::Overlapping) found.impact.status = ImpactStatus::Touching;
    found.impact.t = met ? found.t : 1.0;
    return found;
}

PathSearch PairSweep::first_contact(double separation) { return contact(b_.shape, separation); }

PathSearch PairSweep::first_contact_with_both_sides() { return contact(with_both_sides(), 0.0); }

std::optional<double> PairSweep::middle_met() {
    PathSearch found = search(with_both_sides(), kMiddle, 0.0);
    const bool met = touch_along(path_a_, path_b_, found, cores_) && found.impact.status != ImpactStatus::Clamped;
    return met && found.t > 0.0 ? std::optional(found.t) : std::nullopt;
}

bool PairSweep::middle_is_there() {
    const MovingShape a{&a_.shape, {.start = path_a_.pose_at(1.0) * a_.local}};
    const MovingShape b{&with_both_sides(), {.start = path_b_.pose_at(1.0) * b_.local}};
    return may_touch(first_touch(a, kMiddle, b, {.tolerance = tolerance_}, cores_).status);
}

double PairSweep::clearance() {
    double kept = 0.0, met = 1e-3 * a_.reach;
    const auto touches = [&](double separation) { return may_touch(first_contact(separation).impact.status); };
    for (int k = 0; k < 48 && !touches(met); ++k) kept = std::exchange(met, 2.0 * met);
    for (int k = 0; k < 10; ++k) {
        const double middle = 0.5 * (kept + met);
        (touches(middle) ? met : kept) = middle;
    }
    return kept;
}

std::vector<double> PairSweep::looks(int level, double begin) {
    std::vector<double> times;
    PathSearch found = search(b_.shape, level, tolerance_);
    found.looks = &times;
    if (!touch_along(path_a_, path_b_, found, cores_, begin)) times.clear();
    return times;
}

}  // namespace carom::dynamics
