#include <carom/collision/bezier.hpp>

#include <carom/collision/detail/patch_grid.hpp>
#include <carom/core/check.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace carom {
namespace {

using Curve = std::array<dvec3, 4>;

Curve row_of(const BezierPatch& patch, std::size_t i) {
    return {patch.points[4 * i], patch.points[4 * i + 1], patch.points[4 * i + 2], patch.points[4 * i + 3]};
}

Curve column_of(const BezierPatch& patch, std::size_t j) {
    return {patch.points[j], patch.points[4 + j], patch.points[8 + j], patch.points[12 + j]};
}

// Written as a + t (b - a), so that equal points stay exactly equal.
dvec3 between(const dvec3& a, const dvec3& b, double t) { return a + t * (b - a); }

// The part of a curve from t on: de Casteljau's right half.
Curve right_part(const Curve& c, double t) {
    const dvec3 a = between(c[0], c[1], t), b = between(c[1], c[2], t), d = between(c[2], c[3], t);
    const dvec3 e = between(a, b, t), f = between(b, d, t);
    return {between(e, f, t), f, d, c[3]};
}

Curve reversed(const Curve& c) { return {c[3], c[2], c[1], c[0]}; }

// The patch seen from (u, v) as its first corner, with the farther corner as its last.
BezierPatch seen_from(const BezierPatch& patch, double u, double v) {
    BezierPatch across;
    for (std::size_t i = 0; i < 4; ++i) {
        const Curve row = row_of(patch, i);
        const Curve part = u <= 0.5 ? right_part(row, u) : right_part(reversed(row), 1.0 - u);
        for (std::size_t j = 0; j < 4; ++j) {
            across.points[4 * i + j] = part[j];
        }
    }
    BezierPatch seen;
    for (std::size_t j = 0; j < 4; ++j) {
        const Curve column = column_of(across, j);
        const Curve part = v <= 0.5 ? right_part(column, v) : right_part(reversed(column), 1.0 - v);
        for (std::size_t i = 0; i < 4; ++i) {
            seen.points[4 * i + j] = part[i];
        }
    }
    return seen;
}

// The coefficients of x^j y^i of the patch about its first corner: forward differences times binomials.
std::array<dvec3, 16> taylor(const BezierPatch& patch) {
    std::array<dvec3, 16> c = patch.points;
    for (std::size_t order = 1; order < 4; ++order) {
        for (std::size_t j = 3; j >= order; --j) {
            for (std::size_t i = 0; i < 4; ++i) {
                c[4 * i + j] -= c[4 * i + j - 1];
            }
        }
    }
    for (std::size_t order = 1; order < 4; ++order) {
        for (std::size_t i = 3; i >= order; --i) {
            for (std::size_t j = 0; j < 4; ++j) {
                c[4 * i + j] -= c[4 * (i - 1) + j];
            }
        }
    }
    constexpr std::array<double, 4> binomial{1.0, 3.0, 3.0, 1.0};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            c[4 * i + j] *= binomial[i] * binomial[j];
        }
    }
    return c;
}

// The direction of S_x cross S_y at the first corner, as the limit along x = y: both derivatives are polynomials of degree 5
// in s = x = y, and the lowest coefficient of their cross product that is not zero gives the limit.
dvec3 limit_normal(const std::array<dvec3, 16>& c) {
    std::array<dvec3, 6> along_x{}, along_y{};
    along_x.fill(dvec3{0.0});
    along_y.fill(dvec3{0.0});
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            if (j > 0) {
                along_x[i + j - 1] += static_cast<double>(j) * c[4 * i + j];
            }
            if (i > 0) {
                along_y[i + j - 1] += static_cast<double>(i) * c[4 * i + j];
            }
        }
    }
    double size = 0.0;
    for (std::size_t k = 0; k < 6; ++k) {
        size = std::max({size, glm::length(along_x[k]), glm::length(along_y[k])});
    }
    // What rounding of the differences can leave of a cross product that is zero.
    const double noise = 64.0 * std::numeric_limits<double>::epsilon() * size * size;
    for (std::size_t k = 0; k <= 10; ++k) {
        dvec3 coefficient{0.0};
        for (std::size_t m = k > 5 ? k - 5 : 0; m <= std::min<std::size_t>(k, 5); ++m) {
            coefficient += glm::cross(along_x[m], along_y[k - m]);
        }
        const double length = glm::length(coefficient);
        if (length > noise) {
            return coefficient / length;
        }
    }
    return dvec3{0.0};
}

}  // namespace

SurfacePoint evaluate(const BezierPatch& patch, double u, double v) {
    CAROM_REQUIRE(is_finite(u) && is_finite(v), ErrorCode::NotFinite, "evaluate: u and v must be finite", {});
    CAROM_REQUIRE(u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0, ErrorCode::InvalidArgument,
                  "evaluate: u and v must be in [0, 1]", {});
    const BezierPatch seen = seen_from(patch, u, v);
    const std::array<dvec3, 16> c = taylor(seen);
    // Back from the part's own parameters, which run over the length that is left, to those of the patch.
    const double scale_u = u <= 0.5 ? 1.0 / (1.0 - u) : -1.0 / u;
    const double scale_v = v <= 0.5 ? 1.0 / (1.0 - v) : -1.0 / v;
    SurfacePoint point;
    point.position = seen.points[0];
    point.along_u = c[1] * scale_u;
    point.along_v = c[4] * scale_v;
    point.normal = limit_normal(c) * (scale_u * scale_v > 0.0 ? 1.0 : -1.0);
    return point;
}

Result<MeshData> tessellate(std::span<const BezierPatch> patches, const TessellationSettings& settings) {
    constexpr double kMaxTriangles = 134217728.0;
    if (!is_finite(settings.chord_error) || settings.chord_error <= 0.0) {
        return Error{ErrorCode::InvalidArgument, "chord_error must be positive and finite", "tessellate"};
    }
    if (patches.empty()) {
        return Error{ErrorCode::Empty, "no patches", "tessellate"};
    }
    std::vector<detail::PatchGrid> grids;
    grids.reserve(patches.size());
    double triangles = 0.0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const std::string where = "tessellate: patch " + std::to_string(i);
        for (const dvec3& p : patches[i].points) {
            if (!is_finite(p)) {
                return Error{ErrorCode::NotFinite, "a control point is not finite", where};
            }
        }
        std::optional<detail::PatchGrid> grid = detail::plan_grid(patches[i], settings.chord_error);
        if (!grid) {
            return Error{ErrorCode::InvalidArgument, "chord_error is too small for a patch of this size", where};
        }
        triangles += 2.0 * static_cast<double>(grid->u.size()) * static_cast<double>(grid->v.size());
        grids.push_back(std::move(*grid));
    }
    if (triangles > kMaxTriangles) {
        return Error{ErrorCode::InvalidArgument, "chord_error is too small: more than 2^27 triangles", "tessellate"};
    }
    MeshData mesh;
    for (std::size_t i = 0; i < patches.size(); ++i) {
        detail::append(mesh, patches[i], grids[i]);
    }
    mesh = weld(mesh);
    if (mesh.triangles.empty()) {
        return Error{ErrorCode::Empty, "every patch is a curve or a point", "tessellate"};
    }
    return mesh;
}

}  // namespace carom
