// Mass properties against closed forms and exact rational arithmetic.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mass_properties.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <boost/multiprecision/cpp_int.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

double trace(const dmat3& m) { return m[0][0] + m[1][1] + m[2][2]; }

/// Equal to `relative` of mass, of `reach` (for the centre) and of the inertia's trace.
void expect_near(const MassProperties& a, const MassProperties& b, double relative, double reach) {
    EXPECT_NEAR(a.mass, b.mass, relative * b.mass);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(a.center[i], b.center[i], relative * reach) << "axis " << i;
        for (int j = 0; j < 3; ++j) {
            EXPECT_NEAR(a.inertia[i][j], b.inertia[i][j], relative * trace(b.inertia)) << i << ", " << j;
            EXPECT_EQ(a.inertia[i][j], a.inertia[j][i]) << "symmetric";
        }
    }
}

MassProperties properties(const Shape& shape, double density) {
    const Result<MassProperties> m = mass_properties(shape, density);
    EXPECT_TRUE(m.has_value()) << (m ? "" : m.error().message);
    if (!m) return {};
    EXPECT_TRUE(validate(*m).ok());
    return *m;
}

dvec3 random_vector(Random& random, double size) {
    return {random.range(-size, size), random.range(-size, size), random.range(-size, size)};
}

Pose random_pose(Random& random, double distance) {
    const dvec3 v = random_vector(random, 1.0);
    return {random_vector(random, distance), glm::normalize(dquat{random.range(-1, 1), v.x, v.y, v.z})};
}

