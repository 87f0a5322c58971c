// Lanes over the boxes of nodes and the triangles of leaves, of two wide hierarchies: which boxes overlap, which triangles meet.
//
//   first.set(leaf_a, margin); second.set_placed(leaf_b, placement, margin);
//   list_partners(first, second, among, pair);          // by boxes
//   judge_partners(first, second, placement, pair);     // by planes and crossings, packed: a pair of triangles in each lane
//
// Included by kernel files after foreach_target.h; core/lanes.hpp says how these are written. The bounds are those of wide_pairs.hpp.

// This guard lets the file through once for each target.
#if defined(CAROM_COLLISION_WIDE_LEAF_PAIRS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_COLLISION_WIDE_LEAF_PAIRS_HPP
#undef CAROM_COLLISION_WIDE_LEAF_PAIRS_HPP
#else
#define CAROM_COLLISION_WIDE_LEAF_PAIRS_HPP
#endif

#include <carom/collision/detail/wide_pairs.hpp>
#include <carom/collision/detail/wide_traverse.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {

using Bounds = float[2][3][kWidth];  ///< [lower, upper][x, y, z][child or triangle]

/// Boxes around boxes that are turned and moved. Lanes without a child become anything.
HWY_INLINE void place_boxes(const Bounds& bound, const float (&to)[3][4], float margin, Bounds& out) {
    for (int row = 0; row < 3; ++row) {
        for (int part = 0; part < kWidth; part += kLanes) {
            Floats lower(to[row][3] - margin), upper(to[row][3] + margin);
            for (int k = 0; k < 3; ++k) {
                const Floats factor(to[row][k]);
                const int low = to[row][k] < 0.0f ? 1 : 0;
                lower += factor * load(bound[low][k] + part);
                upper += factor * load(bound[1 - low][k] + part);
            }
            store(lower, out[0][row] + part);
            store(upper, out[1][row] + part);
        }
    }
}

/// The box of a child or a triangle among others, as load(at(...)) of its node has it.
struct BoxAt {
    const float* lane;  ///< of the lower x
    HWY_INLINE BoxAt(const Bounds& of, std::size_t j) : lane(&of[0][0][j]) {}
    HWY_INLINE Floats lower(int k) const { return Floats(lane[k * kWidth]); }
    HWY_INLINE Floats upper(int k) const { return Floats(lane[(3 + k) * kWidth]); }
    HWY_INLINE float edge(int k) const { return lane[(3 + k) * kWidth] - lane[k * kWidth]; }
};

/// Those of 16 boxes that overlap another.
HWY_INLINE unsigned overlapping(const Bounds& boxes, BoxAt other) {
    unsigned met = 0;
    for (int part = 0; part < kWidth; part += kLanes) {
        Mask all = (load(boxes[0][0] + part) <= other.upper(0)) & (load(boxes[1][0] + part) >= other.lower(0));
        for (int k = 1; k < 3; ++k) all = all & (load(boxes[0][k] + part) <= other.upper(k)) & (load(boxes[1][k] + part) >= other.lower(k));
        met |= bits(all) << part;
    }
    return met;
}

/// The same of the boxes in `among`, and how deep each of the 16 reaches into the other, at most: the least overlap along an axis. That is not
/// below zero just where two boxes overlap, as the sign of a difference is not rounded.
HWY_INLINE unsigned overlapping_deep(const Bounds& boxes, BoxAt other, unsigned among, float* depths) {
    unsigned met = 0;
    for (int part = 0; part < kWidth; part += kLanes) {
        Floats depth(3e38f);
        for (int k = 0; k < 3; ++k) {
            depth = min(depth, min(load(boxes[1][k] + part), other.upper(k)) - max(load(boxes[0][k] + part), other.lower(k)));
        }
        met |= bits(depth >= Floats(0.0f)) << part;
        store(depth, depths + part);
    }
    return met & among;
}

