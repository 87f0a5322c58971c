// Batches of moving spheres and capsules, taken several at once, against the single calls, which sweep_test.cpp holds to exact distances: the same bits at
// every width.
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();

template <class T>
using V = glm::vec<3, T>;

template <class T>
V<T> any_vector(Random& r, double size) {
    return V<T>(size * dvec3{r.range(-1, 1), r.range(-1, 1), r.range(-1, 1)});
}
/// Often along an axis, or on a grid of halves.
template <class T>
V<T> some_vector(Random& r, double size) {
    V<T> v = any_vector<T>(r, size);
    const double chance = r.unit();
    for (int k = 0; k < 3; ++k) {
        if (chance < 0.25 && r.unit() < 0.5) v[k] = r.unit() < 0.5 ? T(0) : -T(0);
        if (chance > 0.8) v[k] = T(0.5 * std::round(2.0 * double(v[k])));
    }
    return v;
}
template <class T>
T some_size(Random& r, double most) {
    return r.unit() < 0.1 ? T(0) : T(r.range(0.0, most));
}

template <class T>
void fill(Random& r, geo::Plane<T>& p) {
    p = {some_vector<T>(r, 2.0), T(r.range(-2.0, 1.0))};
}
template <class T>
void fill(Random& r, geo::Sphere<T>& s) {
    s = {some_vector<T>(r, 1.0), some_size<T>(r, 0.5)};
}
template <class T>
void fill(Random& r, geo::Capsule<T>& c) {
    c = {{some_vector<T>(r, 1.0), some_vector<T>(r, 1.0)}, some_size<T>(r, 0.4)};
    if (r.unit() < 0.1) c.axis.b = c.axis.a;
    if (r.unit() < 0.05) c.axis.b = c.axis.a + V<T>(T(1e-30), T(0), T(1e-30));
}
template <class T>
void fill(Random& r, geo::Cylinder<T>& c) {
    c = {{some_vector<T>(r, 1.0), some_vector<T>(r, 1.0)}, some_size<T>(r, 0.4)};
    if (r.unit() < 0.1) c.axis.b = c.axis.a;
    if (r.unit() < 0.15) c.axis.b = c.axis.a + T(std::pow(10.0, r.range(-30.0, -1.0))) * any_vector<T>(r, 1.0);
}
template <class T>
void fill(Random& r, geo::Aabb<T>& b) {
    const V<T> p = some_vector<T>(r, 1.0), q = some_vector<T>(r, 1.0);
    b = {glm::min(p, q), glm::max(p, q)};
}
template <class T>
void fill(Random& r, geo::Obb<T>& b) {
    b = {.center = some_vector<T>(r, 1.0), .half_extents = glm::abs(some_vector<T>(r, 0.7))};
    if (r.unit() < 0.7) b.axes = glm::mat<3, 3, T>(glm::mat3_cast(test::random_rotation(r)));
}
template <class T>
void fill(Random& r, geo::Triangle<T>& t) {
    t = {some_vector<T>(r, 1.0), some_vector<T>(r, 1.0), some_vector<T>(r, 1.0)};
    const double chance = r.unit();
    if (chance < 0.06) t.c = t.a;
    if (chance < 0.02) t.b = t.a;
    if (chance > 0.85) t.c = t.a + T(r.range(-0.5, 1.5)) * (t.b - t.a) + T(std::pow(10.0, r.range(-20.0, -2.0))) * any_vector<T>(r, 1.0);
}

/// What moves, with its reference point at `at`.
template <class T>
geo::Sphere<T> placed(Random&, const geo::Sphere<T>&, const V<T>& at, T radius) {
    return {at, radius};
}
template <class T>
geo::Capsule<T> placed(Random& r, const geo::Capsule<T>&, const V<T>& at, T radius) {
    geo::Capsule<T> c;
    fill(r, c);
    return {{at, at + (c.axis.b - c.axis.a)}, radius};
}

template <class T, class A, class B>
struct Batch {
    std::vector<A> a;
    std::vector<V<T>> motions;
    std::vector<B> b;
    std::vector<BasicImpact<T>> singly;