std::vector<vec3> box_points(const dvec3& half, const dvec3& center = dvec3{0.0}) {
    std::vector<vec3> points;
    for (int i = 0; i < 8; ++i) {
        points.emplace_back(center + dvec3{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
    }
    return points;
}

const std::vector<TriangleMesh::Triangle> kBoxTriangles{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                                        {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

TriangleMeshPtr mesh_of(const std::vector<vec3>& points, std::vector<TriangleMesh::Triangle> triangles) {
    return *TriangleMesh::build(points, triangles);
}

// ---- an exact oracle -------------------------------------------------------------------------------------------------

using Rational = boost::multiprecision::cpp_rational;

/// Volume, first and second moments about the world's origin of the polyhedron whose faces are fans of a hull's polygons.
/// Independent of the library's formulas: each monomial's integral over a tetrahedron with corners 0, a, b, c is
/// det · Σ over pairs of corners of x_i x_j (1 + [same corner]) / 120.
MassProperties exact_properties(const ConvexHull& hull, double density) {
    using Vector = std::array<Rational, 3>;
    const auto vertex = [&](std::uint32_t edge) {
        const vec3 v = hull.vertices()[hull.edges()[edge].origin];
        return Vector{Rational(static_cast<double>(v.x)), Rational(static_cast<double>(v.y)), Rational(static_cast<double>(v.z))};
    };
    Rational volume = 0;
    Vector first{0, 0, 0};
    std::array<Vector, 3> second{first, first, first};
    for (const ConvexHull::Face& face : hull.faces()) {
        std::uint32_t edge = hull.edges()[face.first_edge].next;
        for (std::uint32_t k = 2; k < face.edge_count; ++k) {
            const std::array<Vector, 3> corner{vertex(face.first_edge), vertex(edge), vertex(hull.edges()[edge].next)};
            edge = hull.edges()[edge].next;
            const auto& [a, b, c] = corner;
            const Rational det = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                                 a[2] * (b[0] * c[1] - b[1] * c[0]);
            volume += det / 6;
            for (std::size_t i = 0; i < 3; ++i) {
                first[i] += det * (a[i] + b[i] + c[i]) / 24;
                for (std::size_t j = 0; j < 3; ++j) {
                    Rational sum = 0;
                    for (std::size_t p = 0; p < 3; ++p) {
                        for (std::size_t q = 0; q < 3; ++q) sum += corner[p][i] * corner[q][j] * (p == q ? 2 : 1);
                    }
                    second[i][j] += det * sum / 120;
                }
            }
        }
    }
    MassProperties m;
    m.mass = static_cast<double>(volume) * density;
    std::array<Vector, 3> central{first, first, first};
    for (std::size_t i = 0; i < 3; ++i) {
        m.center[static_cast<int>(i)] = static_cast<double>(Rational(first[i] / volume));
        for (std::size_t j = 0; j < 3; ++j) central[i][j] = second[i][j] - first[i] * first[j] / volume;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const Rational whole = i == j ? central[0][0] + central[1][1] + central[2][2] : Rational(0);
            m.inertia[static_cast<int>(i)][static_cast<int>(j)] = static_cast<double>(Rational(whole - central[i][j])) * density;
        }
    }
    return m;
}

// ---- shapes ----------------------------------------------------------------------------------------------------------

TEST(MassProperties, SphereBoxAndCapsule) {
    const MassProperties ball = properties(Sphere{0.5f}, 3.0);
    EXPECT_NEAR(ball.mass, 3.0 * kPi / 6.0, 1e-15);
    EXPECT_NEAR(ball.inertia[1][1], 0.4 * ball.mass * 0.25, 1e-15);
    const MassProperties box = properties(Box{{0.5f, 1.0f, 1.5f}}, 2.0);
    EXPECT_EQ(box.mass, 12.0);
    EXPECT_NEAR(box.inertia[0][0], 12.0 / 12.0 * (4.0 + 9.0), 1e-13);
    EXPECT_NEAR(box.inertia[1][1], 12.0 / 12.0 * (1.0 + 9.0), 1e-13);
    EXPECT_NEAR(box.inertia[2][2], 12.0 / 12.0 * (1.0 + 4.0), 1e-13);
    // A capsule without a segment is a ball; one without end caps to speak of is a rod, m L² / 12.
    expect_near(properties(Capsule{0.5f, 0.0f}, 3.0), ball, 1e-15, 1.0);
    const MassProperties rod = properties(Capsule{0x1p-20f, 1.0f}, 1.0);
    EXPECT_NEAR(rod.inertia[0][0] / (rod.mass * 4.0 / 12.0), 1.0, 4e-6);
    EXPECT_NEAR(rod.inertia[1][1] / (rod.mass * 0.5 * 0x1p-40), 1.0, 1e-6);
}

TEST(MassProperties, CapsuleIsTheIntegralOverItsSlices) {
    // Along y the moments of discs of radius w(y) are polynomials up to degree 4 on each of three pieces, which Simpson's rule on
    // two panels with Richardson's correction (Boole's rule, exact to degree 5) integrates exactly.
    const double r = 0.375;
    const double h = 0.75;
    const auto boole = [](auto&& f, double a, double b) {
        const double s = (b - a) / 4.0;
        return (b - a) / 90.0 * (7 * f(a) + 32 * f(a + s) + 12 * f(a + 2 * s) + 32 * f(a + 3 * s) + 7 * f(b));
    };
    const auto over_capsule = [&](auto&& f) {
        return boole(f, -h - r, -h) + boole(f, -h, h) + boole(f, h, h + r);
    };
    const auto w2 = [&](double y) {
        const double beyond = std::max(std::abs(y) - h, 0.0);
        return r * r - beyond * beyond;
    };
    const MassProperties m = properties(Capsule{0.375f, 0.75f}, 2.0);
    const double mass = 2.0 * over_capsule([&](double y) { return kPi * w2(y); });
    const double along = 2.0 * over_capsule([&](double y) { return kPi * w2(y) * w2(y) / 2.0; });
    const double across = 2.0 * over_capsule([&](double y) { return kPi * w2(y) * (w2(y) / 4.0 + y * y); });
    EXPECT_NEAR(m.mass, mass, 1e-14 * mass);
    EXPECT_NEAR(m.inertia[1][1], along, 1e-14 * along);
    EXPECT_NEAR(m.inertia[0][0], across, 1e-14 * across);
    EXPECT_EQ(m.inertia[2][2], m.inertia[0][0]);
}

TEST(MassProperties, TetrahedronClosedForm) {
    // Right-angled corner with legs a, b, c: ∫x² = V a²/10, ∫xy = V ab/20.
    const double a = 1.0, b = 2.0, c = 0.5;
    const std::vector<vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 0.5f}};
    const double volume = a * b * c / 6.0;
    const dvec3 center{a / 4.0, b / 4.0, c / 4.0};
    const double xx = volume * a * a * (0.1 - 0.0625), yy = volume * b * b * (0.1 - 0.0625), zz = volume * c * c * (0.1 - 0.0625);
    const double xy = volume * a * b * (0.05 - 0.0625), yz = volume * b * c * (0.05 - 0.0625), zx = volume * c * a * (0.05 - 0.0625);
    const MassProperties expected{volume, center, dmat3{yy + zz, -xy, -zx, -xy, zz + xx, -yz, -zx, -yz, xx + yy}};
    expect_near(properties(*ConvexHull::build(points), 1.0), expected, 1e-15, 1.0);
    const TriangleMeshPtr mesh = mesh_of(points, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
    ASSERT_TRUE(mesh->is_closed());
    expect_near(properties(mesh, 1.0), expected, 1e-15, 1.0);
}

TEST(MassProperties, BoxAsHullAndAsMeshIsTheBox) {
    for (const dvec3 half : {dvec3{0.5, 1.0, 1.5}, dvec3{1e-3, 1.0, 100.0}, dvec3{1e-4, 1e-4, 1e-4}, dvec3{3e4, 1e4, 1e5}}) {
        const vec3 h{half};
        const MassProperties expected = properties(Box{h}, 7.0);
        expect_near(properties(*ConvexHull::build(box_points(dvec3{h})), 7.0), expected, 1e-14, glm::length(half));
        const TriangleMeshPtr mesh = mesh_of(box_points(dvec3{h}), kBoxTriangles);
        ASSERT_TRUE(mesh->is_closed());
        expect_near(properties(mesh, 7.0), expected, 1e-14, glm::length(half));
    }
}

TEST(MassProperties, HullsAgreeWithExactRationals) {
    Random random(41);
    for (int k = 0; k < 60; ++k) {
        const dvec3 stretch = k % 3 == 0 ? dvec3{1.0} : k % 3 == 1 ? dvec3{1.0, 1e-3, 1.0} : dvec3{1e-3, 1.0, 1e-3};
        const dvec3 away = random_vector(random, k % 2 == 0 ? 0.0 : 50.0);
        std::vector<vec3> points;
        for (int i = 0; i < 8 + k; ++i) points.emplace_back(away + stretch * random_vector(random, 1.0));
        const ConvexHullPtr hull = *ConvexHull::build(points);
        // Cancellation is in the solid's own size only: 1e-13 where a coordinate is 1e-3 of it, whatever the distance.
        expect_near(properties(hull, 2.5), exact_properties(*hull, 2.5), 1e-13, 1.0);
    }
}

TEST(MassProperties, NothingIsLostFarFromTheOrigin) {
    // Multiples of 1/8 stay exact at 1e5, so the same box must come out to rounding. About the world's origin 10 digits would go.
    const dvec3 half{0.5, 1.0, 0.25};
    const dvec3 away{1e5, -7e4, 3e4};
    MassProperties expected = properties(Box{vec3{half}}, 1.0);
    expected.center = away;
    expect_near(properties(*ConvexHull::build(box_points(half, away)), 1.0), expected, 1e-14, 1e5);
    expect_near(properties(mesh_of(box_points(half, away), kBoxTriangles), 1.0), expected, 1e-14, 1e5);
}

TEST(MassProperties, AnOpenMeshIsTakenAsItsHull) {
    std::vector<TriangleMesh::Triangle> open(kBoxTriangles.begin(), kBoxTriangles.end() - 1);
    std::vector<vec3> points = box_points({1.0, 2.0, 3.0});
    points.push_back({50, 50, 50});  // belongs to no triangle
    const TriangleMeshPtr mesh = mesh_of(points, open);
    ASSERT_FALSE(mesh->is_closed());
    expect_near(properties(mesh, 1.0), properties(Box{{1, 2, 3}}, 1.0), 1e-14, 1.0);
}

TEST(MassProperties, BadInputIsNamed) {
    const auto code = [](const Shape& shape, double density) {
        const Result<MassProperties> m = mass_properties(shape, density);
        return m ? ErrorCode::Io : m.error().code;
    };
    const double inf = std::numeric_limits<double>::infinity();
    for (const double bad : {0.0, -1.0, inf, -inf, std::nan("")}) EXPECT_EQ(code(Sphere{}, bad), ErrorCode::InvalidArgument);
    EXPECT_EQ(code(Plane{}, 1.0), ErrorCode::WrongType);
    EXPECT_EQ(code(Sphere{-1.0f}, 1.0), ErrorCode::InvalidArgument);
    EXPECT_EQ(code(ConvexHullPtr{}, 1.0), ErrorCode::Empty);
    EXPECT_EQ(code(TriangleMeshPtr{}, 1.0), ErrorCode::Empty);

    std::vector<TriangleMesh::Triangle> inside_out = kBoxTriangles;
    for (auto& t : inside_out) std::swap(t[1], t[2]);
    EXPECT_EQ(code(mesh_of(box_points(dvec3{1.0}), inside_out), 1.0), ErrorCode::InvalidArgument);
    EXPECT_EQ(code(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), 1.0), ErrorCode::Degenerate);
    EXPECT_EQ(code(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}), 1.0), ErrorCode::Degenerate);
}

