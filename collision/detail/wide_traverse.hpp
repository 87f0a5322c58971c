// Lanes over the wide hierarchy: boxes of a node, vertices of a leaf, and the walk of a ray from near to far.
//
//   traverse(tree, ray, start, [&](const WideLeaf& leaf) { ...; return true; });   // the visitor may lower ray.t_max
//
// Included by kernel files after foreach_target.h; core/lanes.hpp says how these are written.

// This guard lets the file through once for each target.
#if defined(CAROM_COLLISION_WIDE_TRAVERSE_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_COLLISION_WIDE_TRAVERSE_HPP
#undef CAROM_COLLISION_WIDE_TRAVERSE_HPP
#else
#define CAROM_COLLISION_WIDE_TRAVERSE_HPP
#endif

#include <carom/core/lanes_fused.hpp>

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_ray.hpp>

#include <hwy/cache_control.h>

#include <bit>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {

/// Registers to 16 lanes.
constexpr int kParts = kWidth / kLanes;

/// prepare() of wide_ray.hpp with the axes in lanes.
HWY_INLINE bool prepare_lanes(const WideBvh& tree, const geo::Ray<float>& ray, WideRay& out) {
#if HWY_TARGET == HWY_SCALAR
    return prepare(tree, ray, out);
#else
    const hn::Simd<float, 4, 0> tag;
    const auto origin = hn::LoadU(tag, &ray.origin.x);        // x, y, z, and the direction's x
    const auto direction = hn::LoadU(tag, &ray.direction.x);  // x, y, z, and t_min
    const auto largest_of = [&](auto v) HWY_ATTR {            // of x, y, z
        return hn::GetLane(hn::Max(hn::Max(v, hn::Shuffle0321(v)), hn::Shuffle1032(v)));
    };
    const auto to_lower = hn::Abs(hn::Sub(hn::Load(tag, &tree.lower.x), origin));
    const auto to_upper = hn::Abs(hn::Sub(hn::Load(tag, &tree.upper.x), origin));
    const float reach = largest_of(hn::Max(to_lower, to_upper));
    const float* d = &ray.direction.x;
    const std::int32_t z = largest_axis(std::abs(d[0]), std::abs(d[1]), std::abs(d[2]));
    const std::uint32_t exponent = (std::bit_cast<std::uint32_t>(d[z]) >> 23) & 0xffu;
    const auto not_finite = hn::Add(hn::Sub(origin, origin), hn::Sub(direction, direction));  // else zero
    if (!is_usual(tree, ray, reach, exponent) || !hn::AllTrue(tag, hn::Eq(not_finite, hn::Zero(tag)))) {
        return prepare_unusual(tree, ray, out);
    }
    const UnitBinade binade(exponent);
    const auto unit = hn::Mul(direction, hn::Set(tag, binade.shrink));
    const auto component = hn::CopySign(hn::Max(hn::Abs(unit), hn::Set(tag, WideRay::kLeastComponent)), unit);
    const auto inverse = hn::Div(hn::Set(tag, 1.0f), component);
    const float pad = WideRay::kPad * (reach + largest_of(hn::Abs(origin)));
    const auto side = hn::CopySign(hn::Set(tag, pad), component);
    hn::Store(origin, tag, out.origin);
    hn::Store(inverse, tag, out.inverse);
    hn::Store(hn::Mul(hn::Neg(hn::Add(origin, side)), inverse), tag, out.near);
    hn::Store(hn::Mul(hn::Neg(hn::Sub(origin, side)), inverse), tag, out.far);
    const hn::Rebind<std::uint32_t, decltype(tag)> word;
    const hn::Rebind<std::int32_t, decltype(tag)> integer;
    hn::Store(hn::BitCast(integer, hn::ShiftRight<31>(hn::BitCast(word, component))), integer, out.back);
    out.image_error = 0.5f * pad;
    const std::int32_t x = z == 2 ? 0 : z + 1;
    const std::int32_t y = x == 2 ? 0 : x + 1;
    out.axis[0] = x, out.axis[1] = y, out.axis[2] = z;
    out.depth = 1.0f / (d[z] * binade.shrink);
    out.shear[0] = d[x] * binade.shrink * out.depth;
    out.shear[1] = d[y] * binade.shrink * out.depth;
    set_bounds(ray, binade, out);
    return true;
#endif
}

/// A ray's constants for slabs, in registers.
struct SlabLanes {
    Floats inverse[3], near[3], far[3];
    std::int32_t back[3];

    HWY_INLINE explicit SlabLanes(const WideRay& ray) {
        for (int k = 0; k < 3; ++k) {
            inverse[k] = Floats(ray.inverse[k]);
            near[k] = Floats(ray.near[k]);
            far[k] = Floats(ray.far[k]);
            back[k] = ray.back[k];
        }
    }
};

