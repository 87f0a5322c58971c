// Overlap of all pairs against exact rationals: right outside the stated bound, and `false` always right.
#include <carom/collision/overlap_tests.hpp>

#include "exact_distance.hpp"
#include "primitive_cases.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>

namespace carom {
namespace {

using namespace geo;
using test::Cases;

// The largest coordinate difference, half extent or radius, as the bounds of the headers count it: from the corners, within a factor 2.
exact::Rational size_of(const exact::Solid& a, const exact::Solid& b) {
    exact::Rational size = std::max(a.radius, b.radius);
    for (const exact::Solid* s : {&a, &b}) {
        for (const exact::Vec& p : s->corners) size = std::max(size, exact::largest(p - a.corners[0]));
    }
    return size;
}

template <class A>
constexpr bool kTurned = std::is_same_v<A, Obb<float>> || std::is_same_v<A, Obb<double>>;

template <class A, class B>
exact::Rational bound(const A& a, const B& b) {
    using T = geo::detail::Scalar<A>;
    const double roundings =
        kTurned<A> || kTurned<B> ? 128.0 * static_cast<double>(std::numeric_limits<T>::epsilon()) : 32.0 * 0x1p-52;
    return exact::number(roundings) * size_of(exact::solid(a), exact::solid(b));
}

struct Tally {
    int apart = 0;
    int together = 0;
    int within = 0;
    double worst = 0.0;  // in parts of the bound
};

template <class A, class B>
void judge(const A& a, const B& b, Tally& tally) {
    const bool got = overlaps(a, b);
    const exact::Solid x = exact::solid(a), y = exact::solid(b);
    const exact::Rational reach = x.radius + y.radius, sq = exact::core_distance_sq(x, y);
    const bool truth = sq <= exact::square(reach);
    EXPECT_TRUE(got || !truth) << "apart is certain";
    EXPECT_TRUE(overlaps(b, a) || !truth) << "apart is certain";
    if (got && !truth) {
        const exact::Rational allowed = bound(a, b);
        EXPECT_TRUE(sq <= exact::square(reach + allowed));
        ++tally.within;
        const exact::Rational gap = exact::sqrt_up(sq) - reach;
        tally.worst = std::max(tally.worst, static_cast<double>(exact::Rational(gap / allowed)));
    }
    ++(truth ? tally.together : tally.apart);
}

template <class T>
struct Named {
    template <class A, class B>
    static void check(const char* what, std::uint64_t seed, int count) {
        SCOPED_TRACE(what);
        Cases<T> cases(seed);
        Tally tally;
        for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
            SCOPED_TRACE(i);
            const auto [a, b] = i % 2 == 0 ? cases.template near_pair<A, B>() : cases.template pair<A, B>();
            judge(a, b, tally);
        }
        if (testing::Test::HasFailure()) return;
        EXPECT_GT(tally.apart, count / 20);
        EXPECT_GT(tally.together, count / 20);
        testing::Test::RecordProperty(what, std::to_string(tally.worst));
        if (std::getenv("CAROM_SHOW") != nullptr) {
            std::printf("%-24s apart %d together %d within %d worst %.3f\n", what, tally.apart, tally.together, tally.within, tally.worst);
        }
    }
};

template <class T>
class Overlaps : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Overlaps, Scalars);

TYPED_TEST(Overlaps, OfRoundSolidsIsExactOutsideTheBound) {
    using T = TypeParam;
    using N = Named<T>;
    N::template check<Sphere<T>, Sphere<T>>("sphere sphere", 0x0501, 400);
    N::template check<Sphere<T>, Capsule<T>>("sphere capsule", 0x0502, 400);
    N::template check<Capsule<T>, Capsule<T>>("capsule capsule", 0x0503, 600);
    N::template check<Sphere<T>, Triangle<T>>("sphere triangle", 0x0504, 400);
    N::template check<Capsule<T>, Triangle<T>>("capsule triangle", 0x0505, 300);
    N::template check<Sphere<T>, Aabb<T>>("sphere aabb", 0x0506, 100);
    N::template check<Sphere<T>, Obb<T>>("sphere obb", 0x0507, 100);
    N::template check<Capsule<T>, Aabb<T>>("capsule aabb", 0x0508, 100);
    N::template check<Capsule<T>, Obb<T>>("capsule obb", 0x0509, 100);
}

TYPED_TEST(Overlaps, OfFlatSidedSolidsIsExactOutsideTheBound) {
    using T = TypeParam;
    using N = Named<T>;
    N::template check<Triangle<T>, Triangle<T>>("triangle triangle", 0x0511, 300);
    N::template check<Triangle<T>, Aabb<T>>("triangle aabb", 0x0512, 60);
    N::template check<Triangle<T>, Obb<T>>("triangle obb", 0x0513, 60);
    N::template check<Aabb<T>, Aabb<T>>("aabb aabb", 0x0514, 40);
    N::template check<Aabb<T>, Obb<T>>("aabb obb", 0x0515, 40);
    N::template check<Obb<T>, Obb<T>>("obb obb", 0x0516, 60);
}

}  // namespace
}  // namespace carom