// ---- moving, adding ----------------------------------------------------------------------------------------------------

TEST(MassProperties, TransformMatchesTheTurnedHull) {
    Random random(42);
    for (int k = 0; k < 50; ++k) {
        std::vector<vec3> points;
        for (int i = 0; i < 20; ++i) points.emplace_back(random_vector(random, 1.0));
        const Pose pose = random_pose(random, 3.0);
        std::vector<vec3> turned;
        for (const vec3& p : points) turned.emplace_back(transform_point(pose, dvec3{p}));
        // The turned points are rounded to float: 2^-23 of 6 m at most, and inertia goes with the square of length.
        expect_near(properties(*ConvexHull::build(turned), 1.0), transform(properties(*ConvexHull::build(points), 1.0), pose), 2e-6, 1.0);
    }
}

TEST(MassProperties, TransformUndoneIsTheSame) {
    Random random(43);
    for (int k = 0; k < 50; ++k) {
        const MassProperties m = transform(properties(Box{{0.25f, 1.0f, 0.5f}}, 1.0), random_pose(random, 3.0));
        const Pose pose = random_pose(random, 3.0);
        expect_near(transform(transform(m, pose), inverse(pose)), m, 1e-14, 3.0);
        EXPECT_NEAR(trace(transform(m, pose).inertia), trace(m.inertia), 1e-14);
    }
}

