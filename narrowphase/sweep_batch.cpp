// Batches of moving spheres: transposed into rows, taken by the kernels in lanes, and what these leave by the single call.
#include <carom/narrowphase/sweep.hpp>

#include <carom/narrowphase/detail/sweep_lanes.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace carom::geo {
namespace {

using carom::detail::SweptCore;
using carom::detail::SweptRows;

/// Writes one column of a rows' array, downward.
class Column {
public:
    Column(SweptRows& rows, std::size_t row, std::size_t pair) noexcept : to_(rows.in[row] + pair) {}
    void put(double x) noexcept { *to_ = x, to_ += SweptRows::kPairs; }
    template <class T>
    void put(const Vec3<T>& v) noexcept {
        put(double(v.x)), put(double(v.y)), put(double(v.z));
    }

private:
    double* to_;
};

template <class T>
constexpr SweptCore core_of(const Plane<T>*) {
    return SweptCore::Plane;
}
template <class T>
constexpr SweptCore core_of(const Sphere<T>*) {
    return SweptCore::Point;
}
template <class T>
constexpr SweptCore core_of(const Capsule<T>*) {
    return SweptCore::Segment;
}
template <class T>
constexpr SweptCore core_of(const Aabb<T>*) {
    return SweptCore::Box;
}
template <class T>
constexpr SweptCore core_of(const Obb<T>*) {
    return SweptCore::TurnedBox;
}
template <class T>
constexpr SweptCore core_of(const Triangle<T>*) {
    return SweptCore::Triangle;
}

template <class T>
void put(Column c, const Plane<T>& p) noexcept {
    c.put(p.normal), c.put(double(p.offset));
}
template <class T>
void put(Column c, const Sphere<T>& s) noexcept {
    c.put(s.center), c.put(double(s.radius));
}
template <class T>
void put(Column c, const Capsule<T>& s) noexcept {
    c.put(s.axis.a), c.put(s.axis.b), c.put(double(s.radius));
}
template <class T>
void put(Column c, const Aabb<T>& b) noexcept {
    c.put(b.lower), c.put(b.upper);
}
template <class T>
void put(Column c, const Obb<T>& b) noexcept {
    c.put(b.center), c.put(b.half_extents), c.put(b.axes[0]), c.put(b.axes[1]), c.put(b.axes[2]);
}
template <class T>
void put(Column c, const Triangle<T>& t) noexcept {
    c.put(t.a), c.put(t.b), c.put(t.c);
}

/// Downward, as rounded() of detail/sweep_frame.hpp, for t > 0 where it is rounded up.
template <class T>
T time_of(double exact) noexcept {
    if constexpr (std::is_same_v<T, double>) {
        return exact;
    } else {
        const T t = static_cast<T>(exact);
        return std::bit_cast<T>(std::bit_cast<std::uint32_t>(t) - (static_cast<double>(t) > exact ? 1u : 0u));
    }
}

/// Number by number: what has just been stored by eights is slow to copy by sixteens.
template <class T>
void take(const SweptRows& rows, std::size_t i, BasicImpact<T>& to) noexcept {
    to.status = static_cast<ImpactStatus>(static_cast<int>(rows.out[SweptRows::kState][i]));
    to.t = time_of<T>(rows.out[SweptRows::kTime][i]);
    for (int k = 0; k < 3; ++k) {
        const auto row = static_cast<std::size_t>(k);
        to.point[k] = static_cast<T>(rows.out[SweptRows::kPoint + row][i]);
        to.normal[k] = static_cast<T>(rows.out[SweptRows::kNormal + row][i]);
    }
    to.checks = 0;
}

}  // namespace

template <class T, class B>
void sweep_spheres(std::span<const Sphere<T>> a, std::span<const Vec3<T>> motions, std::span<const B> b, std::span<BasicImpact<T>> out) {
    CAROM_REQUIRE(a.size() == motions.size() && a.size() == b.size() && a.size() == out.size(), ErrorCode::InvalidArgument,
                  "sweep_spheres: spans differ in length");
    SweptRows rows;
    for (std::size_t first = 0; first < a.size(); first += SweptRows::kPairs) {
        const std::size_t count = std::min(a.size() - first, SweptRows::kPairs);
        const std::size_t filled = (count + SweptRows::kStep - 1) / SweptRows::kStep * SweptRows::kStep;
        for (std::size_t i = 0; i < filled; ++i) {
            const std::size_t pair = first + std::min(i, count - 1);  // the last fills what is left of its step
            put(Column(rows, 0, i), a[pair]);
            Column(rows, SweptRows::kMotion, i).put(motions[pair]);
            put(Column(rows, SweptRows::kShape, i), b[pair]);
        }
        carom::detail::sweep_lanes(core_of(b.data()), rows, filled);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t pair = first + i;
            if (rows.out[SweptRows::kState][i] == SweptRows::kUnsure) {
                out[pair] = sweep(a[pair], motions[pair], b[pair]);
            } else {
                take(rows, i, out[pair]);
            }
        }
    }
}

#define CAROM_SWEPT_SPHERES(B)                                                                                              \
    template void sweep_spheres(std::span<const Sphere<float>>, std::span<const Vec3<float>>, std::span<const B<float>>,    \
                                std::span<BasicImpact<float>>);                                                             \
    template void sweep_spheres(std::span<const Sphere<double>>, std::span<const Vec3<double>>, std::span<const B<double>>, \
                                std::span<BasicImpact<double>>);
CAROM_SWEPT_SPHERES(Plane)
CAROM_SWEPT_SPHERES(Sphere)
CAROM_SWEPT_SPHERES(Capsule)
CAROM_SWEPT_SPHERES(Aabb)
CAROM_SWEPT_SPHERES(Obb)
CAROM_SWEPT_SPHERES(Triangle)
#undef CAROM_SWEPT_SPHERES

}  // namespace carom::geo