    void add(const A& moving, const V<T>& motion, const B& other) {
        a.push_back(moving), motions.push_back(motion), b.push_back(other);
        singly.push_back(geo::sweep(moving, motion, other));
    }
    [[nodiscard]] std::vector<BasicImpact<T>> swept(std::size_t from, std::size_t count) const {
        std::vector<BasicImpact<T>> out(count);
        const std::span<const A> movers(a);
        const std::span<const V<T>> ways(motions);
        const std::span<const B> others(b);
        geo::sweep<A, B, T>(movers.subspan(from, count), ways.subspan(from, count), others.subspan(from, count), out);
        return out;
    }
};

template <class T>
auto bits_of(T x) {
    using Word = std::conditional_t<std::is_same_v<T, float>, std::uint32_t, std::uint64_t>;
    return std::bit_cast<Word>(x);
}
template <class T>
bool same_bits(const BasicImpact<T>& p, const BasicImpact<T>& q) {
    bool same = p.status == q.status && bits_of(p.t) == bits_of(q.t) && p.checks == q.checks;
    for (int k = 0; k < 3; ++k) same = same && bits_of(p.point[k]) == bits_of(q.point[k]) && bits_of(p.normal[k]) == bits_of(q.normal[k]);
    return same;
}

template <class T, class A, class B>
void expect_the_single_calls(const Batch<T, A, B>& batch) {
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        const std::vector<BasicImpact<T>> out = batch.swept(0, batch.a.size());
        for (std::size_t i = 0; i < out.size(); ++i) {
            const BasicImpact<T>&p = out[i], &q = batch.singly[i];
            ASSERT_TRUE(same_bits(p, q)) << "width " << width << " pair " << i << ": " << to_string(p.status) << " " << p.t << " "
                                         << p.normal.x << " " << p.normal.y << " " << p.normal.z << ", singly " << to_string(q.status)
                                         << " " << q.t << " " << q.normal.x << " " << q.normal.y << " " << q.normal.z;
        }
    }
    set_simd_width(0);
}

template <class T, class A, class B>
int count(const Batch<T, A, B>& batch, ImpactStatus status) {
    int n = 0;
    for (const BasicImpact<T>& impact : batch.singly) n += impact.status == status ? 1 : 0;
    return n;
}

/// From outside, mostly towards B; some start in it, some do not move, some far from the origin or of other sizes.
template <class T, class A, class B>
Batch<T, A, B> random_batch(std::uint64_t seed, int pairs) {
    Random r(seed);
    Batch<T, A, B> batch;
    for (int i = 0; i < pairs; ++i) {
        V<T> at = some_vector<T>(r, 1.0);
        const T radius = some_size<T>(r, 0.4);
        B other;
        fill(r, other);
        const double chance = r.unit();
        V<T> motion = some_vector<T>(r, chance < 0.3 ? 1.0 : 6.0);
        if (chance < 0.9) at -= motion * T(0.5);
        if (chance > 0.97) motion = V<T>(T(0));
        if (chance > 0.94 && chance < 0.95) motion *= T(std::is_same_v<T, float> ? 1e-38 : 1e-90);
        batch.add(placed(r, A{}, at, radius), motion, other);
    }
    return batch;
}

template <class T>
class SweepBatchOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SweepBatchOf, Scalars);