TEST(MassProperties, QuarterTurnSwapsMoments) {
    const double s = std::sqrt(0.5);
    const MassProperties m = properties(Box{{0.5f, 1.0f, 1.5f}}, 1.0);
    const MassProperties turned = transform(m, {{1.0, 2.0, 3.0}, dquat{s, 0.0, 0.0, s}});
    EXPECT_NEAR(turned.inertia[0][0], m.inertia[1][1], 1e-14);
    EXPECT_NEAR(turned.inertia[1][1], m.inertia[0][0], 1e-14);
    EXPECT_EQ(turned.center, (dvec3{1.0, 2.0, 3.0}));
}

TEST(MassProperties, TwoHalfBoxesAreTheBox) {
    Random random(44);
    const MassProperties whole = properties(Box{{1.0f, 0.5f, 0.75f}}, 4.0);
    const MassProperties half = properties(Box{{0.5f, 0.5f, 0.75f}}, 4.0);
    for (int k = 0; k < 20; ++k) {
        const Pose pose = k == 0 ? Pose{} : random_pose(random, 10.0);
        const std::array<MassProperties, 2> parts{transform(half, pose * Pose{{-0.5, 0.0, 0.0}, kIdentityRotation}),
                                                  transform(half, pose * Pose{{0.5, 0.0, 0.0}, kIdentityRotation})};
        expect_near(combine(parts), transform(whole, pose), 1e-14, 10.0);
    }
}

TEST(MassProperties, CombineOfNoneAndOne) {
    EXPECT_EQ(combine({}).mass, 0.0);
    const MassProperties m = transform(properties(Box{}, 1.0), {{1, 2, 3}, kIdentityRotation});
    const MassProperties same = combine({&m, 1});
    EXPECT_EQ(same.mass, m.mass);
    EXPECT_EQ(same.center, m.center);
    EXPECT_EQ(same.inertia, m.inertia);
}

// ---- principal axes ----------------------------------------------------------------------------------------------------

dmat3 recomposed(const PrincipalAxes& p) {
    dmat3 sum{0.0};
    for (int i = 0; i < 3; ++i) {
        dvec3 unit{0.0};
        unit[i] = 1.0;
        const dvec3 axis = rotate(p.orientation, unit);
        sum += p.moments[i] * glm::outerProduct(axis, axis);
    }
    return sum;
}