/// a b + c, rounded once where that is free: boxes are padded for either.
HWY_INLINE Floats multiply_add(Floats a, Floats b, Floats c) {
    if constexpr (kHardwareFused) {
        return fused(a, b, c);
    } else {
        return a * b + c;
    }
}

/// Tests a node's boxes. @param near  receives where each is entered, 16 floats. @return the boxes that are met in [t_min, t_max].
HWY_INLINE unsigned meet_boxes(const WideNode& node, const SlabLanes& slabs, Floats t_min, Floats t_max, Floats* near_part) {
    unsigned met = 0;
    const float* near_x = node.bound[slabs.back[0]][0];
    const float* near_y = node.bound[slabs.back[1]][1];
    const float* near_z = node.bound[slabs.back[2]][2];
    const float* far_x = node.bound[slabs.back[0] ^ 1][0];
    const float* far_y = node.bound[slabs.back[1] ^ 1][1];
    const float* far_z = node.bound[slabs.back[2] ^ 1][2];
    for (int part = 0; part < kParts; ++part) {
        const int at = part * kLanes;
        const Floats near = max(max(multiply_add(load(near_x + at), slabs.inverse[0], slabs.near[0]),
                                    multiply_add(load(near_y + at), slabs.inverse[1], slabs.near[1])),
                                max(multiply_add(load(near_z + at), slabs.inverse[2], slabs.near[2]), t_min));
        const Floats far = min(min(multiply_add(load(far_x + at), slabs.inverse[0], slabs.far[0]),
                                   multiply_add(load(far_y + at), slabs.inverse[1], slabs.far[1])),
                               min(multiply_add(load(far_z + at), slabs.inverse[2], slabs.far[2]), t_max));
        met |= bits(near <= far) << at;
        near_part[part] = near;
    }
    return met;
}

/// What waits on the stack. `near` is a lower bound of where the box is entered.
struct WideEntry {
    WideRef ref;
    float near;
};

/// Puts the met children (three or more) on the stack, the nearest on top.
HWY_INLINE void push_sorted(const WideNode& node, unsigned met, const Floats* near_part, WideEntry* stack, std::size_t& size) {
    // Keys order by entry, then lane; as all entries are >= +0 the bits of a float order like the float.
    alignas(64) std::int32_t keys[kWidth];
    Ints key_part[kParts];
    for (int part = 0; part < kParts; ++part) {
        const Ints lane = lane_numbers() + Ints(part * kLanes);
        key_part[part] = (as_ints(near_part[part]) & Ints(~15)) | lane;
        store(key_part[part], keys + part * kLanes);
    }
    const auto count = static_cast<std::size_t>(std::popcount(met));
    for (unsigned rest = met; rest != 0; rest &= rest - 1) {
        const auto child = static_cast<std::size_t>(std::countr_zero(rest));
        const Ints key(keys[child]);
        unsigned nearer = 0;
        for (int part = 0; part < kParts; ++part) nearer |= bits(key_part[part] < key) << (part * kLanes);
        const auto rank = static_cast<std::size_t>(std::popcount(nearer & met));
        stack[size + count - 1 - rank] = {node.child[child], std::bit_cast<float>(keys[child] & ~15)};
    }
    size += count;
}

/// Fetches what is on top of the stack while something nearer is looked at: worth a tenth on trees that leave the cache.
HWY_INLINE void prefetch(const WideBvh::Line* lines, WideRef ref) {
    const WideBvh::Line* const at = lines + (is_leaf(ref) ? ~ref : ref);
    for (std::size_t i = 0; i < sizeof(WideLeaf) / sizeof(*at); ++i) hwy::Prefetch(at + i);
    if (is_leaf(ref)) return;
    for (std::size_t i = sizeof(WideLeaf) / sizeof(*at); i < sizeof(WideNode) / sizeof(*at); ++i) hwy::Prefetch(at + i);
}

/// Calls `visit(leaf)` for every leaf whose box the ray meets in [t_min, t_max], nearer ones mostly first, until it returns false.
/// `visit` may lower ray.t_max.
template <class Visit>
HWY_INLINE void traverse(const WideBvh& tree, WideRay& ray, Visit&& visit) {
    WideEntry stack[WideBvh::kMaxStack];
    std::size_t size = 0;
    const SlabLanes slabs(ray);
    const Floats t_min(ray.t_min);
    const WideBvh::Line* const lines = tree.lines.data();
    WideRef here = WideBvh::root();
    for (;;) {
        while (!is_leaf(here)) {
            const WideNode& node = *reinterpret_cast<const WideNode*>(lines + here);
            Floats near_part[kParts];
            const unsigned met = meet_boxes(node, slabs, t_min, Floats(ray.t_max), near_part);
            if (met == 0) goto next;
            const auto first = static_cast<std::size_t>(std::countr_zero(met));
            unsigned rest = met & (met - 1);
            if (rest == 0) {
                here = node.child[first];
                continue;
            }
            const auto second = static_cast<std::size_t>(std::countr_zero(rest));
            rest &= rest - 1;
            if (rest == 0) {
                alignas(64) float near[kWidth];
                for (int part = 0; part < kParts; ++part) store(near_part[part], near + part * kLanes);
                const bool swap = near[second] < near[first];
                const WideRef a = node.child[first];
                const WideRef b = node.child[second];
                here = swap ? b : a;
                stack[size++] = {swap ? a : b, swap ? near[first] : near[second]};
                prefetch(lines, stack[size - 1].ref);
                continue;
            }
            push_sorted(node, met, near_part, stack, size);
            here = stack[--size].ref;
            prefetch(lines, stack[size - 1].ref);
        }
        if (!visit(*reinterpret_cast<const WideLeaf*>(lines + ~here))) return;
    next:
        do {
            if (size == 0) return;
            --size;
        } while (stack[size].near > ray.t_max);
        here = stack[size].ref;
    }
}

