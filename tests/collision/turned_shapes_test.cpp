// Cylinder and cone: ranges, bounds, mass and rays, each against a definition of its own.
#include "support/random_pose.hpp"

#include <carom/collision/aabb.hpp>
#include <carom/collision/mass_properties.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace carom {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The radii of the two ends and half the height.
struct Profile {
    double lower = 0, upper = 0, h = 0;
    [[nodiscard]] double radius(double y) const { return lower + (upper - lower) * (y + h) / (2 * h); }
    // How far the point is outside, by the largest of the three conditions; exact to first order at the surface.
    [[nodiscard]] double outside(const dvec3& p) const {
        const double slant = std::hypot(2 * h, lower - upper);
        return std::max({std::abs(p.y) - h, (std::hypot(p.x, p.z) - radius(p.y)) * 2 * h / slant});
    }
};

struct Solid {
    Shape shape;
    Profile profile;
};

Solid solid(bool cone, float radius, float half_height) {
    const double r = static_cast<double>(radius), h = static_cast<double>(half_height);
    if (cone) return {Cone{radius, half_height}, {r, 0.0, h}};
    return {Cylinder{radius, half_height}, {r, r, h}};
}

Solid random_solid(Random& r, int i) {
    return solid(i % 2 == 1, static_cast<float>(r.range(0.1, 2.0)), static_cast<float>(r.range(0.1, 2.0)));
}

void expect_refused(const Shape& shape, ErrorCode code, const std::string& field) {
    const Status status = validate(shape);
    ASSERT_FALSE(status.ok()) << field;
    EXPECT_EQ(status.error().code, code) << field;
    EXPECT_NE(status.error().message.find(field), std::string::npos) << status.error().message;
}

TEST(TurnedShapes, SizesMustBePositiveFiniteAndNotTooFarApart) {
    EXPECT_TRUE(validate(Cylinder{}).ok());
    EXPECT_TRUE(validate(Cone{}).ok());
    for (const float bad : {0.0f, -1.0f, -0.0f}) {
        expect_refused(Cylinder{bad, 1}, ErrorCode::InvalidArgument, "Cylinder::radius");
        expect_refused(Cylinder{1, bad}, ErrorCode::InvalidArgument, "Cylinder::half_height");
        expect_refused(Cone{bad, 1}, ErrorCode::InvalidArgument, "Cone::radius");
        expect_refused(Cone{1, bad}, ErrorCode::InvalidArgument, "Cone::half_height");
    }
    for (const float bad : {kInf, -kInf, kNan}) {
        expect_refused(Cylinder{bad, 1}, ErrorCode::NotFinite, "Cylinder::radius");
        expect_refused(Cylinder{1, bad}, ErrorCode::NotFinite, "Cylinder::half_height");
        expect_refused(Cone{bad, 1}, ErrorCode::NotFinite, "Cone::radius");
        expect_refused(Cone{1, bad}, ErrorCode::NotFinite, "Cone::half_height");
    }
    EXPECT_TRUE(validate(Cylinder{1, 1.001e-4f}).ok());
    EXPECT_TRUE(validate(Cone{1.001e-4f, 1}).ok());
    expect_refused(Cylinder{1, 0.9e-4f}, ErrorCode::InvalidArgument, "Cylinder");
    expect_refused(Cylinder{0.9e-4f, 1}, ErrorCode::InvalidArgument, "Cylinder");
    expect_refused(Cone{1e30f, 1e-30f}, ErrorCode::InvalidArgument, "Cone");
    expect_refused(Cone{1e-30f, 1e30f}, ErrorCode::InvalidArgument, "Cone");
    EXPECT_STREQ(to_string(ShapeType::Cylinder), "cylinder");
    EXPECT_STREQ(to_string(ShapeType::Cone), "cone");
    EXPECT_TRUE(is_bounded(Cylinder{}));
}