TEST(PrincipalAxes, RecomposeTheInertia) {
    Random random(45);
    for (int k = 0; k < 500; ++k) {
        // From distinct moments over equal and nearly equal ones to needles.
        const double spread = std::ldexp(1.0, -(k % 50));
        const dvec3 moments = dvec3{1.0, 1.0 + spread, k % 2 == 0 ? 1.0 : 1.0 + 0.3 * spread} * (k % 7 == 0 ? 1e-20 : 1.0);
        MassProperties m{1.0, dvec3{0.0}, dmat3{0.0}};
        for (int i = 0; i < 3; ++i) m.inertia[i][i] = moments[i];
        const MassProperties turned = transform(m, random_pose(random, 0.0));
        const PrincipalAxes p = principal_axes(turned.inertia);
        const double size = trace(m.inertia);
        EXPECT_NEAR(glm::length(p.orientation), 1.0, 1e-15);  // a unit quaternion is a right-handed frame
        const dmat3 difference = recomposed(p) - turned.inertia;
        for (int i = 0; i < 3; ++i) EXPECT_LE(glm::length(difference[i]), 4e-14 * size);
        std::array<double, 3> ours{p.moments.x, p.moments.y, p.moments.z};
        std::array<double, 3> given{moments.x, moments.y, moments.z};
        std::sort(ours.begin(), ours.end());
        std::sort(given.begin(), given.end());
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(ours[i], given[i], 2e-14 * size);
        if (p.orientation != kIdentityRotation) {
            EXPECT_TRUE(p.moments.x <= p.moments.y && p.moments.y <= p.moments.z);
        }
    }
}

TEST(PrincipalAxes, DiagonalStaysInPlace) {
    for (const dvec3 moments : {dvec3{3, 1, 2}, dvec3{5, 5, 5}, dvec3{2, 4, 3}}) {
        dmat3 inertia{0.0};
        for (int i = 0; i < 3; ++i) inertia[i][i] = moments[i];
        inertia[0][1] = inertia[1][0] = 1e-15 * moments.x;
        const PrincipalAxes p = principal_axes(inertia);
        EXPECT_EQ(p.moments, moments);
        EXPECT_EQ(p.orientation, kIdentityRotation);
    }
    const PrincipalAxes box = principal_axes(properties(*ConvexHull::build(box_points({0.3, 0.7, 0.45})), 1.0).inertia);
    EXPECT_EQ(box.orientation, kIdentityRotation);
}

TEST(PrincipalAxes, NonFiniteInertiaIsMisuse) {
    dmat3 inertia{1.0};
    inertia[1][2] = std::nan("");
    EXPECT_THROW((void)principal_axes(inertia), MisuseError);
}

// ---- validate ----------------------------------------------------------------------------------------------------------

TEST(ValidateMass, RangesAreChecked) {
    const auto code = [](const MassProperties& m) {
        const Status status = validate(m);
        return status ? ErrorCode::Io : status.error().code;
    };
    const double inf = std::numeric_limits<double>::infinity();
    MassProperties good = transform(properties(Box{{0.5f, 1.0f, 2.0f}}, 1.0), {{1, 2, 3}, glm::normalize(dquat{1, 2, 3, 4})});
    EXPECT_TRUE(validate(good).ok());
    MassProperties m = good;
    for (const double bad : {0.0, -1.0}) {
        m.mass = bad;
        EXPECT_EQ(code(m), ErrorCode::InvalidArgument);
    }
    for (const double bad : {inf, std::nan("")}) {
        m.mass = bad;
        EXPECT_EQ(code(m), ErrorCode::NotFinite);
    }
    m = good, m.center.y = inf;
    EXPECT_EQ(code(m), ErrorCode::NotFinite);
    m = good, m.inertia[2][1] = inf;
    EXPECT_EQ(code(m), ErrorCode::NotFinite);
    m = good, m.inertia[2][1] += 1e-8 * trace(m.inertia);
    EXPECT_EQ(code(m), ErrorCode::InvalidArgument);
    m = good, m.inertia = -m.inertia;
    EXPECT_EQ(code(m), ErrorCode::InvalidArgument);
    m = good, m.inertia = dmat3{0.0};
    EXPECT_EQ(code(m), ErrorCode::InvalidArgument);
    m.inertia = dmat3{1, 0, 0, 0, 1, 0, 0, 0, 2};  // a disc: the limit
    EXPECT_TRUE(validate(m).ok());
    m.inertia[2][2] = 2.0 + 1e-5;
    EXPECT_EQ(code(m), ErrorCode::InvalidArgument);
    m.inertia = dmat3{1, 2, 0, 2, 1, 0, 0, 0, 1};  // indefinite
    EXPECT_EQ(code(m), ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace carom
