#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mass_properties.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <Eigen/Eigenvalues>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace carom {
namespace {

Error failure(ErrorCode code, std::string message) { return {code, std::move(message), "mass_properties"}; }

MassProperties diagonal(double mass, const dvec3& moments) {
    MassProperties m{mass, dvec3{0.0}, dmat3{0.0}};
    for (int i = 0; i < 3; ++i) m.inertia[i][i] = moments[i];
    return m;
}

MassProperties properties_of(const Sphere& sphere, double density) {
    const double r = static_cast<double>(sphere.radius);
    const double mass = density * (4.0 / 3.0) * kPi * r * r * r;
    return diagonal(mass, dvec3{0.4 * mass * r * r});
}

MassProperties properties_of(const Box& box, double density) {
    const dvec3 h{box.half_extents};
    const double mass = density * 8.0 * h.x * h.y * h.z;
    const dvec3 s = h * h;
    return diagonal(mass, mass / 3.0 * dvec3{s.y + s.z, s.z + s.x, s.x + s.y});
}

/// A cylinder and two half balls, whose centres of mass lie 3/8 r beyond its ends.
MassProperties properties_of(const Capsule& capsule, double density) {
    const double r = static_cast<double>(capsule.radius);
    const double h = static_cast<double>(capsule.half_segment);
    const double cylinder = density * 2.0 * kPi * r * r * h;
    const double ball = density * (4.0 / 3.0) * kPi * r * r * r;
    const double along = r * r * (0.5 * cylinder + 0.4 * ball);
    const double across = cylinder * (0.25 * r * r + h * h / 3.0) + ball * (0.4 * r * r + h * h + 0.75 * h * r);
    return diagonal(cylinder + ball, {across, along, across});
}

MassProperties properties_of(const Cylinder& cylinder, double density) {
    const double r = static_cast<double>(cylinder.radius);
    const double h = static_cast<double>(cylinder.half_height);
    const double mass = density * 2.0 * kPi * r * r * h;
    const double across = mass * (0.25 * r * r + h * h / 3.0);
    return diagonal(mass, {across, 0.5 * mass * r * r, across});
}

/// The centre of mass is a quarter of the height over the base.
MassProperties properties_of(const Cone& cone, double density) {
    const double r = static_cast<double>(cone.radius);
    const double h = static_cast<double>(cone.half_height);
    const double mass = density * (2.0 / 3.0) * kPi * r * r * h;
    const double across = 0.15 * mass * (r * r + h * h);
    MassProperties m = diagonal(mass, {across, 0.3 * mass * r * r, across});
    m.center = {0.0, -0.5 * h, 0.0};
    return m;
}

/// The second moments of a mass point at distance `d`, as an inertia.
dmat3 point_inertia(double mass, const dvec3& d) {
    return mass * (dmat3{glm::dot(d, d)} - glm::outerProduct(d, d));
}

/// Sums volume, first and second moments of the tetrahedra between a local origin and the triangles of a closed surface.
/// Source: Mirtich, Fast and Accurate Computation of Polyhedral Mass Properties (1996); the tetrahedron's second moments as in
/// Eberly, Polyhedral Mass Properties (2002).
class SolidIntegral {
public:
    /// @param origin  close to the solid: moments about a far one would cancel.
    explicit SolidIntegral(const dvec3& origin) : origin_(origin) {}

    void add_triangle(const dvec3& p, const dvec3& q, const dvec3& r) {
        const dvec3 a = p - origin_;
        const dvec3 b = q - origin_;
        const dvec3 c = r - origin_;
        const dvec3 sum = a + b + c;
        const double six = glm::dot(a, glm::cross(b, c));
        six_volumes_ += six;
        first_ += six * sum;
        second_ += six * (glm::outerProduct(a, a) + glm::outerProduct(b, b) + glm::outerProduct(c, c) +
                          glm::outerProduct(sum, sum));
    }

    [[nodiscard]] double volume() const { return six_volumes_ / 6.0; }

