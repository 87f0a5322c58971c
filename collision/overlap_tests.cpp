#include <carom/collision/overlap_tests.hpp>

#include <carom/collision/detail/closest_pair.hpp>
#include <carom/collision/detail/separating_axes.hpp>

namespace carom::geo {
namespace {

template <class T>
bool boxes_overlap(const Aabb<T>& a, const Aabb<T>& b) noexcept {
    bool meet = true;
    for (int i = 0; i < 3; ++i) {
        meet &= a.lower[i] <= b.upper[i] && b.lower[i] <= a.upper[i] && a.lower[i] <= a.upper[i] && b.lower[i] <= b.upper[i];
    }
    return meet;
}

template <class Core>
constexpr bool kIsTurned = std::is_same_v<Core, Obb<double>>;

// Simpler cores first, as detail::kRank has them.
template <class T, class A, class B>
detail::Verdict separate(const A& a, const B& b) noexcept {
    if constexpr (detail::kRank < A >> detail::kRank<B>) {
        return separate<T>(b, a);
    } else if constexpr (detail::kRank<A> >= 2) {
        constexpr bool turned = kIsTurned<A> || kIsTurned<B>;
        return detail::separate(a, b, turned ? detail::axis_error<T>() : detail::axis_error<double>());
    } else {
        return detail::Verdict::Unclear;
    }
}

}  // namespace

template <Overlappable A, Overlappable B>
requires std::same_as<detail::Scalar<A>, detail::Scalar<B>>
bool overlaps(const A& a, const B& b) noexcept {
    using T = detail::Scalar<A>;
    if constexpr (std::same_as<A, Aabb<T>> && std::same_as<B, Aabb<T>>) {
        return boxes_overlap(a, b);
    } else {
        const auto pair = detail::make_pair(a, b);
        if (!pair.valid) return false;
        const detail::Verdict verdict = separate<T>(pair.a, pair.b);
        if (verdict != detail::Verdict::Unclear) return verdict == detail::Verdict::Together;
        constexpr bool turned = std::same_as<A, Obb<T>> || std::same_as<B, Obb<T>>;
        const double slack = detail::slack(pair.size) + (turned ? 2.0 * detail::axis_error<T>() * pair.size : 0.0);
        const double reach = pair.radius_a + pair.radius_b + slack;
        return detail::closest_cores(pair).sq <= reach * reach;
    }
}

#define CAROM_OVERLAPS(A, B, T) template bool overlaps<A<T>, B<T>>(const A<T>&, const B<T>&) noexcept;
#define CAROM_OVERLAPS_ALL(A, T) \
    CAROM_OVERLAPS(A, Sphere, T) \
    CAROM_OVERLAPS(A, Aabb, T) CAROM_OVERLAPS(A, Obb, T) CAROM_OVERLAPS(A, Capsule, T) CAROM_OVERLAPS(A, Triangle, T)
#define CAROM_OVERLAPS_TABLE(T)   \
    CAROM_OVERLAPS_ALL(Sphere, T) \
    CAROM_OVERLAPS_ALL(Aabb, T) CAROM_OVERLAPS_ALL(Obb, T) CAROM_OVERLAPS_ALL(Capsule, T) CAROM_OVERLAPS_ALL(Triangle, T)
CAROM_OVERLAPS_TABLE(float)
CAROM_OVERLAPS_TABLE(double)
#undef CAROM_OVERLAPS_TABLE
#undef CAROM_OVERLAPS_ALL
#undef CAROM_OVERLAPS

}  // namespace carom::geo