/// Triangles of a leaf with what tells others apart from them.
struct alignas(64) Described {
    Bounds box;                  ///< grown by the margin
    float corner[3][3][kWidth];  ///< [corner][x, y, z], from `origin`
    float size[kWidth];          ///< of a box: the sum of its edges
    float origin[3];
    float around_origin;  ///< no vertex is farther from it
    Bounds whole;         ///< around all boxes, in lane 0, where it was asked for
    bool has_whole = false;

    HWY_INLINE void set(const WideLeaf& leaf, float margin) {
        for (float& o : origin) o = 0.0f;
        around_origin = 0.0f;
        set(leaf, leaf.vertex, margin);
    }
    /// A leaf of b in the frame of a, from the place of its first vertex.
    /// @param own  its box in the frame of b.
    HWY_INLINE void set_placed(const WideLeaf& leaf, BoxAt own, const WidePlacement& placement, float margin) {
        const double first[3] = {double{leaf.vertex[0][0]}, double{leaf.vertex[1][0]}, double{leaf.vertex[2][0]}};
        alignas(64) float vertex[3][kWidth];
        Floats off[3][kParts];
        for (int k = 0; k < 3; ++k) {
            for (int p = 0; p < kParts; ++p) off[k][p] = load(leaf.vertex[k] + p * kLanes) - Floats(leaf.vertex[k][0]);
        }
        for (int row = 0; row < 3; ++row) {
            const double(&map)[4] = placement.exact_to_a[row];
            const double at = map[3] + (map[0] * first[0] + map[1] * first[1] + map[2] * first[2]);
            origin[row] = static_cast<float>(at);
            const Floats rest(static_cast<float>(at - double{origin[row]}));
            const Floats factor[3] = {Floats(placement.to_a[row][0]), Floats(placement.to_a[row][1]), Floats(placement.to_a[row][2])};
            for (int p = 0; p < kParts; ++p) {
                store(rest + ((factor[0] * off[0][p] + factor[1] * off[1][p]) + factor[2] * off[2][p]), vertex[row] + p * kLanes);
            }
        }
        around_origin = placement.stretch * ((own.edge(0) + own.edge(1)) + own.edge(2));
        set(leaf, vertex, margin);
    }

    /// The box around them all.
    HWY_INLINE BoxAt around() {
        if (!has_whole) {
            has_whole = true;
            for (int k = 0; k < 3; ++k) {
                Floats lower(load(box[0][k])), upper(load(box[1][k]));
                for (int part = kLanes; part < kWidth; part += kLanes) {
                    lower = min(lower, load(box[0][k] + part));
                    upper = max(upper, load(box[1][k] + part));
                }
                whole[0][k][0] = least_lane(lower);
                whole[1][k][0] = greatest_lane(upper);
            }
        }
        return BoxAt(whole, 0);
    }

private:
    HWY_INLINE void set(const WideLeaf& leaf, const float (&vertex)[3][kWidth], float margin) {
        Table16 table[3];
        for (int axis = 0; axis < 3; ++axis) {
            for (int p = 0; p < kParts; ++p) table[axis].set(p, load(vertex[axis] + p * kLanes));
        }
        for (int part = 0; part < kWidth; part += kLanes) {
            const Picks picks[3] = {Picks(leaf.corner[0] + part), Picks(leaf.corner[1] + part), Picks(leaf.corner[2] + part)};
            Floats edges(6.0f * margin);
            for (int axis = 0; axis < 3; ++axis) {
                const Floats p[3] = {picks[0](table[axis]), picks[1](table[axis]), picks[2](table[axis])};
                for (int k = 0; k < 3; ++k) store(p[k], corner[k][axis] + part);
                const Floats lower = min(min(p[0], p[1]), p[2]), upper = max(max(p[0], p[1]), p[2]);
                edges += upper - lower;
                store(lower + Floats(origin[axis] - margin), box[0][axis] + part);
                store(upper + Floats(origin[axis] + margin), box[1][axis] + part);
            }
            store(edges, size + part);
        }
        has_whole = false;
    }
};
static_assert(offsetof(Described, corner) % 64 == 0 && offsetof(Described, size) % 64 == 0, "lanes are loaded and stored there");

HWY_INLINE Floats sum_of_sizes(const Floats3& n) { return abs(n.x) + abs(n.y) + abs(n.z); }

