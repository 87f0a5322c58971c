// Batches of moving spheres and capsules: transposed into rows, taken by the kernels in lanes, and what these leave by the single call.
#include <carom/narrowphase/sweep.hpp>

#include <carom/narrowphase/detail/sweep_frame.hpp>
#include <carom/narrowphase/detail/sweep_lanes.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace carom::geo {
namespace {

using carom::detail::Sweeper;
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

// Write a shape's numbers, and say what it is.
template <class T>
SweptCore put(Column c, const Plane<T>& p) noexcept {
    c.put(p.normal), c.put(double(p.offset));
    return SweptCore::Plane;
}
template <class T>
SweptCore put(Column c, const Sphere<T>& s) noexcept {
    c.put(s.center), c.put(double(s.radius));
    return SweptCore::Point;
}
template <class T>
SweptCore put(Column c, const Capsule<T>& s) noexcept {
    c.put(s.axis.a), c.put(s.axis.b), c.put(double(s.radius));
    return SweptCore::Segment;
}
template <class T>
SweptCore put(Column c, const Cylinder<T>& s) noexcept {
    c.put(s.axis.a), c.put(s.axis.b), c.put(double(s.radius));
    return SweptCore::Tube;
}
template <class T>
SweptCore put(Column c, const Aabb<T>& b) noexcept {
    c.put(b.lower), c.put(b.upper);
    return SweptCore::Box;
}
template <class T>
SweptCore put(Column c, const Obb<T>& b) noexcept {
    c.put(b.center), c.put(b.half_extents), c.put(b.axes[0]), c.put(b.axes[1]), c.put(b.axes[2]);
    return SweptCore::TurnedBox;
}
template <class T>
SweptCore put(Column c, const Triangle<T>& t) noexcept {
    c.put(t.a), c.put(t.b), c.put(t.c);
    return SweptCore::Triangle;
}

// What moves.
template <class T>
void put_moving(SweptRows& rows, std::size_t i, const Sphere<T>& a) noexcept {
    put(Column(rows, 0, i), a);
}
template <class T>
void put_moving(SweptRows& rows, std::size_t i, const Capsule<T>& a) noexcept {
    put(Column(rows, 0, i), Sphere<T>{a.axis.a, a.radius});
    Column(rows, SweptRows::kEnd, i).put(a.axis.b);
}
template <class A>
constexpr Sweeper kSweeper = requires(A a) {
    a.axis;
}
? Sweeper::Capsule : Sweeper::Sphere;

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
template <class B, class T>
void take(const SweptRows& rows, std::size_t i, BasicImpact<T>& to) noexcept {
    to.status = static_cast<ImpactStatus>(static_cast<int>(rows.out[SweptRows::kState][i]));
    to.t = time_of<T>(rows.out[SweptRows::kTime][i]);
    for (int k = 0; k < 3; ++k) {
        const auto row = static_cast<std::size_t>(k);
        to.point[k] = static_cast<T>(rows.out[SweptRows::kPoint + row][i]);
        to.normal[k] = static_cast<T>(rows.out[SweptRows::kNormal + row][i]);
    }
    to.checks = 0;
    if constexpr (std::is_same_v<B, Cylinder<T>>) to.checks = static_cast<int>(rows.out[SweptRows::kChecks][i]);
}

/// One pair alone: row by row, which is faster than column by column, since lanes load what was stored as one.
void fill_step(SweptRows& rows, std::size_t used) noexcept {
    for (std::size_t row = 0; row < used; ++row) std::fill_n(rows.in[row], SweptRows::kStep, rows.in[row][0]);
}

/// The call for one pair of which a kernel was not sure.
template <class A, class B, class T>
BasicImpact<T> leave(const A& a, const Vec3<T>& motion, const B& b) noexcept {
    if constexpr (kSweptAsBatch<A, B, T>) {
        return sweep_by_parts(a, motion, b);
    } else {
        return sweep(a, motion, b);
    }
}

}  // namespace

template <class A, class B, class T>
void sweep_together(std::span<const A> a, std::span<const Vec3<T>> motions, std::span<const B> b, std::span<BasicImpact<T>> out) {
    CAROM_REQUIRE(a.size() == motions.size() && a.size() == b.size() && a.size() == out.size(), ErrorCode::InvalidArgument,
                  "sweep_together: spans differ in length");
    SweptRows rows;
    for (std::size_t first = 0; first < a.size(); first += SweptRows::kPairs) {
        const std::size_t count = std::min(a.size() - first, SweptRows::kPairs);
        const std::size_t filled = count == 1 ? 1 : (count + SweptRows::kStep - 1) / SweptRows::kStep * SweptRows::kStep;
        SweptCore core{};
        for (std::size_t i = 0; i < filled; ++i) {
            const std::size_t pair = first + std::min(i, count - 1);  // the last fills what is left of its step
            put_moving(rows, i, a[pair]);
            Column(rows, SweptRows::kMotion, i).put(motions[pair]);
            core = put(Column(rows, SweptRows::shape_row(kSweeper<A>), i), b[pair]);
        }
        if (count == 1) fill_step(rows, SweptRows::shape_row(kSweeper<A>) + sizeof(B) / sizeof(T));
        carom::detail::sweep_lanes(kSweeper<A>, core, rows, filled);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t pair = first + i;
            if (rows.out[SweptRows::kState][i] == SweptRows::kUnsure) {
                out[pair] = leave(a[pair], motions[pair], b[pair]);
            } else {
                take<B>(rows, i, out[pair]);
            }
        }
    }
}

#define CAROM_SWEPT_OF(A, B, T) \
    template void sweep_together(std::span<const A<T>>, std::span<const Vec3<T>>, std::span<const B<T>>, std::span<BasicImpact<T>>);
#define CAROM_SWEPT(A, B)       \
    CAROM_SWEPT_OF(A, B, float) \
    CAROM_SWEPT_OF(A, B, double)
CAROM_SWEPT(Sphere, Plane)
CAROM_SWEPT(Sphere, Sphere)
CAROM_SWEPT(Sphere, Capsule)
CAROM_SWEPT(Sphere, Aabb)
CAROM_SWEPT(Sphere, Obb)
CAROM_SWEPT(Sphere, Triangle)
CAROM_SWEPT(Sphere, Cylinder)
CAROM_SWEPT(Capsule, Plane)
CAROM_SWEPT(Capsule, Sphere)
CAROM_SWEPT(Capsule, Capsule)
CAROM_SWEPT(Capsule, Aabb)
CAROM_SWEPT(Capsule, Obb)
CAROM_SWEPT(Capsule, Triangle)
#undef CAROM_SWEPT
#undef CAROM_SWEPT_OF

}  // namespace carom::geo
