#include <carom/collision/teapot.hpp>

#include <carom/collision/detail/teapot_data.hpp>

#include <string>
#include <vector>

namespace carom {
namespace {

// The extent in x of the surface, in the data's unit. The handle reaches -3 exactly (its outer curve has three control points
// at x = -3). The spout's lip is the cubic with x = 3.3, 3.525, 3.45, 3.2, whose derivative 3 (0.225 - 0.6 t + 0.125 t^2)
// vanishes at t = (0.6 - sqrt(0.2475)) / 0.25.
constexpr double kWidth = 3.0 + 3.4340751254711077;

std::array<BezierPatch, kTeapotPatchCount> gather() {
    std::array<BezierPatch, kTeapotPatchCount> patches;
    for (std::size_t i = 0; i < kTeapotPatchCount; ++i) {
        for (std::size_t k = 0; k < 16; ++k) {
            patches[i].points[k] = detail::kTeapotPoints[detail::kTeapotIndices[i][k]];
        }
    }
    return patches;
}

}  // namespace

std::span<const dvec3, kTeapotPointCount> teapot_points() noexcept { return detail::kTeapotPoints; }

std::span<const std::array<std::uint16_t, 16>, kTeapotPatchCount> teapot_indices() noexcept {
    return detail::kTeapotIndices;
}

std::span<const BezierPatch, kTeapotPatchCount> teapot_patches() {
    static const std::array<BezierPatch, kTeapotPatchCount> patches = gather();
    return patches;
}

Result<MeshData> teapot(double size, double chord_error) {
    if (!is_finite(size)) {
        return Error{ErrorCode::NotFinite, "size must be finite", "teapot"};
    }
    if (size <= 0.0) {
        return Error{ErrorCode::InvalidArgument, "size must be positive, not " + std::to_string(size), "teapot"};
    }
    const double scale = size / kWidth;
    std::vector<BezierPatch> patches(teapot_patches().begin(), teapot_patches().end());
    for (BezierPatch& patch : patches) {
        for (dvec3& p : patch.points) {
            p = scale * dvec3{p.x, p.z, -p.y};
        }
    }
    return tessellate(patches, {.chord_error = chord_error});
}

}  // namespace carom