/// How far from zero the determinants of pairs of triangles must be to have a sign: the bounds of wide_pairs.hpp.
struct Doubts {
    Floats a, b;    ///< of heights over planes of triangles of a, and of b
    Floats across;  ///< of crossings

    /// @param l_a, l_b, around  L and N of wide_pairs.hpp.
    HWY_INLINE Doubts(Floats l_a, Floats l_b, Floats around, bool has_reach) {
        constexpr float u = 0x1p-24f;
        const Floats sum = l_a + l_b;
        const Floats d = Floats(30.3f * u) * (sum + around), w = sum + d;
        const Floats of_size = Floats(16.2f * u) * w, twice = d + d, beside = twice * w;
        const Floats times(has_reach ? 4.0f : 1.0f), p_a = l_a + d, p_b = l_b + d;
        a = (times * p_a) * (beside + (d + of_size) * p_a);
        b = (times * p_b) * (beside + (d + of_size) * p_b);
        across = w * (d * w + (twice + of_size) * l_a);
    }
};

/// The lone corner of triangles of which one corner is on one side and two are on the other, and the two after it.
struct Turned {
    Floats3 lone, next, last;
    Mask up;  ///< the lone corner is above
};
HWY_INLINE Mask alike(Mask x, Mask y) { return (x & y) | ((!x) & (!y)); }
HWY_INLINE Turned turned(const Floats3 (&corner)[3], Mask up0, Mask up1, Mask up2) {
    const Mask first = alike(up1, up2), second = alike(up0, up2);
    return {select(first, corner[0], select(second, corner[1], corner[2])), select(first, corner[1], select(second, corner[2], corner[0])),
            select(first, corner[2], select(second, corner[0], corner[1])), select(first, up0, select(second, up1, up2))};
}

struct Verdicts {
    Mask near;     ///< nothing parts them
    Mask certain;  ///< they meet
};

/// On pairs of triangles, one in each lane.
/// @param reach  in the frame of a.
HWY_INLINE Verdicts judge(const Floats3 (&corner)[3], const Floats3 (&other_corner)[3], const Doubts& doubts, float reach) {
    const Floats3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const Floats3 other_normal = cross(other_corner[1] - other_corner[0], other_corner[2] - other_corner[0]);
    Floats above[3], other_above[3];
    for (std::size_t k = 0; k < 3; ++k) {
        above[k] = dot(other_normal, corner[k] - other_corner[0]);
        other_above[k] = dot(normal, other_corner[k] - corner[0]);
    }
    Floats off_other = doubts.b, off_mine = doubts.a;
    if (reach > 0.0f) {
        off_other += Floats(reach) * sum_of_sizes(other_normal);
        off_mine += Floats(reach) * sum_of_sizes(normal);
    }
    const Mask near = (min(min(above[0], above[1]), above[2]) <= off_other) & (max(max(above[0], above[1]), above[2]) >= -off_other) &
                      (min(min(other_above[0], other_above[1]), other_above[2]) <= off_mine) &
                      (max(max(other_above[0], other_above[1]), other_above[2]) >= -off_mine);
    const Mask never = !first_lanes(kLanes);
    if (reach > 0.0f || none(near)) return {near, never};

    const Floats zero(0.0f);
    const Turned a = turned(corner, above[0] > zero, above[1] > zero, above[2] > zero);
    const Turned b = turned(other_corner, other_above[0] > zero, other_above[1] > zero, other_above[2] > zero);
    const Floats3 to_q = select(b.up, a.next, a.last) - a.lone, to_r = select(b.up, a.last, a.next) - a.lone;
    const Floats3 to_u = b.lone - a.lone, to_v = select(a.up, b.next, b.last) - a.lone, to_w = select(a.up, b.last, b.next) - a.lone;
    const Floats first = dot(cross(to_q, to_u), to_v), second = dot(cross(to_r, to_w), to_u), across = doubts.across;
    const Mask clear = (min(min(abs(above[0]), abs(above[1])), abs(above[2])) > off_other) &
                       (min(min(abs(other_above[0]), abs(other_above[1])), abs(other_above[2])) > off_mine);
    const Mask apart = clear & ((first > across) | (second > across));
    return {near & (!apart), near & clear & (first < -across) & (second < -across)};
}

