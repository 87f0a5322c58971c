#include <carom/core/affine.hpp>

#include <carom/core/rotations.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace carom {
namespace {

// What the determinant of three unit vectors in a plane may be off zero by: each is off by 3 eps (its entries, its length and the
// division), and the determinant's own three products and sums add 5.
constexpr double kFlat = 14.0 * 0x1p-52;

double largest(const dvec3& v) noexcept { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

// The power of two near the vector's size, for products that neither overflow nor underflow; 1 for zero.
double scale_of(const dvec3& v) noexcept {
    const double size = largest(v);
    return size > 0.0 ? std::ldexp(1.0, std::clamp(std::ilogb(size), -1000, 1000)) : 1.0;
}

double length(const dvec3& v) noexcept {
    const double scale = scale_of(v);
    const dvec3 unit = v / scale;
    return scale * std::sqrt(glm::dot(unit, unit));
}

Error refused(ErrorCode code, std::string message, const char* where) { return {code, std::move(message), where}; }

// What any affine map must have.
Status check_affine(const dmat4& m, const char* where) {
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            if (!is_finite(m[c][r])) return refused(ErrorCode::NotFinite, "a matrix entry is not finite", where);
        }
    }
    if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0) {
        return refused(ErrorCode::InvalidArgument, "the last row is not 0 0 0 1: the map is a projection", where);
    }
    return {};
}

// How far three vectors are from perpendicular, with those that are of unit length.
double shear_of(const dmat3& m) noexcept {
    return std::max({std::fabs(glm::dot(m[0], m[1])), std::fabs(glm::dot(m[1], m[2])), std::fabs(glm::dot(m[2], m[0]))});
}

double determinant(const dmat3& m) noexcept { return glm::dot(m[0], glm::cross(m[1], m[2])); }

// One step of Newton's iteration for the nearest orthonormal matrix (Higham 1986): half of m and its inverse transpose.
dmat3 straightened(const dmat3& m) noexcept {
    const double inverse = 1.0 / determinant(m);
    return {0.5 * (m[0] + inverse * glm::cross(m[1], m[2])), 0.5 * (m[1] + inverse * glm::cross(m[2], m[0])),
            0.5 * (m[2] + inverse * glm::cross(m[0], m[1]))};
}

}  // namespace

dmat4 to_matrix(const Pose& pose) noexcept {
    const dmat3 r = rotation_matrix(pose.orientation);
    return {glm::dvec4(r[0], 0.0), glm::dvec4(r[1], 0.0), glm::dvec4(r[2], 0.0), glm::dvec4(pose.position, 1.0)};
}

Result<ScaledPose> decompose(const dmat4& m, double tolerance) {
    constexpr const char* kWhere = "decompose";
    if (const Status affine = check_affine(m, kWhere); !affine) return affine.error();
    dmat3 axes(m);
    dvec3 scale{0.0};
    for (int k = 0; k < 3; ++k) {
        scale[k] = length(axes[k]);
        if (!(scale[k] > 0.0))
            return refused(ErrorCode::Degenerate, "column " + std::to_string(k) + " is zero: the map flattens space", kWhere);
        if (!is_finite(scale[k])) return refused(ErrorCode::NotFinite, "the length of column " + std::to_string(k) + " overflows", kWhere);
        const double power = scale_of(axes[k]);
        axes[k] = (axes[k] / power) / (scale[k] / power);
    }
    if (!(shear_of(axes) <= tolerance)) {
        if (std::fabs(determinant(axes)) <= kFlat) return refused(ErrorCode::Degenerate, "the columns lie in a plane: the map flattens space", kWhere);
        return refused(ErrorCode::InvalidArgument, "the columns are not perpendicular: the map shears", kWhere);
    }
    if (determinant(axes) < 0.0) {
        scale.x = -scale.x;
        axes[0] = -axes[0];
    }
    return ScaledPose{{dvec3(m[3]), rotation_from_matrix(straightened(axes))}, scale};
}

Result<Pose> pose_from_matrix(const dmat4& m, double tolerance) {
    constexpr const char* kWhere = "pose_from_matrix";
    Result<ScaledPose> scaled = decompose(m, tolerance);
    if (!scaled) return refused(scaled.error().code, scaled.error().message, kWhere);
    if (scaled->scale.x < 0.0) return refused(ErrorCode::InvalidArgument, "the determinant is negative: the map mirrors", kWhere);
    // A squared length, as the products of different columns are.
    for (int k = 0; k < 3; ++k) {
        if (!(std::fabs(scaled->scale[k] * scaled->scale[k] - 1.0) <= tolerance)) {
            return refused(ErrorCode::InvalidArgument,
                           "column " + std::to_string(k) + " has length " + std::to_string(scaled->scale[k]) + ": the map scales", kWhere);
        }
    }
    return scaled->pose;
}

dvec3 transform_normal(const dmat3& m, const dvec3& n) noexcept {
    // Of m = c diag(powers), c has columns of a size near one; the inverse transpose is that of c, after n is divided by the powers.
    dmat3 c = m;
    int exponents[3] = {};
    int least = 2000;
    for (int k = 0; k < 3; ++k) {
        const double power = scale_of(m[k]);
        c[k] = m[k] / power;
        exponents[k] = largest(m[k]) > 0.0 ? std::ilogb(power) : 2000;
        least = std::min(least, exponents[k]);
    }
    dvec3 across = n / scale_of(n);
    for (int k = 0; k < 3; ++k) across[k] = std::ldexp(across[k], exponents[k] == 2000 ? 0 : least - exponents[k]);
    const dvec3 image = across.x * glm::cross(c[1], c[2]) + across.y * glm::cross(c[2], c[0]) + across.z * glm::cross(c[0], c[1]);
    const double size = length(image);
    if (!(size > 0.0) || !is_finite(size)) return dvec3{0.0};
    return (determinant(c) < 0.0 ? -1.0 : 1.0) * (image / size);
}

}  // namespace carom
