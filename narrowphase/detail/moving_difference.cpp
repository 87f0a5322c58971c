#include <carom/narrowphase/detail/moving_difference.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {

TimeSpan MovingDifference::separated_along(const dvec3& n, double separation) const noexcept {
    const dvec3 reach = glm::abs(n);
    const auto height = [&](const dvec3& d) {
        return glm::dot(n, d) - (separation * kLater + (kAlong * glm::dot(reach, glm::abs(d)) + kUnderflow));
    };
    TimeSpan proved{0.0, kNever};
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        const double before = height(start[i]);
        const double after = height(end[i]);
        if (before > 0.0 && after > 0.0) continue;
        if (before > 0.0) {
            proved.to = std::min(proved.to, before / (before - after) * kEarlier - kLeastTime);
        } else if (after > 0.0) {
            proved.from = std::max(proved.from, before / (before - after) * kLater + kLeastTime);
        } else {
            return {};
        }
    }
    return proved;
}

bool MovingDifference::separated_by_axis(double separation) const noexcept {
    const double least = separation * kLater + kAlong * size;
    dvec3 low = start[0];
    dvec3 high = start[0];
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        low = glm::min(low, glm::min(start[i], end[i]));
        high = glm::max(high, glm::max(start[i], end[i]));
    }
    return low.x > least || low.y > least || low.z > least || high.x < -least || high.y < -least || high.z < -least;
}

Coplanarity::Coplanarity(const MovingDifference& d, double separation) noexcept {
    const std::array<const std::array<dvec3, 4>*, 2> at{&d.start, &d.end};
    std::array<double, 8> product{};  // bit 0, 1, 2: corner 0, 1, 2 at its end
    for (std::size_t j = 0; j < 2; ++j) {
        for (std::size_t k = 0; k < 2; ++k) {
            const dvec3 area = glm::cross((*at[j])[1], (*at[k])[2]);
            product[2 * j + 4 * k] = glm::dot(d.start[0], area);
            product[2 * j + 4 * k + 1] = glm::dot(d.end[0], area);
        }
    }
    value_ = {product[0], (product[1] + product[2] + product[4]) / 3.0, (product[3] + product[5] + product[6]) / 3.0, product[7]};
    least_ = kTriple * d.size * d.size * d.size + kUnderflow;
    if (separation > 0.0) {
        // The product is the plane's distance times |(D1 - D0) x (D2 - D0)|, which the hull of its coefficients bounds.
        const dvec3 a0 = d.start[1] - d.start[0], a1 = d.end[1] - d.end[0];
        const dvec3 b0 = d.start[2] - d.start[0], b1 = d.end[2] - d.end[0];
        const dvec3 middle = 0.5 * (glm::cross(a0, b1) + glm::cross(a1, b0));
        const double area = std::max({glm::length(glm::cross(a0, b0)), glm::length(middle), glm::length(glm::cross(a1, b1))});
        least_ += separation * kLater * (area * kLater + 256.0 * 0x1p-53 * d.size * d.size);
    }
}

double Coplanarity::advance(double t) const noexcept {
    // The polynomial over [t, 1]: the right half of de Casteljau's triangle.
    std::array<double, 4> c = value_;
    if (t > 0.0) {
        const double s = 1.0 - t;
        for (int level = 0; level < 3; ++level) {
            for (std::size_t i = 0; i + 1 < 4 - static_cast<std::size_t>(level); ++i) c[i] = s * c[i] + t * c[i + 1];
        }
    }
    if (c[0] < 0.0) {
        for (double& value : c) value = -value;
    }
    for (double& value : c) value -= least_;
    if (!(c[0] > 0.0)) return t;
    // Where the hull of the coefficients first comes down to zero: between one above zero and one to the right of it that is not.
    double share = kNever;
    for (std::size_t j = 1; j < 4; ++j) {
        if (c[j] > 0.0) continue;
        for (std::size_t i = 0; i < j; ++i) {
            if (!(c[i] > 0.0)) continue;
            const double at = (static_cast<double>(i) + static_cast<double>(j - i) * (c[i] / (c[i] - c[j]))) / 3.0;
            share = std::min(share, at);
        }
    }
    if (share == kNever) return kNever;
    return std::max(t, (t + share * kEarlier * (1.0 - t)) * kEarlier - kLeastTime);
}

}  // namespace carom::detail
