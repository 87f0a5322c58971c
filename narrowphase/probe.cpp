#include <carom/narrowphase/probe.hpp>

#include <carom/collision/ray_cast.hpp>
#include <carom/core/check.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace carom {
namespace {

constexpr std::uint32_t kMostRays = 4096;
constexpr std::uint32_t kMostRows = 64;
constexpr std::size_t kGrain = 4;

/// The fan in the world: ray k of row j goes from origin(j) along direction(k).
class Fan {
public:
    Fan(const RayProbe& probe, const Pose& pose) : probe_(probe) {
        const dvec3 axis = glm::normalize(probe.axis);
        const dvec3 middle = glm::normalize(probe.middle - glm::dot(probe.middle, axis) * axis);
        centre_ = transform_point(pose, probe.centre);
        axis_ = transform_vector(pose, axis);
        middle_ = transform_vector(pose, middle);
        side_ = glm::cross(axis_, middle_);
        const bool whole = probe.angle >= 2.0 * kPi;
        const double count = static_cast<double>(probe.rays);
        if (probe.rays > 1) step_ = whole ? probe.angle / count : probe.angle / (count - 1.0);
        first_ = probe.rays > 1 && !whole ? -0.5 * probe.angle : 0.0;
    }

    [[nodiscard]] dvec3 origin(std::uint32_t row) const {
        if (probe_.rows == 1) return centre_;
        const double along = static_cast<double>(row) / static_cast<double>(probe_.rows - 1) - 0.5;
        return centre_ + (along * probe_.width) * axis_;
    }
    [[nodiscard]] dvec3 direction(std::uint32_t ray) const {
        const SinCos turn = sin_cos(first_ + static_cast<double>(ray) * step_);
        return turn.cos * middle_ + turn.sin * side_;
    }
    [[nodiscard]] double length() const { return probe_.radius + probe_.reach; }

private:
    const RayProbe& probe_;
    dvec3 centre_{0.0}, axis_{0.0}, middle_{0.0}, side_{0.0};
    double first_ = 0.0, step_ = 0.0;  // [rad]
};

bool has_direction(const dvec3& v) {
    const double length = glm::length(v);
    return is_finite(length) && length > 0.0;
}

Status fault_of(const RayProbe& probe, const Pose& pose) {
    if (!is_finite(pose)) return Error{ErrorCode::NotFinite, "the pose is not finite", "probe"};
    return validate(probe);
}

Status fault_of(const PlacedShapes& placed, std::span<const std::uint32_t> near) {
    const auto fault = [](ErrorCode code, const char* what) { return Status{Error{code, what, "probe"}}; };
    if (placed.shapes.size() != placed.poses.size()) return fault(ErrorCode::InvalidArgument, "as many poses as shapes are needed");
    for (const std::uint32_t number : near) {
        if (number >= placed.shapes.size()) return fault(ErrorCode::InvalidArgument, "no shape has such a number");
        if (placed.shapes[number] == nullptr) return fault(ErrorCode::InvalidArgument, "a shape is null");
        if (!is_finite(placed.poses[number])) return fault(ErrorCode::NotFinite, "the pose of a shape is not finite");
    }
    return {};
}

/// Hands the contacts of one probe, which has been checked, to `add`.
template <class Add>
void cast_fan(const RayProbe& probe, const Pose& pose, const PlacedShapes& placed, std::span<const std::uint32_t> near, const Add& add) {
    const Fan fan(probe, pose);
    for (std::uint32_t row = 0; row < probe.rows; ++row) {
        const dvec3 origin = fan.origin(row);
        for (std::uint32_t k = 0; k < probe.rays; ++k) {
            Ray ray{origin, fan.direction(k), fan.length()};
            std::optional<RayHit> best;
            ProbeContact contact{.row = row, .ray = k};
            for (const std::uint32_t number : near) {
                const std::optional<RayHit> hit = cast_ray(*placed.shapes[number], placed.poses[number], ray);
                if (!hit || (best && !(hit->distance < best->distance))) continue;
                best = hit;
                ray.max_distance = hit->distance;
                contact.shape = number;
            }
            if (!best) continue;
            contact.triangle = best->triangle;
            contact.part = best->part;
            contact.point = best->point;
            contact.normal = -best->normal;
            contact.separation = best->distance - probe.radius;
            contact.clearance = glm::dot(contact.normal, best->point - origin) - probe.radius;
            add(contact);
        }
    }
}

}  // namespace

