#include <carom/viz/shape_geometry.hpp>

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/viz/detail/mesh_normals.hpp>

#include <cmath>
#include <variant>

namespace carom {
namespace {

constexpr Color kShade{30, 34, 48, 255};
constexpr double kSecondShade = 0.22;  // how far the second tint is towards kShade

/// Writes vertices and triangles of one shape into a layer.
class Surface {
public:
    Surface(DebugLayer& layer, const Pose& pose, const ShapeStyle& style) : layer_(layer), pose_(pose), style_(style) {}

    std::uint32_t vertex(const dvec3& position, const dvec3& normal) {
        layer_.vertices.push_back({vec3(transform_point(pose_, position)), vec3(rotate(pose_.orientation, normal))});
        return static_cast<std::uint32_t>(layer_.vertices.size() - 1);
    }
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool second = false) {
        layer_.triangles.push_back({{a, b, c}, second ? style_.second : style_.color, style_.body});
    }
    void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, bool second = false) {
        triangle(a, b, c, second);
        triangle(a, c, d, second);
    }
    [[nodiscard]] int segments() const noexcept { return style_.segments; }

private:
    DebugLayer& layer_;
    const Pose& pose_;
    const ShapeStyle& style_;
};

void append(Surface& out, const Box& box) {
    const dvec3 h(box.half_extents);
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const double side : {1.0, -1.0}) {
            dvec3 normal{0.0};
            normal[axis] = side;
            std::uint32_t corner[4];
            for (int k = 0; k < 4; ++k) {
                dvec3 p{0.0};
                p[axis] = side * h[axis];
                p[u] = (k == 0 || k == 3 ? -h[u] : h[u]) * side;  // mirrored on the far side: outward either way
                p[v] = k < 2 ? -h[v] : h[v];
                corner[k] = out.vertex(p, normal);
            }
            out.quad(corner[0], corner[1], corner[2], corner[3]);
        }
    }
}

/// A sphere cut at its equator and drawn apart by 2 half_segment along y; with half_segment = 0 there is one equator.
void append_round(Surface& out, double radius, double half_segment) {
    const int n = out.segments();
    const bool split = half_segment > 0.0;
    std::vector<std::uint32_t> above, below;
    // The ring of one latitude, -1 (south) .. 1 (north), offset along y.
    const auto ring = [&](int step, double offset) {
        const SinCos latitude = sin_cos(kPi * (static_cast<double>(step) / (n / 2) - 0.5));
        std::vector<std::uint32_t> r;
        for (int k = 0; k < n; ++k) {
            const SinCos longitude = sin_cos(2.0 * kPi * k / n);
            const dvec3 normal{latitude.cos * longitude.cos, latitude.sin, -latitude.cos * longitude.sin};
            r.push_back(out.vertex(radius * normal + dvec3{0.0, offset, 0.0}, normal));
        }
        return r;
    };
    // Octants take turns in colour, so that every rotation shows.
    const auto second = [&](int k, bool north) { return ((k * 4 / n) % 2 == 0) == north; };
    const auto band = [&](bool north) {
        for (int k = 0; k < n; ++k) {
            const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>((k + 1) % n);
            out.quad(below[i], below[j], above[j], above[i], second(k, north));
        }
    };
    const std::uint32_t south = out.vertex({0.0, -radius - half_segment, 0.0}, {0.0, -1.0, 0.0});
    const std::uint32_t north = out.vertex({0.0, radius + half_segment, 0.0}, {0.0, 1.0, 0.0});
    for (int step = 1; step < n / 2; ++step) {
        const bool upper = step > n / 4;
        above = ring(step, upper ? half_segment : -half_segment);
        if (step == 1) {
            for (std::size_t k = 0; k < above.size(); ++k) {
                out.triangle(south, above[(k + 1) % above.size()], above[k], second(static_cast<int>(k), false));
            }
        } else {
            band(upper);
        }
        below = above;
        if (step == n / 4 && split) {
            above = ring(step, half_segment);
            band(true);
            below = above;
        }
    }
    for (int k = 0; k < n; ++k) {
        out.triangle(north, below[static_cast<std::size_t>(k)], below[static_cast<std::size_t>((k + 1) % n)], second(k, true));
    }
}