/// One of 16 floats in each lane.
HWY_INLINE Floats pick(const float* of, Ints which) {
#if HWY_TARGET == HWY_AVX3
    return Floats{RawFloats{_mm512_permutexvar_ps(which.raw.raw, _mm512_load_ps(of))}};
#elif HWY_TARGET == HWY_AVX2
    const __m256 low = _mm256_permutevar8x32_ps(_mm256_load_ps(of), which.raw.raw);
    const __m256 high = _mm256_permutevar8x32_ps(_mm256_load_ps(of + 8), which.raw.raw);
    return Floats{RawFloats{_mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32(which.raw.raw, 28)))}};
#else
    return gather(of, which);
#endif
}
HWY_INLINE Floats3 pick_corner(const Described& from, int k, Ints which) {
    return {pick(from.corner[k][0], which), pick(from.corner[k][1], which), pick(from.corner[k][2], which)};
}

/// Lists the pairs of triangles whose boxes meet, of the triangles of b in `among`.
HWY_INLINE void list_partners(const Described& first, const Described& second, unsigned among, LeafPair& pair) {
    const auto triangles = static_cast<int>(pair.a->triangle_count);
    std::size_t count = 0;
    for (; among != 0; among &= among - 1) {
        const auto j = static_cast<std::size_t>(std::countr_zero(among));
        const BoxAt other(second.box, j);
        for (int part = 0; part < kWidth; part += kLanes) {
            Mask all = first_lanes(triangles > part ? triangles - part : 0);
            for (int k = 0; k < 3; ++k) {
                all = all & (load(first.box[0][k] + part) <= other.upper(k)) & (load(first.box[1][k] + part) >= other.lower(k));
            }
            count += compress_store(lane_numbers() + Ints(static_cast<std::int32_t>(16 * j) + part), all, pair.candidate + count);
        }
    }
    store_unaligned(Ints(0), pair.candidate + count);
    pair.count = count;
}

/// Keeps of the pairs listed those that nothing parts.
HWY_INLINE void judge_partners(const Described& first, const Described& second, const WidePlacement& placement, LeafPair& pair) {
    const Floats3 origin{Floats(second.origin[0]), Floats(second.origin[1]), Floats(second.origin[2])};
    const float reach = placement.reach_a;
    std::size_t kept = 0;
    for (std::size_t at = 0; at < pair.count; at += kLanes) {
        const Ints code = load(pair.candidate + at);
        const Ints i = code & Ints(15), j{hn::ShiftRight<4>(code.raw)};
        const Floats3 corner[3] = {pick_corner(first, 0, i) - origin, pick_corner(first, 1, i) - origin, pick_corner(first, 2, i) - origin};
        const Floats3 other_corner[3] = {pick_corner(second, 0, j), pick_corner(second, 1, j), pick_corner(second, 2, j)};
        const Verdicts verdicts = judge(
            corner, other_corner, Doubts(pick(first.size, i), pick(second.size, j), Floats(second.around_origin), reach > 0.0f), reach);
        const Mask there = first_lanes(static_cast<int>(pair.count - at < kLanes ? pair.count - at : kLanes));
        kept += compress_store(code + select(verdicts.certain, Ints(LeafPair::kCertain), Ints(0)), verdicts.near & there,
                               pair.candidate + kept);
    }
    pair.count = kept;
}