    [[nodiscard]] MassProperties properties(double density) const {
        const double mass = density * volume();
        const dvec3 center = first_ / (4.0 * six_volumes_);
        const dmat3 covariance = density / 120.0 * second_ - mass * glm::outerProduct(center, center);
        const double trace = covariance[0][0] + covariance[1][1] + covariance[2][2];
        return {mass, origin_ + center, dmat3{trace} - covariance};
    }

private:
    dvec3 origin_;
    double six_volumes_ = 0.0;
    dvec3 first_{0.0};
    dmat3 second_{0.0};
};

dvec3 mean(std::span<const vec3> points) {
    dvec3 sum{0.0};
    for (const vec3& p : points) sum += dvec3{p};
    return sum / static_cast<double>(points.size());
}

MassProperties hull_properties(const ConvexHull& hull, double density) {
    const auto edges = hull.edges();
    const auto vertices = hull.vertices();
    SolidIntegral integral(mean(vertices));
    for (const ConvexHull::Face& face : hull.faces()) {
        const dvec3 apex{vertices[edges[face.first_edge].origin]};
        std::uint32_t edge = edges[face.first_edge].next;
        for (std::uint32_t i = 2; i < face.edge_count; ++i) {
            const std::uint32_t next = edges[edge].next;
            integral.add_triangle(apex, dvec3{vertices[edges[edge].origin]}, dvec3{vertices[edges[next].origin]});
            edge = next;
        }
    }
    return integral.properties(density);
}

Result<MassProperties> closed_mesh_properties(const TriangleMesh& mesh, double density) {
    SolidIntegral integral(mean(mesh.vertices()));
    for (const TriangleMesh::Triangle& t : mesh.triangles()) {
        const auto v = mesh.vertices();
        integral.add_triangle(dvec3{v[t[0]]}, dvec3{v[t[1]]}, dvec3{v[t[2]]});
    }
    const dvec3 size = mesh.local_bounds().upper - mesh.local_bounds().lower;
    const double extent = std::max({size.x, size.y, size.z});
    if (std::abs(integral.volume()) <= 1e-12 * extent * extent * extent) {
        return failure(ErrorCode::Degenerate, "the closed mesh has no volume");
    }
    if (integral.volume() < 0.0) return failure(ErrorCode::InvalidArgument, "the mesh is wound inside out");
    const MassProperties m = integral.properties(density);
    if (Status status = validate(m); !status) {
        return failure(ErrorCode::InvalidArgument, "parts of the mesh are wound inside out: " + status.error().message);
    }
    return m;
}

Result<MassProperties> open_mesh_properties(const TriangleMesh& mesh, double density) {
    std::vector<bool> used(mesh.vertices().size(), false);
    for (const TriangleMesh::Triangle& t : mesh.triangles()) used[t[0]] = used[t[1]] = used[t[2]] = true;
    std::vector<vec3> points;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i]) points.push_back(mesh.vertices()[i]);
    }
    const Result<ConvexHullPtr> hull = ConvexHull::build(points);
    if (!hull) return failure(ErrorCode::Degenerate, "the mesh is open and its hull is flat");
    return hull_properties(**hull, density);
}

Result<MassProperties> properties_of(const Plane&, double) {
    return failure(ErrorCode::WrongType, "a plane is unbounded and has no mass");
}
Result<MassProperties> properties_of(const ConvexHullPtr& hull, double density) { return hull_properties(*hull, density); }
Result<MassProperties> properties_of(const TriangleMeshPtr& mesh, double density) {
    return mesh->is_closed() ? closed_mesh_properties(*mesh, density) : open_mesh_properties(*mesh, density);
}

Result<MassProperties> properties_of(const CompoundPtr& compound, double density) {
    std::vector<MassProperties> parts;
    for (const CompoundPart& part : compound->parts()) {
        const Result<MassProperties> own = mass_properties(part.shape, part.material.density.value_or(density));
        if (!own) return own.error();
        parts.push_back(transform(*own, part.pose));
    }
    return combine(parts);
}

double trace(const dmat3& m) { return m[0][0] + m[1][1] + m[2][2]; }

double largest_off_diagonal(const dmat3& m) {
    return std::max({std::abs(m[0][1]), std::abs(m[0][2]), std::abs(m[1][2]), std::abs(m[1][0]), std::abs(m[2][0]),
                     std::abs(m[2][1])});
}

}  // namespace

