#include <carom/viz/camera.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/viz/detail/focus.hpp>
#include <carom/viz/layer.hpp>
#include <carom/viz/sweep_layers.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

/// Every position of the layer, in the frame's coordinates.
void collect(const DebugLayer& layer, std::vector<dvec3>& points) {
    for (const DebugVertex& v : layer.vertices) points.push_back(dvec3(v.position));
    for (const DebugPoint& p : layer.points) points.push_back(dvec3(p.position));
    for (const DebugText& t : layer.texts) points.push_back(dvec3(t.position));
    for (const DebugLine& line : layer.lines) {
        points.push_back(dvec3(line.a));
        points.push_back(dvec3(line.b));
    }
}

std::vector<dvec3> points_of_interest(const DebugFrame& frame) {
    std::vector<dvec3> points;
    for (const char* name : {to_string(Layer::Shapes), kSweepVolumes, kSweepGhosts}) {
        if (const DebugLayer* layer = frame.find(name)) collect(*layer, points);
    }
    if (points.empty()) {
        for (const DebugLayer& layer : frame.layers) collect(layer, points);
    }
    detail::remove_outliers(points);
    return points;
}

/// Right-handed axes of the picture; `back` points from the target to the camera.
struct ViewAxes {
    dvec3 right, up, back;
};

ViewAxes view_axes(const dvec3& up, const CameraAngle& angle) {
    // The front is z, made horizontal; where up is (nearly) z, it is x.
    dvec3 front = std::abs(up.z) < 0.9 ? dvec3{0.0, 0.0, 1.0} : dvec3{1.0, 0.0, 0.0};
    front = glm::normalize(front - glm::dot(front, up) * up);
    const SinCos azimuth = sin_cos(angle.azimuth), elevation = sin_cos(angle.elevation);
    const dvec3 level = azimuth.cos * front + azimuth.sin * glm::cross(up, front);
    const dvec3 back = elevation.cos * level + elevation.sin * up;
    const dvec3 right = glm::normalize(glm::cross(up, back));
    return {right, glm::cross(back, right), back};
}

/// Half the extent of the picture at distance 1.
struct HalfTangent {
    double x, y;
};

/// How far the camera must be from `target` for all the points to be in view.
double distance_to_fit(const std::vector<dvec3>& points, const dvec3& target, const ViewAxes& axes, HalfTangent half) {
    double distance = 0.0;
    for (const dvec3& p : points) {
        const dvec3 d = p - target;
        const double along = glm::dot(d, axes.back);
        distance = std::max({distance, along + std::abs(glm::dot(d, axes.right)) / half.x,
                             along + std::abs(glm::dot(d, axes.up)) / half.y});
    }
    return distance;
}

/// Moves the target so that the points' picture lies in the middle of the picture taken from `distance`.
dvec3 recenter(const std::vector<dvec3>& points, const dvec3& target, const ViewAxes& axes, double distance) {
    double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300;
    for (const dvec3& p : points) {
        const dvec3 d = p - target;
        const double depth = std::max(distance - glm::dot(d, axes.back), 0.05 * distance);
        const double x = glm::dot(d, axes.right) / depth, y = glm::dot(d, axes.up) / depth;
        low_x = std::min(low_x, x), high_x = std::max(high_x, x);
        low_y = std::min(low_y, y), high_y = std::max(high_y, y);
    }
    return target + 0.5 * distance * ((low_x + high_x) * axes.right + (low_y + high_y) * axes.up);
}

bool in_range(const CameraAngle& a) {
    return is_finite(a.azimuth) && std::abs(a.elevation) < 1.5 && a.field_of_view > 0.0 && a.field_of_view < 3.0 &&
           a.margin >= 0.0 && a.margin <= 0.4;
}

}  // namespace

Status validate(const Camera& camera) {
    if (!is_finite(camera.position) || !is_finite(camera.target) || !is_finite(camera.up) ||
        !is_finite(camera.field_of_view)) {
        return Error{ErrorCode::NotFinite, "a component is not finite", "Camera"};
    }
    if (!(camera.field_of_view > 0.0 && camera.field_of_view < 3.0)) {
        return Error{ErrorCode::InvalidArgument, "the field of view must be in (0, 3) rad", "Camera::field_of_view"};
    }
    const dvec3 view = camera.target - camera.position;
    if (glm::dot(view, view) == 0.0) {
        return Error{ErrorCode::InvalidArgument, "position and target are the same point", "Camera::target"};
    }
    const dvec3 side = glm::cross(view, camera.up);
    if (!(glm::dot(side, side) > 1e-12 * glm::dot(view, view) * glm::dot(camera.up, camera.up))) {
        return Error{ErrorCode::InvalidArgument, "up lies along the view", "Camera::up"};
    }
    return {};
}

Camera automatic_camera(const DebugFrame& frame, double aspect, const CameraAngle& angle) {
    CAROM_REQUIRE(aspect > 0.0 && is_finite(aspect), ErrorCode::InvalidArgument, "aspect must be positive", Camera{});
    CAROM_REQUIRE(in_range(angle), ErrorCode::InvalidArgument, "a camera angle is out of its range", Camera{});
    const std::vector<dvec3> points = points_of_interest(frame);
    if (points.empty()) return {};
    const SinCos half_angle = sin_cos(0.5 * angle.field_of_view);
    const double tangent = (1.0 - 2.0 * angle.margin) * half_angle.sin / half_angle.cos;
    const HalfTangent half{tangent * aspect, tangent};
    const ViewAxes axes = view_axes(glm::normalize(frame.up), angle);
    const Aabb box = detail::box_of(points);
    dvec3 target = 0.5 * (box.lower + box.upper);
    double distance = distance_to_fit(points, target, axes, half);
    for (int round = 0; round < 4 && distance > 0.0; ++round) {
        target = recenter(points, target, axes, distance);
        distance = distance_to_fit(points, target, axes, half);
    }
    if (!(distance > 0.0)) distance = 1.0;  // a single point has no size of its own
    target += frame.origin;
    return {target + distance * axes.back, target, glm::normalize(frame.up), angle.field_of_view};
}

}  // namespace carom
