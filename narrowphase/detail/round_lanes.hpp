// What kernels of round shapes, boxes and planes share: eight pairs at a time, in double, the same operations in the same order as in their
// headers for one pair.
//
//   struct SphereSphere {
//       static WideContact<1> touch(const WideFrame& frame, const Sizes& size);
//   };
//   run<SphereSphere>(input, chosen, ShapeType::Sphere, out);

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_ROUND_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_ROUND_LANES_HPP
#undef CAROM_NARROWPHASE_ROUND_LANES_HPP
#else
#define CAROM_NARROWPHASE_ROUND_LANES_HPP
#endif

#include <carom/narrowphase/detail/frame_lanes.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

HWY_INLINE Doubles3 zero3() { return {Doubles(0.0), Doubles(0.0), Doubles(0.0)}; }
HWY_INLINE Doubles3 over(const Doubles3& v, Doubles s) { return {v.x / s, v.y / s, v.z / s}; }
HWY_INLINE DoubleMask nowhere() { return Doubles(0.0) > Doubles(0.0); }
HWY_INLINE Doubles least(Doubles a, Doubles b) { return select(b < a, b, a); }     // as std::min
HWY_INLINE Doubles greatest(Doubles a, Doubles b) { return select(a < b, b, a); }  // as std::max
HWY_INLINE Doubles clamp01(Doubles x) { return select(x > Doubles(0.0), select(x < Doubles(1.0), x, Doubles(1.0)), Doubles(0.0)); }

HWY_INLINE Doubles3 any_perpendicular(const Doubles3& n) {
    const Doubles one(1.0), sign = select(n.z < Doubles(0.0), Doubles(-1.0), one);
    const Doubles a = Doubles(-1.0) / (sign + n.z), b = (n.x * n.y) * a;
    return {one + ((sign * n.x) * n.x) * a, sign * b, (-sign) * n.x};
}

/// As add_ball() of detail/round_contact.hpp.
HWY_INLINE WideContactPoint ball_point(const Doubles3& centre, Doubles radius, const Doubles3& normal, Doubles distance, DoubleMask valid,
                                       Doubles feature = Doubles(0.0)) {
    return {centre + normal * (Doubles(0.5) * (radius + distance)), distance - radius, feature, valid};
}

/// The numbers of the two shapes, as PairRows has them.
struct Sizes {
    Doubles first[3], second[4];
};

/// As PlaneForm of detail/plane_form.hpp.
struct WidePlane {
    Doubles3 normal;
    Doubles offset;
    HWY_INLINE WidePlane(const WideFrame& f, const Sizes& size) : normal(zero3()), offset(0.0) {
        const Doubles3 stored{size.second[0], size.second[1], size.second[2]};
        const Doubles length = sqrt(dot(stored, stored));
        normal = f.rotation * over(stored, length);
        offset = size.second[3] / length + dot(normal, f.translation);
    }
    HWY_INLINE Doubles distance(const Doubles3& p) const { return dot(normal, p) - offset; }
};

/// Runs Kernel::touch() on all pairs, whose A or B is the kernel's first shape.
template <class Kernel>
HWY_INLINE void run(const BatchInput& input, std::span<const std::uint32_t> chosen, ShapeType first_type, ManifoldList& out) {
    using Contact = decltype(Kernel::touch(std::declval<const WideFrame&>(), std::declval<const Sizes&>()));
    PairRows rows;
    const bool swapped = type_of(*input.placed.shapes[input.pairs[chosen.front()].a]) != first_type;
    for (std::size_t begin = 0; begin < chosen.size(); begin += kDoubleBundleWidth) {
        const auto some = chosen.subspan(begin, std::min<std::size_t>(kDoubleBundleWidth, chosen.size() - begin));
        rows.fill(input, some, swapped);
        ContactRows<Contact::kPoints> contacts;
        for (int lane = 0; lane < kDoubleBundleWidth; lane += kDoubleLanes) {
            const auto read = [lane](const DoubleBundle& row) { return load(row.lane + lane); };
            const WideFrame frame = frame_of(rows, lane);
            const Sizes size{{read(rows.size_first[0]), read(rows.size_first[1]), read(rows.size_first[2])},
                             {read(rows.size_second[0]), read(rows.size_second[1]), read(rows.size_second[2]), read(rows.size_second[3])}};
            write_contact(Kernel::touch(frame, size), frame, swapped, lane, contacts);
        }
        contacts.write(some, out);
    }
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