Result<MassProperties> mass_properties(const Shape& shape, double density) {
    if (!is_finite(density) || !(density > 0.0)) {
        return failure(ErrorCode::InvalidArgument, "density must be finite and greater than 0");
    }
    if (Status status = validate(shape); !status) return status.error();
    return std::visit([&](const auto& s) -> Result<MassProperties> { return properties_of(s, density); }, shape);
}

MassProperties transform(const MassProperties& m, const Pose& pose) {
    // R I Rᵀ, by turning the columns of I and then the rows of the result.
    dmat3 half{0.0};
    for (int i = 0; i < 3; ++i) half[i] = rotate(pose.orientation, m.inertia[i]);
    half = glm::transpose(half);
    dmat3 turned{0.0};
    for (int i = 0; i < 3; ++i) turned[i] = rotate(pose.orientation, half[i]);
    return {m.mass, transform_point(pose, m.center), 0.5 * (turned + glm::transpose(turned))};
}

MassProperties combine(std::span<const MassProperties> parts) {
    MassProperties whole;
    if (parts.empty()) return whole;
    // Centres are summed relative to the first, so that nothing cancels far from the origin.
    const dvec3 reference = parts[0].center;
    dvec3 moment{0.0};
    for (const MassProperties& part : parts) {
        whole.mass += part.mass;
        moment += part.mass * (part.center - reference);
    }
    whole.center = whole.mass > 0.0 ? reference + moment / whole.mass : reference;
    for (const MassProperties& part : parts) {
        whole.inertia += part.inertia + point_inertia(part.mass, part.center - whole.center);
    }
    return whole;
}

PrincipalAxes principal_axes(const dmat3& inertia) {
    CAROM_REQUIRE(is_finite(inertia[0]) && is_finite(inertia[1]) && is_finite(inertia[2]), ErrorCode::NotFinite,
                  "principal_axes: the inertia is not finite", PrincipalAxes{});
    const double size = std::abs(inertia[0][0]) + std::abs(inertia[1][1]) + std::abs(inertia[2][2]);
    if (largest_off_diagonal(inertia) <= 1e-14 * size) {
        return {{inertia[0][0], inertia[1][1], inertia[2][2]}, kIdentityRotation};
    }
    Eigen::Matrix3d matrix;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) matrix(i, j) = 0.5 * (inertia[i][j] + inertia[j][i]);
    }
    // The iterative solver: the closed form loses half the digits where moments are close.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
    dmat3 axes{0.0};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) axes[i][j] = solver.eigenvectors()(j, i);
    }
    if (glm::determinant(axes) < 0.0) axes[2] = -axes[2];
    dquat turn = glm::normalize(glm::quat_cast(axes));
    if (turn.w < 0.0) turn = -turn;
    const auto& moments = solver.eigenvalues();
    return {{moments[0], moments[1], moments[2]}, turn};
}

Status validate(const MassProperties& m) {
    const auto refuse = [](ErrorCode code, std::string message) {
        return Status(Error{code, std::move(message), "validate(MassProperties)"});
    };
    if (!is_finite(m.mass)) return refuse(ErrorCode::NotFinite, "mass is not finite");
    if (!(m.mass > 0.0)) return refuse(ErrorCode::InvalidArgument, "mass must be greater than 0");
    if (!is_finite(m.center)) return refuse(ErrorCode::NotFinite, "center is not finite");
    if (!is_finite(m.inertia[0]) || !is_finite(m.inertia[1]) || !is_finite(m.inertia[2])) {
        return refuse(ErrorCode::NotFinite, "inertia is not finite");
    }
    const double size = trace(m.inertia);
    if (largest_off_diagonal(m.inertia - glm::transpose(m.inertia)) > 1e-9 * std::abs(size)) {
        return refuse(ErrorCode::InvalidArgument, "inertia is not symmetric");
    }
    const dvec3 moments = principal_axes(m.inertia).moments;
    const double least = std::min({moments.x, moments.y, moments.z});
    const double most = std::max({moments.x, moments.y, moments.z});
    if (!(least > 0.0)) return refuse(ErrorCode::InvalidArgument, "inertia is not positive definite");
    if (most > (moments.x + moments.y + moments.z - most) * (1.0 + 1e-6)) {
        return refuse(ErrorCode::InvalidArgument, "no solid has such moments: one exceeds the sum of the other two");
    }
    return {};
}

}  // namespace carom