// The box holds every point that transform_point() gives, to the last bit, and is no larger than the farthest of them.
TEST(TurnedShapes, BoundsHoldTheShapeAndAreTight) {
    Random r(411);
    for (int i = 0; i < 300; ++i) {
        const Solid s = random_solid(r, i);
        const Pose pose{test::random_direction(r) * r.range(0, 100), i % 7 == 0 ? kIdentityRotation : test::random_rotation(r)};
        const Aabb box = bounds(s.shape, pose);
        Aabb points;
        const auto add = [&](const dvec3& local) {
            const dvec3 p = transform_point(pose, local);
            ASSERT_TRUE(glm::all(glm::lessThanEqual(box.lower, p)) && glm::all(glm::lessThanEqual(p, box.upper)));
            points = merge(points, {p, p});
        };
        constexpr int kSteps = 4000;
        for (int k = 0; k < kSteps; ++k) {
            const SinCos a = sin_cos(2 * kPi * k / kSteps);
            add({s.profile.lower * a.cos, -s.profile.h, s.profile.lower * a.sin});
            add({s.profile.upper * a.cos, s.profile.h, s.profile.upper * a.sin});
        }
        // A step of the circle is 1.6e-3 wide: its arc rises 3e-7 of the radius over the chord's ends.
        for (int k = 0; k < 3; ++k) {
            ASSERT_NEAR(box.lower[k], points.lower[k], 2e-6);
            ASSERT_NEAR(box.upper[k], points.upper[k], 2e-6);
        }
        const double reach = bounding_radius(s.shape);
        EXPECT_NEAR(reach, std::hypot(s.profile.lower, s.profile.h), 1e-12);
        EXPECT_GE(reach, std::hypot(s.profile.lower, s.profile.h));
    }
}

// The least width over many directions.
TEST(TurnedShapes, SmallestExtentIsTheLeastWidth) {
    Random r(412);
    for (int i = 0; i < 60; ++i) {
        const Solid s = random_solid(r, i);
        const Profile& p = s.profile;
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k <= 20000; ++k) {
            const SinCos a = sin_cos(0.5 * kPi * k / 20000);
            const double up = std::max(p.upper * a.sin + p.h * a.cos, p.lower * a.sin - p.h * a.cos);
            const double down = std::max(p.upper * a.sin - p.h * a.cos, p.lower * a.sin + p.h * a.cos);
            least = std::min(least, up + down);
        }
        EXPECT_NEAR(smallest_extent(s.shape), least, 1e-3 * least) << i;
        EXPECT_LE(smallest_extent(s.shape), least * (1 + 1e-12)) << i;
    }
}

