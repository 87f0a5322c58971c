#include <carom/viz/detail/focus.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

constexpr std::size_t kFewest = 10;
constexpr double kReach = 3.0;

double quantile(std::vector<double>& values, double q) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

void remove_outliers(std::vector<dvec3>& points) {
    if (points.size() < kFewest) return;
    std::vector<double> values(points.size());
    dvec3 median{0.0};
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(points.begin(), points.end(), values.begin(), [axis](const dvec3& p) { return p[axis]; });
        median[axis] = quantile(values, 0.5);
    }
    const auto distance = [&](const dvec3& p) { return std::sqrt(glm::dot(p - median, p - median)); };
    std::transform(points.begin(), points.end(), values.begin(), distance);
    const double reach = kReach * quantile(values, 0.9);
    std::erase_if(points, [&](const dvec3& p) { return distance(p) > reach; });
}

Aabb box_of(const std::vector<dvec3>& points) noexcept {
    Aabb box;
    for (const dvec3& p : points) box = merge(box, {p, p});
    return box;
}

}  // namespace carom::detail