/// Pairs of triangles of several pairs of leaves side by side. Two leaves have eight or nine pairs of triangles in the mean whose boxes meet: judged
/// by themselves they leave half of the lanes empty.
class GatheredPairs {
public:
    /// Takes the pairs listed. Their leaves need not stay described.
    HWY_INLINE void add(const Described& first, const Described& second, const LeafPair& pair) {
        leaves_[leaf_count_++] = {pair.a, pair.b, count_};
        const Floats3 origin{Floats(second.origin[0]), Floats(second.origin[1]), Floats(second.origin[2])};
        for (std::size_t at = 0; at < pair.count; at += kLanes) {
            const Ints code = load(pair.candidate + at);
            const Ints i = code & Ints(15), j{hn::ShiftRight<4>(code.raw)};
            const std::size_t to = count_ + at;
            store_unaligned(code, code_ + to);
            const auto put = [&](std::size_t k, Floats x) { store_unaligned(x, number_[k] + to); };
            for (int k = 0; k < 3; ++k) {
                const Floats3 a = pick_corner(first, k, i) - origin, b = pick_corner(second, k, j);
                const auto from = static_cast<std::size_t>(6 * k);
                put(from, a.x), put(from + 1, a.y), put(from + 2, a.z), put(from + 3, b.x), put(from + 4, b.y), put(from + 5, b.z);
            }
            put(18, pick(first.size, i)), put(19, pick(second.size, j)), put(20, Floats(second.around_origin));
        }
        count_ += pair.count;
    }
    /// @return whether few lanes will be empty.
    [[nodiscard]] HWY_INLINE bool are_many() const { return count_ >= kMany; }

    /// Calls visit(pair) for each pair of leaves of which something is left, in the order in which they came. @return false once the visit has.
    template <class Visit>
    HWY_INLINE bool judge_all(float reach, LeafPair& pair, const Visit& visit) {
        judge_lanes(reach);
        leaves_[leaf_count_].begin = count_;
        for (std::size_t k = 0; k < leaf_count_; ++k) {
            take(leaves_[k].begin, leaves_[k + 1].begin, pair);
            pair.a = leaves_[k].a, pair.b = leaves_[k].b;
            if (pair.count != 0 && !visit(pair)) return false;
        }
        leaf_count_ = count_ = 0;
        return true;
    }

private:
    HWY_INLINE void judge_lanes(float reach) {
        for (std::size_t word = 0; word <= count_ / 64; ++word) near_[word] = certain_[word] = 0;
        for (std::size_t at = 0; at < count_; at += kLanes) {
            const auto corner = [&](std::size_t k) {
                return Floats3{load(number_[k] + at), load(number_[k + 1] + at), load(number_[k + 2] + at)};
            };
            const Floats3 mine[3] = {corner(0), corner(6), corner(12)}, other[3] = {corner(3), corner(9), corner(15)};
            const Doubts doubts(load(number_[18] + at), load(number_[19] + at), load(number_[20] + at), reach > 0.0f);
            const Verdicts verdicts = judge(mine, other, doubts, reach);
            near_[at / 64] |= std::uint64_t{bits(verdicts.near)} << at % 64;
            certain_[at / 64] |= std::uint64_t{bits(verdicts.certain)} << at % 64;
        }
    }
    // Pairs [begin, end): those that nothing parts.
    HWY_INLINE void take(std::size_t begin, std::size_t end, LeafPair& pair) const {
        pair.count = 0;
        for (std::size_t word = begin / 64; 64 * word < end; ++word) {
            std::uint64_t rest = near_[word];
            if (64 * word < begin) rest &= ~std::uint64_t{0} << begin % 64;
            if (end - 64 * word < 64) rest &= ~(~std::uint64_t{0} << end % 64);
            for (; rest != 0; rest &= rest - 1) {
                const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
                const std::int32_t certain = (certain_[word] >> bit & 1u) != 0 ? LeafPair::kCertain : 0;
                pair.candidate[pair.count++] = code_[64 * word + bit] + certain;
            }
        }
    }

    struct Leaves {
        const WideLeaf* a;
        const WideLeaf* b;
        std::size_t begin;
    };
    static constexpr std::size_t kMany = 64;                                    // of four or five bundles of 16 one may be half empty
    static constexpr std::size_t kRoom = kMany + kWidth * kWidth + 2 * kWidth;  // the last two leaves may add all of theirs
    alignas(64) float number_[21][kRoom];
    alignas(64) std::int32_t code_[kRoom];
    std::uint64_t near_[kRoom / 64 + 1], certain_[kRoom / 64 + 1];
    Leaves leaves_[kMany + 1];
    std::size_t leaf_count_ = 0, count_ = 0;
};

}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