void append(Surface& out, const Sphere& sphere) { append_round(out, static_cast<double>(sphere.radius), 0.0); }

void append(Surface& out, const Capsule& capsule) {
    append_round(out, static_cast<double>(capsule.radius), static_cast<double>(capsule.half_segment));
}

dvec3 on_circle(int k, int segments) {
    const SinCos angle = sin_cos(2.0 * kPi * (k % segments) / segments);  // the last point is the first to the last bit
    return {angle.cos, 0.0, -angle.sin};
}

/// A flat round end: `side` is +1 for the one that faces up.
void append_disc(Surface& out, double radius, double y, double side) {
    const int n = out.segments();
    std::vector<std::uint32_t> rim;
    for (int k = 0; k < n; ++k) rim.push_back(out.vertex(radius * on_circle(k, n) + dvec3{0.0, y, 0.0}, {0.0, side, 0.0}));
    for (std::size_t k = 2; k < rim.size(); ++k) {
        out.triangle(rim[0], side > 0.0 ? rim[k - 1] : rim[k], side > 0.0 ? rim[k] : rim[k - 1], true);
    }
}

/// The side between two coaxial circles; quarters take turns in colour. An upper radius of 0 makes a cone.
void append_side(Surface& out, double lower, double upper, double half_height) {
    const int n = out.segments();
    const auto point = [&](int k, double radius, double y) { return radius * on_circle(k, n) + dvec3{0.0, y, 0.0}; };
    const double slant = std::sqrt(4.0 * half_height * half_height + (lower - upper) * (lower - upper));
    const auto normal = [&](const dvec3& outward) {
        return (2.0 * half_height / slant) * outward + dvec3{0.0, (lower - upper) / slant, 0.0};
    };
    for (int k = 0; k < n; ++k) {
        const dvec3 first = normal(on_circle(k, n)), last = normal(on_circle(k + 1, n));
        const bool second = (k * 4 / n) % 2 == 1;
        const std::uint32_t a = out.vertex(point(k, lower, -half_height), first), b = out.vertex(point(k + 1, lower, -half_height), last);
        if (upper > 0.0) {
            out.quad(a, b, out.vertex(point(k + 1, upper, half_height), last), out.vertex(point(k, upper, half_height), first), second);
        } else {
            out.triangle(a, b, out.vertex({0.0, half_height, 0.0}, glm::normalize(first + last)), second);
        }
    }
}

void append(Surface& out, const Cylinder& cylinder) {
    const double radius = static_cast<double>(cylinder.radius), h = static_cast<double>(cylinder.half_height);
    append_disc(out, radius, -h, -1.0);
    append_side(out, radius, radius, h);
    append_disc(out, radius, h, 1.0);
}

void append(Surface& out, const Cone& cone) {
    const double radius = static_cast<double>(cone.radius), h = static_cast<double>(cone.half_height);
    append_disc(out, radius, -h, -1.0);
    append_side(out, radius, 0.0, h);
}

void append(Surface&, const CompoundPtr&) {}  // append_shape does its parts

void append(Surface&, const Plane&) {}  // refused by append_shape

void append(Surface& out, const ConvexHullPtr& hull) {
    for (const ConvexHull::Face& face : hull->faces()) {
        std::uint32_t first = 0, previous = 0, edge = face.first_edge;
        for (std::uint32_t k = 0; k < face.edge_count; ++k) {
            const ConvexHull::HalfEdge& half_edge = hull->edges()[edge];
            const std::uint32_t v = out.vertex(dvec3(hull->vertices()[half_edge.origin]), face.normal);
            if (k == 0) first = v;
            if (k >= 2) out.triangle(first, previous, v);
            previous = v;
            edge = half_edge.next;
        }
    }
}

void append(Surface& out, const TriangleMeshPtr& mesh) {
    const std::vector<vec3> normals = detail::corner_normals(mesh->vertices(), mesh->triangles());
    for (std::size_t t = 0; t < mesh->triangles().size(); ++t) {
        std::uint32_t corner[3];
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = out.vertex(dvec3(mesh->vertices()[mesh->triangles()[t][k]]), dvec3(normals[3 * t + k]));
        }
        out.triangle(corner[0], corner[1], corner[2]);
    }
}