template <class T, class A, class B>
void judge_random(std::uint64_t seed) {
    const Batch<T, A, B> batch = random_batch<T, A, B>(seed, 20'000);
    expect_the_single_calls(batch);
    EXPECT_GT(count(batch, ImpactStatus::Touching), 1'500);
    EXPECT_GT(count(batch, ImpactStatus::Overlapping), 200);
    EXPECT_GT(count(batch, ImpactStatus::Separated), 2'000);
}
TYPED_TEST(SweepBatchOf, RandomPairsAreTheSingleCalls) {
    using T = TypeParam;
    judge_random<T, geo::Sphere<T>, geo::Plane<T>>(0x91);
    judge_random<T, geo::Sphere<T>, geo::Sphere<T>>(0x5f);
    judge_random<T, geo::Sphere<T>, geo::Capsule<T>>(0xca);
    judge_random<T, geo::Sphere<T>, geo::Aabb<T>>(0xab);
    judge_random<T, geo::Sphere<T>, geo::Obb<T>>(0x0b);
    judge_random<T, geo::Sphere<T>, geo::Triangle<T>>(0x74);
    judge_random<T, geo::Sphere<T>, geo::Cylinder<T>>(0xc1);
    judge_random<T, geo::Capsule<T>, geo::Plane<T>>(0xc9);
    judge_random<T, geo::Capsule<T>, geo::Sphere<T>>(0xc5);
    judge_random<T, geo::Capsule<T>, geo::Capsule<T>>(0xcc);
    judge_random<T, geo::Capsule<T>, geo::Aabb<T>>(0xcab);
    judge_random<T, geo::Capsule<T>, geo::Obb<T>>(0xc0b);
    judge_random<T, geo::Capsule<T>, geo::Triangle<T>>(0xc74);
}

/// The radius with which a sphere just touches, found by halving, and those next to it.
template <class T, class A, class B>
void judge_grazing(std::uint64_t seed) {
    Random r(seed);
    Batch<T, A, B> batch;
    while (batch.a.size() < 6'000) {
        B other;
        fill(r, other);
        const V<T> motion = some_vector<T>(r, 6.0);
        const V<T> start = some_vector<T>(r, 1.0) - motion * T(0.5);
        T apart = 0, met = 4;
        A moving = placed(r, A{}, start, apart);
        const auto of = [&](T radius) { return moving.radius = radius, moving; };
        const auto touches = [&](T radius) { return may_touch(geo::sweep(of(radius), motion, other).status); };
        if (touches(apart) || !touches(met)) continue;
        for (int k = 0; k < 64; ++k) {
            const T middle = apart + T(0.5) * (met - apart);
            (touches(middle) ? met : apart) = middle;
        }
        for (const T radius : {met, apart, std::nextafter(met, T(9)), std::nextafter(apart, T(0))}) batch.add(of(radius), motion, other);
        for (const double gap : {1e-15, 1e-13, 1e-11, 1e-9, 1e-7}) {
            for (const double sign : {-1.0, 1.0}) batch.add(of(T(double(met) * (1.0 + sign * gap))), motion, other);
        }
    }
    expect_the_single_calls(batch);
    EXPECT_GT(count(batch, ImpactStatus::Touching) + count(batch, ImpactStatus::Overlapping), 2'000);
    EXPECT_GT(count(batch, ImpactStatus::Separated), 1'000);  // next to floats of this size many gaps are none
}
TYPED_TEST(SweepBatchOf, GrazingPairsAreTheSingleCalls) {
    using T = TypeParam;
    judge_grazing<T, geo::Sphere<T>, geo::Plane<T>>(0x191);
    judge_grazing<T, geo::Sphere<T>, geo::Sphere<T>>(0x15f);
    judge_grazing<T, geo::Sphere<T>, geo::Capsule<T>>(0x1ca);
    judge_grazing<T, geo::Sphere<T>, geo::Aabb<T>>(0x1ab);
    judge_grazing<T, geo::Sphere<T>, geo::Obb<T>>(0x10b);
    judge_grazing<T, geo::Sphere<T>, geo::Triangle<T>>(0x174);
    judge_grazing<T, geo::Sphere<T>, geo::Cylinder<T>>(0x1c1);
    judge_grazing<T, geo::Capsule<T>, geo::Plane<T>>(0x1c9);
    judge_grazing<T, geo::Capsule<T>, geo::Sphere<T>>(0x1c5);
    judge_grazing<T, geo::Capsule<T>, geo::Capsule<T>>(0x1cc);
    judge_grazing<T, geo::Capsule<T>, geo::Aabb<T>>(0x1cab);
    judge_grazing<T, geo::Capsule<T>, geo::Obb<T>>(0x1c0b);
    judge_grazing<T, geo::Capsule<T>, geo::Triangle<T>>(0x1c74);
}

/// Calls f with every number that a shape consists of.
template <class T, class F>
void each_number(V<T>& v, const F& f) {
    f(v.x), f(v.y), f(v.z);
}
template <class T, class F>
void each_number(geo::Plane<T>& p, const F& f) {
    each_number(p.normal, f), f(p.offset);
}
template <class T, class F>
void each_number(geo::Sphere<T>& s, const F& f) {
    each_number(s.center, f), f(s.radius);
}
template <class T, class F>
void each_number(geo::Capsule<T>& c, const F& f) {
    each_number(c.axis.a, f), each_number(c.axis.b, f), f(c.radius);
}
template <class T, class F>
void each_number(geo::Cylinder<T>& c, const F& f) {
    each_number(c.axis.a, f), each_number(c.axis.b, f), f(c.radius);
}
template <class T, class F>
void each_number(geo::Aabb<T>& b, const F& f) {
    each_number(b.lower, f), each_number(b.upper, f);
}
template <class T, class F>
void each_number(geo::Obb<T>& b, const F& f) {
    each_number(b.center, f), each_number(b.half_extents, f);
    for (int k = 0; k < 3; ++k) each_number(b.axes[k], f);
}
template <class T, class F>
void each_number(geo::Triangle<T>& t, const F& f) {
    each_number(t.a, f), each_number(t.b, f), each_number(t.c, f);
}

/// Each number of each pair in turn is what no number should be, among pairs that are in order.
template <class T, class A, class B>
void judge_bad(std::uint64_t seed) {
    const Batch<T, A, B> good = random_batch<T, A, B>(seed, 97);
    const std::vector<double> values{kNan, kInfinity, -kInfinity, 1e71,   -1e71, 1e70,   -1e70,
                                     1e36, -1e36,     -1.0,       1e-200, 1e-65, -1e-39, 1e-142};
    Batch<T, A, B> bad;
    std::size_t next = 0;
    for (const double value : values) {
        for (int number = 0; number < 25; ++number) {
            for (int i = 0; i < 3; ++i) {
                next = (next + 1) % good.a.size();
                A moving = good.a[next];
                V<T> motion = good.motions[next];
                B other = good.b[next];
                int k = 0;
                const auto spoil = [&](T& x) { x = k++ == number ? static_cast<T>(value) : x; };
                each_number(moving, spoil), each_number(motion, spoil), each_number(other, spoil);
                bad.add(moving, motion, other);
                bad.add(good.a[next], good.motions[next], good.b[next]);
            }
        }
    }
    expect_the_single_calls(bad);
    EXPECT_GT(count(bad, ImpactStatus::Invalid), 50);
    EXPECT_GT(count(bad, ImpactStatus::Touching), 50);
}
TYPED_TEST(SweepBatchOf, BadNumbersAmongGoodOnesAreTheSingleCalls) {
    using T = TypeParam;
    judge_bad<T, geo::Sphere<T>, geo::Plane<T>>(0x291);
    judge_bad<T, geo::Sphere<T>, geo::Sphere<T>>(0x25f);
    judge_bad<T, geo::Sphere<T>, geo::Capsule<T>>(0x2ca);
    judge_bad<T, geo::Sphere<T>, geo::Aabb<T>>(0x2ab);
    judge_bad<T, geo::Sphere<T>, geo::Obb<T>>(0x20b);
    judge_bad<T, geo::Sphere<T>, geo::Triangle<T>>(0x274);
    judge_bad<T, geo::Sphere<T>, geo::Cylinder<T>>(0x2c1);
    judge_bad<T, geo::Capsule<T>, geo::Plane<T>>(0x2c9);
    judge_bad<T, geo::Capsule<T>, geo::Sphere<T>>(0x2c5);
    judge_bad<T, geo::Capsule<T>, geo::Capsule<T>>(0x2cc);
    judge_bad<T, geo::Capsule<T>, geo::Aabb<T>>(0x2cab);
    judge_bad<T, geo::Capsule<T>, geo::Obb<T>>(0x2c0b);
    judge_bad<T, geo::Capsule<T>, geo::Triangle<T>>(0x2c74);
}

/// From the smallest sizes and ways that are answered to the largest.
template <class A, class B>
void judge_sizes(std::uint64_t seed) {
    Random r(seed);
    Batch<double, A, B> batch;
    for (int i = 0; i < 8'000; ++i) {
        const dvec3 at = some_vector<double>(r, 1.0);
        const double radius = some_size<double>(r, 0.4);
        B other;
        fill(r, other);
        dvec3 motion = some_vector<double>(r, 6.0);
        A moving = placed(r, A{}, at - 0.5 * motion, radius);
        const double all = std::pow(10.0, r.range(-110.0, 69.0)), of_b = r.unit() < 0.3 ? std::pow(10.0, r.range(-20.0, 3.0)) : 1.0;
        const auto scale = [&](double& x) { x *= all; };
        const auto scale_b = [&](double& x) { x *= of_b * (std::is_same_v<B, geo::Plane<double>> ? 1.0 : all); };
        each_number(moving, scale), each_number(motion, scale);
        if constexpr (std::is_same_v<B, geo::Obb<double>>) {
            each_number(other.center, scale_b), each_number(other.half_extents, scale_b);
        } else {
            each_number(other, scale_b);
        }
        if constexpr (std::is_same_v<B, geo::Plane<double>>) other.offset *= all;
        batch.add(moving, motion, other);
    }
    expect_the_single_calls(batch);
    EXPECT_GT(count(batch, ImpactStatus::Touching), 300);
}
TEST(SweepBatch, PairsOfAllSizesAreTheSingleCalls) {
    using Ball = geo::Sphere<double>;
    using Rod = geo::Capsule<double>;
    judge_sizes<Ball, geo::Plane<double>>(0x391);
    judge_sizes<Ball, geo::Sphere<double>>(0x35f);
    judge_sizes<Ball, geo::Capsule<double>>(0x3ca);
    judge_sizes<Ball, geo::Aabb<double>>(0x3ab);
    judge_sizes<Ball, geo::Obb<double>>(0x30b);
    judge_sizes<Ball, geo::Triangle<double>>(0x374);
    judge_sizes<Ball, geo::Cylinder<double>>(0x3c1);
    judge_sizes<Rod, geo::Plane<double>>(0x3c9);
    judge_sizes<Rod, geo::Sphere<double>>(0x3c5);
    judge_sizes<Rod, geo::Capsule<double>>(0x3cc);
    judge_sizes<Rod, geo::Aabb<double>>(0x3cab);
    judge_sizes<Rod, geo::Obb<double>>(0x3c0b);
    judge_sizes<Rod, geo::Triangle<double>>(0x3c74);
}

/// What is left of the last step is not written, and what is before it neither.
TEST(SweepBatch, EveryLengthIsAnsweredAndNothingElseIsWritten) {
    const auto batch = random_batch<float, geo::Sphere<float>, geo::Triangle<float>>(0x1e9, 300);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (std::size_t n = 0; n <= 140; ++n) {
            std::vector<BasicImpact<float>> out(n + 2);
            out.front().checks = out.back().checks = -7;
            geo::sweep<geo::Sphere<float>, geo::Triangle<float>, float>(std::span(batch.a).subspan(n, n),
                                                                        std::span(batch.motions).subspan(n, n),
                                                                        std::span(batch.b).subspan(n, n), std::span(out).subspan(1, n));
            ASSERT_EQ(out.front().checks, -7);
            ASSERT_EQ(out.back().checks, -7);
            for (std::size_t i = 0; i < n; ++i) ASSERT_TRUE(same_bits(out[i + 1], batch.singly[n + i])) << n << " " << i;
        }
    }
    set_simd_width(0);
}

TEST(SweepBatch, SpansOfOtherLengthsAreMisuse) {
    auto batch = random_batch<double, geo::Sphere<double>, geo::Plane<double>>(0x1, 9);
    std::vector<Impact> out(9, Impact{.t = 0.25});
    batch.b.pop_back();
    EXPECT_THROW((geo::sweep<geo::Sphere<double>, geo::Plane<double>, double>(batch.a, batch.motions, batch.b, out)), MisuseError);
    const std::span<const geo::Sphere<double>> a(batch.a);
    const std::span<const dvec3> motions(batch.motions);
    const std::span<const geo::Plane<double>> b(batch.b);
    EXPECT_THROW((geo::sweep_together<geo::Sphere<double>, geo::Plane<double>, double>(a, motions, b, out)), MisuseError);
    EXPECT_THROW((geo::sweep_together<geo::Sphere<double>, geo::Plane<double>, double>(a.first(8), motions, b, std::span(out).first(8))),
                 MisuseError);
    EXPECT_THROW((geo::sweep_together<geo::Sphere<double>, geo::Plane<double>, double>(a.first(8), motions.first(8), b, out)), MisuseError);
    for (const Impact& impact : out) EXPECT_EQ(impact.t, 0.25);
}

}  // namespace
}  // namespace carom