// Against the sum over thin discs (Simpson's rule; its error falls with the fourth power of their number).
TEST(TurnedShapes, MassIsThatOfTheirDiscs) {
    Random r(413);
    for (int i = 0; i < 40; ++i) {
        const Solid s = random_solid(r, i);
        const double density = r.range(1, 5000);
        double mass = 0, moment = 0, along = 0, across = 0;
        constexpr int kDiscs = 2000;
        for (int k = 0; k <= kDiscs; ++k) {
            const double y = s.profile.h * (2.0 * k / kDiscs - 1.0), radius = s.profile.radius(y);
            const double weight = (k == 0 || k == kDiscs ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * (2.0 * s.profile.h / kDiscs) / 3.0;
            const double disc = weight * density * kPi * radius * radius;
            mass += disc;
            moment += disc * y;
            along += disc * 0.5 * radius * radius;
            across += disc * (0.25 * radius * radius + y * y);
        }
        const double centre = moment / mass;
        across -= mass * centre * centre;
        const Result<MassProperties> m = mass_properties(s.shape, density);
        ASSERT_TRUE(m.has_value());
        EXPECT_NEAR(m->mass, mass, 1e-10 * mass);
        EXPECT_NEAR(m->center.y, centre, 1e-10);
        EXPECT_EQ(m->center.x, 0.0);
        EXPECT_EQ(m->center.z, 0.0);
        EXPECT_NEAR(m->inertia[1][1], along, 1e-10 * along);
        EXPECT_NEAR(m->inertia[0][0], across, 1e-10 * across);
        EXPECT_EQ(m->inertia[0][0], m->inertia[2][2]);
        EXPECT_TRUE(validate(*m).ok());
    }
    EXPECT_EQ(mass_properties(Cylinder{0, 1}, 1.0).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(mass_properties(Cone{1, 1}, -1.0).error().code, ErrorCode::InvalidArgument);
}

// A hit is on the surface with nothing of the solid before it; a miss has no point of the ray inside.
TEST(TurnedShapes, RaysHitTheFirstPoint) {
    Random r(414);
    int hits = 0, misses = 0, ends = 0;
    for (int i = 0; i < 4000; ++i) {
        const Solid s = random_solid(r, i);
        const double size = s.profile.lower + s.profile.h;
        Ray ray{test::random_direction(r) * size * r.range(0.0, 3.0), {}};
        const dvec3 aim = test::random_direction(r) * size * r.range(0.0, 0.8);
        ray.direction = i % 5 == 0 ? dvec3{0, ray.origin.y > 0 ? -1.0 : 1.0, 0} : aim - ray.origin;
        if (!(glm::length(ray.direction) > 1e-3)) continue;
        const dvec3 unit = ray.direction / glm::length(ray.direction);
        const std::optional<RayHit> hit = cast_ray(s.shape, ray);
        if (s.profile.outside(ray.origin) <= 0.0) {
            ASSERT_TRUE(hit.has_value());
            EXPECT_EQ(hit->distance, 0.0);
            EXPECT_EQ(hit->point, ray.origin);
            continue;
        }
        const double until = hit ? hit->distance : 8.0 * size;
        (hit ? hits : misses)++;
        for (int k = 1; k < 400; ++k) {
            const double t = until * k / 400;
            ASSERT_GT(s.profile.outside(ray.origin + t * unit), -1e-9 * size) << i << " at " << t << " of " << until;
        }
        if (!hit) continue;
        ASSERT_NEAR(s.profile.outside(hit->point), 0.0, 1e-12 * size) << i;
        ASSERT_LT(glm::length(ray.origin + hit->distance * unit - hit->point), 1e-11 * size) << i;
        ASSERT_NEAR(glm::length(hit->normal), 1.0, 1e-12);
        ASSERT_LT(glm::dot(hit->normal, unit), 1e-9);
        // A step against the normal is inside, a step along it outside.
        ASSERT_GT(s.profile.outside(hit->point + 1e-7 * size * hit->normal), 0.0) << i;
        ends += std::abs(hit->normal.y) == 1.0;
        EXPECT_FALSE(cast_ray(s.shape, {ray.origin, ray.direction, hit->distance * (1 - 1e-9)}).has_value());
    }
    EXPECT_GT(hits, 1000);
    EXPECT_GT(misses, 300);
    EXPECT_GT(ends, 300);
}

TEST(TurnedShapes, RaysFromAfarAndOddRaysAreAnswered) {
    for (const bool cone : {false, true}) {
        const Solid s = solid(cone, 1.0f, 1.0f);
        // From 1e8 m the hit is where it is from near.
        const std::optional<RayHit> far = cast_ray(s.shape, {{-1e8, 0.25, 0.0}, {1, 0, 0}});
        ASSERT_TRUE(far.has_value());
        EXPECT_NEAR(far->point.x, -s.profile.radius(0.25), 1e-7);
        EXPECT_NEAR(far->distance, 1e8 - s.profile.radius(0.25), 1e-7);
        // Along the axis, on to the tip or the end; along the rim of the base.
        EXPECT_NEAR(cast_ray(s.shape, {{0, 5, 0}, {0, -1, 0}})->distance, 4.0, 1e-12);
        EXPECT_NEAR(cast_ray(s.shape, {{0, -5, 0}, {0, 1, 0}})->distance, 4.0, 1e-12);
        EXPECT_FALSE(cast_ray(s.shape, {{1.0001, -5, 0}, {0, 1, 0}}).has_value());
        EXPECT_FALSE(cast_ray(s.shape, {{0, 5, 0}, {0, 1, 0}}).has_value());
        EXPECT_FALSE(cast_ray(s.shape, {{kNan, 5, 0}, {0, 1, 0}}).has_value());
        EXPECT_FALSE(cast_ray(s.shape, {{0, 5, 0}, {0, 0, 0}}).has_value());
        EXPECT_FALSE(cast_ray(s.shape, {{1e200, 0, 0}, {0, 1, 0}}).has_value());
        const std::optional<RayHit> placed = cast_ray(s.shape, {{10, 0, 0}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}, {{5, 0, 0}, {1, 0, 0}});
        ASSERT_TRUE(placed.has_value());  // the axis along -x: the tip or end looks at the ray
        EXPECT_NEAR(placed->distance, 4.0, 1e-12);
    }
}

}  // namespace
}  // namespace carom