bool is_null(const Shape& shape) {
    const auto* hull = std::get_if<ConvexHullPtr>(&shape);
    const auto* mesh = std::get_if<TriangleMeshPtr>(&shape);
    const auto* compound = std::get_if<CompoundPtr>(&shape);
    return (hull != nullptr && *hull == nullptr) || (mesh != nullptr && *mesh == nullptr) ||
           (compound != nullptr && *compound == nullptr);
}

}  // namespace

ShapeStyle two_tone(Color color, BodyId body, int segments) noexcept {
    return {color, mix(color, kShade, kSecondShade), body, segments};
}

void append_shape(DebugLayer& layer, const Shape& shape, const Pose& pose, const ShapeStyle& style) {
    CAROM_REQUIRE(is_bounded(shape), ErrorCode::WrongType, "a plane has no end: use append_plane");
    CAROM_REQUIRE(!is_null(shape), ErrorCode::Empty, "the shape's pointer is null");
    CAROM_REQUIRE(is_finite(pose), ErrorCode::NotFinite, "the pose is not finite");
    CAROM_REQUIRE(style.segments >= 4 && style.segments <= 256 && style.segments % 4 == 0, ErrorCode::InvalidArgument,
                  "segments must be a multiple of 4 in 4..256");
    if (const CompoundPtr* compound = std::get_if<CompoundPtr>(&shape)) {
        for (const CompoundPart& part : (*compound)->parts()) append_shape(layer, part.shape, pose * part.pose, style);
        return;
    }
    Surface surface(layer, pose, style);
    std::visit([&](const auto& s) { append(surface, s); }, shape);
}

void append_plane(DebugLayer& layer, const Plane& plane, const Pose& pose, const PlanePatch& patch, const ShapeStyle& style) {
    CAROM_REQUIRE(is_finite(pose) && is_finite(patch.center) && is_finite(plane.normal) && is_finite(plane.offset),
                  ErrorCode::NotFinite, "the plane, its pose and its patch must be finite");
    CAROM_REQUIRE(patch.half_size > 0.0 && is_finite(patch.half_size), ErrorCode::InvalidArgument,
                  "half_size must be positive");
    CAROM_REQUIRE(patch.tiles >= 1 && patch.tiles <= 256, ErrorCode::InvalidArgument, "tiles must be in 1..256");
    const dvec3 normal = glm::normalize(dvec3(plane.normal));
    const dvec3 center = inverse_transform_point(pose, patch.center);
    const dvec3 middle = center + (static_cast<double>(plane.offset) - glm::dot(normal, center)) * normal;
    const dvec3 u = any_perpendicular(normal);
    const dvec3 v = glm::cross(normal, u);
    const double tile = 2.0 * patch.half_size / patch.tiles;
    Surface surface(layer, pose, style);
    const int row = patch.tiles + 1;
    const auto first = static_cast<std::uint32_t>(layer.vertices.size());
    for (int i = 0; i < row * row; ++i) {
        const double a = tile * (i % row) - patch.half_size, b = tile * (i / row) - patch.half_size;
        surface.vertex(middle + a * u + b * v, normal);
    }
    for (int j = 0; j < patch.tiles; ++j) {
        for (int i = 0; i < patch.tiles; ++i) {
            const std::uint32_t k = first + static_cast<std::uint32_t>(j * row + i);
            const auto up = static_cast<std::uint32_t>(row);
            surface.quad(k, k + 1, k + 1 + up, k + up, (i + j) % 2 == 1);
        }
    }
}

void append_box_edges(DebugLayer& layer, const Aabb& box, const Pose& pose, Color color, BodyId body) {
    if (is_empty(box) || !is_finite(box.lower) || !is_finite(box.upper)) return;
    const auto corner = [&](int index) {
        const dvec3 local{(index & 1) != 0 ? box.upper.x : box.lower.x, (index & 2) != 0 ? box.upper.y : box.lower.y,
                          (index & 4) != 0 ? box.upper.z : box.lower.z};
        return vec3(transform_point(pose, local));
    };
    for (int index = 0; index < 8; ++index) {
        for (const int bit : {1, 2, 4}) {
            if ((index & bit) == 0) layer.lines.push_back({corner(index), corner(index | bit), color, body});
        }
    }
}

}  // namespace carom