Status validate(const RayProbe& probe) {
    const auto fault = [](ErrorCode code, const char* message) { return Status{Error{code, message, "RayProbe"}}; };
    if (!is_finite(probe.centre)) return fault(ErrorCode::NotFinite, "centre must be finite");
    if (!has_direction(probe.axis)) return fault(ErrorCode::InvalidArgument, "axis must have a finite length that is not 0");
    if (!has_direction(probe.middle)) return fault(ErrorCode::InvalidArgument, "middle must have a finite length that is not 0");
    const dvec3 across = glm::cross(glm::normalize(probe.axis), glm::normalize(probe.middle));
    if (!(glm::length(across) > 1e-6)) return fault(ErrorCode::InvalidArgument, "middle must not lie along the axis");
    if (!(probe.angle >= 0.0 && probe.angle <= 2.0 * kPi)) return fault(ErrorCode::InvalidArgument, "angle must be in 0..2 pi");
    if (probe.rays < 1 || probe.rays > kMostRays) return fault(ErrorCode::InvalidArgument, "rays must be in 1..4096");
    if (probe.rows < 1 || probe.rows > kMostRows) return fault(ErrorCode::InvalidArgument, "rows must be in 1..64");
    if (!is_finite(probe.width) || probe.width < 0.0) return fault(ErrorCode::InvalidArgument, "width must be finite and not negative");
    if (!is_finite(probe.radius) || !(probe.radius > 0.0)) return fault(ErrorCode::InvalidArgument, "radius must be finite and positive");
    if (!is_finite(probe.reach) || probe.reach < 0.0) return fault(ErrorCode::InvalidArgument, "reach must be finite and not negative");
    return {};
}

void probe(const RayProbe& probe, const Pose& pose, const PlacedShapes& placed, std::span<const std::uint32_t> near,
           std::vector<ProbeContact>& out) {
    Status status = fault_of(probe, pose);
    if (status.ok()) status = fault_of(placed, near);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message);
    cast_fan(probe, pose, placed, near, [&](const ProbeContact& contact) { out.push_back(contact); });
}

void probe(std::span<const PlacedProbe> probes, const PlacedShapes& placed, std::span<const std::uint32_t> near, Executor& executor,
           std::vector<ProbeContact>& out) {
    Status status = fault_of(placed, near);
    std::vector<std::size_t> first(probes.size() + 1, 0);  // of each probe's places in `out`, one a ray
    for (std::size_t i = 0; i < probes.size() && status.ok(); ++i) {
        const PlacedProbe& p = probes[i];
        status = fault_of(p.probe, p.pose);
        if (p.first_near > near.size() || p.near_count > near.size() - p.first_near) {
            status = Error{ErrorCode::InvalidArgument, "a probe's shapes go beyond the list", "probe"};
        }
        first[i + 1] = first[i] + std::size_t{p.probe.rows} * p.probe.rays;
    }
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message);
    out.resize(first.back());
    std::vector<std::size_t> filled(probes.size(), 0);
    executor.parallel_for(probes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const PlacedProbe& p = probes[i];
            cast_fan(p.probe, p.pose, placed, near.subspan(p.first_near, p.near_count), [&](ProbeContact contact) {
                contact.probe = static_cast<std::uint32_t>(i);
                out[first[i] + filled[i]++] = contact;
            });
        }
    });
    std::size_t count = 0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
        for (std::size_t k = 0; k < filled[i]; ++k) out[count++] = out[first[i] + k];
    }
    out.resize(count);
}

Aabb bounds(const RayProbe& probe, const Pose& pose) {
    const Status status = fault_of(probe, pose);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message, {});
    const Fan fan(probe, pose);
    Aabb box;
    for (const std::uint32_t row : {0u, probe.rows - 1}) {
        const dvec3 origin = fan.origin(row);
        box = merge(box, {origin, origin});
        for (std::uint32_t k = 0; k < probe.rays; ++k) {
            const dvec3 end = origin + fan.length() * fan.direction(k);
            box = merge(box, {end, end});
        }
    }
    return box;
}

}  // namespace carom
