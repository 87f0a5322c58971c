// Frusta: never outside what overlaps, never inside what is not, and the planes of cameras and matrices.
#include <carom/collision/frustum.hpp>
#include <carom/collision/plane_tests.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <support/exact.hpp>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <limits>

namespace carom {
namespace {

using exact::Rational;
using geo::Containment;

template <class T>
class Frusta : public testing::Test {
protected:
    Random random{4501};

    T number(double half) { return static_cast<T>(random.range(-half, half)); }
    geo::Vec3<T> point(double half) {
        const T x = number(half);
        const T y = number(half);
        return {x, y, number(half)};
    }
    geo::Camera<T> camera() {
        geo::Camera<T> c;
        c.position = point(20.0);
        c.forward = point(1.0);
        c.up = point(1.0);
        c.fovy = static_cast<T>(random.range(0.1, 3.0));
        c.aspect = static_cast<T>(random.range(0.2, 5.0));
        c.near_distance = static_cast<T>(random.range(0.0, 1.0));
        c.far_distance =
            random.unit() < 0.2 ? std::numeric_limits<T>::infinity() : static_cast<T>(random.range(2.0, 60.0));
        return c;
    }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Frusta, Precisions);

/// All of a shape, as a center height and what it reaches to both sides: exact for boxes; for spheres the square of the
/// reach.
struct Reach {
    Rational height, reach, reach_sq;