/// Sixteen floats from which lanes pick by byte indices.
struct Table16 {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX2
    RawFloats part[kParts];
    HWY_INLINE void set(int p, Floats values) { part[p] = values.raw; }
#else
    alignas(64) float values[kWidth];
    HWY_INLINE void set(int p, Floats v) { store(v, values + p * kLanes); }
#endif
};

/// Which of 16 floats each lane of one register wants.
struct Picks {
#if HWY_TARGET == HWY_AVX3
    __m512i index;
    HWY_INLINE explicit Picks(const std::uint8_t* bytes) {
        index = _mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(bytes)));
    }
    HWY_INLINE Floats operator()(const Table16& table) const {
        return Floats{RawFloats{_mm512_permutexvar_ps(index, table.part[0].raw)}};
    }
#elif HWY_TARGET == HWY_AVX2
    __m256i index;
    __m256 upper;  ///< sign bit set where the index is 8 or more
    HWY_INLINE explicit Picks(const std::uint8_t* bytes) {
        index = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes)));
        upper = _mm256_castsi256_ps(_mm256_slli_epi32(index, 28));
    }
    HWY_INLINE Floats operator()(const Table16& table) const {
        const __m256 low = _mm256_permutevar8x32_ps(table.part[0].raw, index);
        const __m256 high = _mm256_permutevar8x32_ps(table.part[1].raw, index);
        return Floats{RawFloats{_mm256_blendv_ps(low, high, upper)}};
    }
#else
    const std::uint8_t* bytes;
    HWY_INLINE explicit Picks(const std::uint8_t* b) : bytes(b) {}
    HWY_INLINE Floats operator()(const Table16& table) const {
        alignas(64) float picked[kLanes];
        for (int lane = 0; lane < kLanes; ++lane) picked[lane] = table.values[bytes[lane]];
        return load(picked);
    }
#endif
};

/// The vertices of a leaf as the ray sees them: images x, y across it, depth z along it (not divided by the direction's).
struct LeafImages {
    Table16 x, y, z;

    HWY_INLINE LeafImages(const WideLeaf& leaf, const WideRay& ray) {
        const float* from_x = leaf.vertex[ray.axis[0]];
        const float* from_y = leaf.vertex[ray.axis[1]];
        const float* from_z = leaf.vertex[ray.axis[2]];
        const Floats origin_x(ray.origin[ray.axis[0]]), origin_y(ray.origin[ray.axis[1]]), origin_z(ray.origin[ray.axis[2]]);
        const Floats shear_x(-ray.shear[0]), shear_y(-ray.shear[1]);
        for (int part = 0; part < kParts; ++part) {
            const int at = part * kLanes;
            const Floats depth = load(from_z + at) - origin_z;
            x.set(part, fused(shear_x, depth, load(from_x + at) - origin_x));
            y.set(part, fused(shear_y, depth, load(from_y + at) - origin_y));
            z.set(part, depth);
        }
    }
};

/// Images of the corners of kLanes triangles, and the edge functions opposite to them: twice the area of the ray's point with the
/// other two. Their signs are exact.
struct TriangleLanes {
    Floats ax, ay, bx, by, cx, cy;
    Floats u, v, w;

    HWY_INLINE TriangleLanes(const LeafImages& images, const Picks& a, const Picks& b, const Picks& c)
        : ax(a(images.x)), ay(a(images.y)), bx(b(images.x)), by(b(images.y)), cx(c(images.x)), cy(c(images.y)),
          u(difference_of_products(cx, by, cy, bx)), v(difference_of_products(ax, cy, ay, cx)),
          w(difference_of_products(bx, ay, by, ax)) {}

    /// True where the ray's line passes the triangle, edges and corners included.
    HWY_INLINE Mask inside() const {
        const Floats zero(0.0f);
        return (min(min(u, v), w) >= zero) | (max(max(u, v), w) <= zero);
    }
};

}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