    [[nodiscard]] bool beyond() const {
        return height.sign() < 0 && -height > reach && exact::square(height) > reach_sq;
    }
    [[nodiscard]] bool within() const {
        return height.sign() >= 0 && height >= reach && exact::square(height) >= reach_sq;
    }
};

template <class T>
Reach reach_of(const geo::Plane<T>& p, const geo::Sphere<T>& s) {
    const exact::Vec n = exact::vec(p.normal);
    return {exact::dot(n, exact::vec(s.center)) - exact::number(p.offset), 0,
            exact::square(exact::number(s.radius)) * exact::length_sq(n)};
}
template <class T>
Reach reach_of(const geo::Plane<T>& p, const geo::Obb<T>& b) {
    const exact::Vec n = exact::vec(p.normal);
    Rational reach = 0;
    for (int k = 0; k < 3; ++k) {
        reach += exact::magnitude(exact::dot(n, exact::vec(b.axes[k]))) * exact::number(b.half_extents[k]);
    }
    return {exact::dot(n, exact::vec(b.center)) - exact::number(p.offset), reach, 0};
}
template <class T>
Reach reach_of(const geo::Plane<T>& p, const geo::Aabb<T>& b) {
    const exact::Vec n = exact::vec(p.normal);
    const exact::Vec sum = exact::vec(b.lower) + exact::vec(b.upper);
    const exact::Vec size = exact::vec(b.upper) - exact::vec(b.lower);
    Rational reach = 0;
    for (int k = 0; k < 3; ++k) reach += exact::magnitude(n[k]) * size[k] / 2;
    return {exact::dot(n, sum) / 2 - exact::number(p.offset), reach, 0};
}

struct Counts {
    int outside = 0;
    int across = 0;
    int inside = 0;
};

/// Outside and Inside are what they say, exactly; and they are said of all that would stay so if it were a little
/// larger.
template <class T, class Shape>
void expect_conservative(const geo::Frustum<T>& view, const Shape& shape, const Shape& larger, Counts& counts) {
    const auto beyond = [&](const Shape& s) {
        return std::ranges::any_of(view.planes, [&](const geo::Plane<T>& p) { return reach_of(p, s).beyond(); });
    };
    const auto within = [&](const Shape& s) {
        return std::ranges::all_of(view.planes, [&](const geo::Plane<T>& p) { return reach_of(p, s).within(); });
    };
    switch (geo::classify(view, shape)) {
        case Containment::Outside:
            EXPECT_TRUE(beyond(shape));
            ++counts.outside;
            break;
        case Containment::Inside:
            EXPECT_TRUE(within(shape));
            ++counts.inside;
            break;
        case Containment::Across:
            EXPECT_FALSE(beyond(larger));
            EXPECT_FALSE(within(larger));
            ++counts.across;
            break;
    }
}

TYPED_TEST(Frusta, NothingThatOverlapsIsOutsideAndNothingElseIsInside) {
    using T = TypeParam;
    Counts counts;
    for (int i = 0; i < 400; ++i) {
        const geo::Camera<T> camera = this->camera();
        const geo::Frustum<T> view = geo::frustum_of(camera).value();
        const geo::Vec3<T> at = camera.position +
                                geo::Vec3<T>(glm::normalize(dvec3(camera.forward)) * this->random.range(-5.0, 30.0)) +
                                this->point(6.0);
        const T size = std::abs(this->number(2.0));
        geo::Sphere<T> sphere{at, size};
        if (i % 2 == 0) {  // touching a plane, to an ulp
            sphere.radius = std::abs(geo::signed_distance(view.planes[static_cast<std::size_t>(i) % 6], at));
        }
        expect_conservative(view, sphere, {at, sphere.radius * T(1.00001)}, counts);
        const geo::Vec3<T> half{size, std::abs(this->number(2.0)), std::abs(this->number(2.0))};
        const auto box = [&](T scale) { return geo::Aabb<T>{at - half * scale, at + half * scale}; };
        expect_conservative(view, box(T(1)), box(T(1.00001)), counts);
        const dquat turn =
            glm::normalize(dquat(1.0, this->random.range(-1.0, 1.0), this->random.range(-1.0, 1.0), 0.3));
        const auto turned = [&](T scale) {
            return geo::Obb<T>{at, half * scale, glm::mat<3, 3, T>(glm::mat3_cast(turn))};
        };
        expect_conservative(view, turned(T(1)), turned(T(1.00001)), counts);
    }
    EXPECT_GT(counts.outside, 200);
    EXPECT_GT(counts.across, 200);
    EXPECT_GT(counts.inside, 100);
}

TYPED_TEST(Frusta, ACameraSeesWhatItsFieldsSay) {
    using T = TypeParam;
    for (int i = 0; i < 2000; ++i) {
        const geo::Camera<T> c = this->camera();
        const geo::Frustum<T> view = geo::frustum_of(c).value();
        const dvec3 forward = glm::normalize(dvec3(c.forward));
        const dvec3 right = glm::normalize(glm::cross(forward, dvec3(c.up)));
        const dvec3 up = glm::cross(right, forward);
        const SinCos half = sin_cos(0.5 * static_cast<double>(c.fovy));
        const double tangent = half.sin / half.cos;
        const double far = std::min(static_cast<double>(c.far_distance), 1e4);
        const double x = this->random.range(-1.3, 1.3), y = this->random.range(-1.3, 1.3);
        const double z = this->random.range(0.0, 1.2 * far);
        const double clearance = std::min({std::abs(1.0 - std::abs(x)) * z, std::abs(1.0 - std::abs(y)) * z,
                                           std::abs(z - static_cast<double>(c.near_distance)), std::abs(z - far)});
        if (clearance < 0.05) continue;  // beyond what rounding the planes to float may move
        const dvec3 p =
            dvec3(c.position) + z * (forward + tangent * (x * static_cast<double>(c.aspect) * right + y * up));
        const bool seen = std::abs(x) < 1.0 && std::abs(y) < 1.0 && z > static_cast<double>(c.near_distance) &&
                          (z < far || std::isinf(c.far_distance));
        const auto verdict = geo::classify(view, geo::Sphere<T>{geo::Vec3<T>(p), T(0)});
        EXPECT_EQ(verdict, seen ? Containment::Inside : Containment::Outside) << x << ' ' << y << ' ' << z;
    }
}

TYPED_TEST(Frusta, MatricesAndCamerasAgree) {
    using T = TypeParam;
    for (int i = 0; i < 200; ++i) {
        geo::Camera<T> c = this->camera();
        c.near_distance += T(0.5);
        if (std::isinf(c.far_distance)) c.far_distance = T(40);
        const glm::dmat4 look = glm::lookAt(dvec3(c.position), dvec3(c.position) + dvec3(c.forward), dvec3(c.up));
        const auto project = [&](auto perspective) {
            return glm::mat<4, 4, T>(perspective(static_cast<double>(c.fovy), static_cast<double>(c.aspect),
                                                 static_cast<double>(c.near_distance),
                                                 static_cast<double>(c.far_distance)) *
                                     look);
        };
        const geo::Frustum<T> view = geo::frustum_of(c).value();
        const geo::Frustum<T> gl = geo::frustum_of(project(glm::perspectiveRH_NO<double>)).value();
        const geo::Frustum<T> zo =
            geo::frustum_of(project(glm::perspectiveRH_ZO<double>), geo::ClipDepth::ZeroToOne).value();
        for (std::size_t k = 0; k < 6; ++k) {
            // The far plane is the difference of nearly equal rows.
            const double tolerance =
                static_cast<double>(std::numeric_limits<T>::epsilon()) * (k == 5 ? 40000.0 : 400.0);
            for (const geo::Frustum<T>* other : {&gl, &zo}) {
                EXPECT_LE(glm::length(dvec3(view.planes[k].normal) - dvec3(other->planes[k].normal)), tolerance) << k;
                EXPECT_NEAR(view.planes[k].offset, other->planes[k].offset, 60.0 * tolerance) << k;
            }
        }
    }
}

TYPED_TEST(Frusta, InfiniteProjectionsHaveNoFarPlane) {
    using T = TypeParam;
    // Reversed and infinite: z' = near, w = -z.
    glm::mat<4, 4, T> m(T(0));
    m[0][0] = m[1][1] = T(1);
    m[2][3] = T(-1);
    m[3][2] = T(0.5);
    const geo::Frustum<T> view = geo::frustum_of(m, geo::ClipDepth::ZeroToOne).value();
    EXPECT_EQ(geo::classify(view, geo::Sphere<T>{{T(0), T(0), T(-1e15)}, T(1)}), Containment::Inside);
    EXPECT_EQ(geo::classify(view, geo::Sphere<T>{{T(0), T(0), T(-0.25)}, T(0.125)}), Containment::Outside);
    EXPECT_EQ(geo::classify(view, geo::Sphere<T>{{T(0), T(0), T(-0.25)}, T(0.375)}), Containment::Across);
}

TYPED_TEST(Frusta, BadInputIsNamed) {
    using T = TypeParam;
    constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
    const auto expect_error = [](const Result<geo::Frustum<T>>& result, ErrorCode code) {
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, code);
    };
    using Camera = geo::Camera<T>;
    ASSERT_TRUE(geo::frustum_of(Camera{}));
    expect_error(geo::frustum_of(Camera{.position = {kNan, 0, 0}}), ErrorCode::NotFinite);
    expect_error(geo::frustum_of(Camera{.forward = {0, kNan, 0}}), ErrorCode::NotFinite);
    expect_error(geo::frustum_of(Camera{.fovy = kNan}), ErrorCode::NotFinite);
    expect_error(geo::frustum_of(Camera{.far_distance = kNan}), ErrorCode::NotFinite);
    expect_error(geo::frustum_of(Camera{.forward = {0, 0, 0}}), ErrorCode::Degenerate);
    expect_error(geo::frustum_of(Camera{.forward = {0, 2, 0}}), ErrorCode::Degenerate);
    expect_error(geo::frustum_of(Camera{.forward = {T(0.1), T(0.2), T(0.3)}, .up = {T(0.3), T(0.6), T(0.9)}}), ErrorCode::Degenerate);
    EXPECT_TRUE(geo::frustum_of(Camera{.forward = {T(0.1), T(0.2), T(0.3)}, .up = {T(0.3), T(0.6), T(0.9001)}}));
    expect_error(geo::frustum_of(Camera{.fovy = T(0)}), ErrorCode::InvalidArgument);
    expect_error(geo::frustum_of(Camera{.fovy = T(3.2)}), ErrorCode::InvalidArgument);
    expect_error(geo::frustum_of(Camera{.aspect = T(0)}), ErrorCode::InvalidArgument);
    expect_error(geo::frustum_of(Camera{.near_distance = T(-1)}), ErrorCode::InvalidArgument);
    expect_error(geo::frustum_of(Camera{.near_distance = T(1), .far_distance = T(1)}), ErrorCode::InvalidArgument);
    expect_error(geo::frustum_of(glm::mat<4, 4, T>(kNan)), ErrorCode::NotFinite);
    glm::mat<4, 4, T> nothing(T(0));
    nothing[3][3] = T(-1);
    expect_error(geo::frustum_of(nothing), ErrorCode::Degenerate);
    expect_error(geo::frustum_of(glm::mat<4, 4, T>(T(0))), ErrorCode::Degenerate);
    nothing[3][3] = T(1);
    expect_error(geo::frustum_of(nothing), ErrorCode::Degenerate);

    const geo::Frustum<T> view = geo::frustum_of(Camera{}).value();
    const geo::Vec3<T> seen{T(0), T(0), T(-5)};
    ASSERT_EQ(geo::classify(view, geo::Sphere<T>{seen, T(0.5)}), Containment::Inside);
    EXPECT_EQ(geo::classify(view, geo::Sphere<T>{seen, T(-1)}), Containment::Across);
    EXPECT_EQ(geo::classify(view, geo::Sphere<T>{{kNan, T(0), T(-5)}, T(1)}), Containment::Across);
    EXPECT_EQ(geo::classify(view, geo::Obb<T>{.center = seen, .half_extents = {T(1), T(1), kNan}}),
              Containment::Across);
    EXPECT_EQ(geo::classify(view, geo::Aabb<T>{seen + T(1), seen - T(1)}), Containment::Across);
}

}  // namespace
}  // namespace carom
