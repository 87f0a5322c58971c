#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/wide_pairs.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/wide_pairs.hpp>
#include <carom/collision/detail/wide_traverse.hpp>

#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

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

/// The boxes that overlap box j of the others.
HWY_INLINE unsigned overlapping(const Bounds& boxes, const Bounds& others, std::size_t j) {
    unsigned met = 0;
    for (int part = 0; part < kWidth; part += kLanes) {
        Mask all = first_lanes(kLanes);
        for (int k = 0; k < 3; ++k) {
            all = all & (load(boxes[0][k] + part) <= Floats(others[1][k][j])) & (load(boxes[1][k] + part) >= Floats(others[0][k][j]));
        }
        met |= bits(all) << part;
    }
    return met;
}

/// The box around all of them.
struct Whole {
    float lower[3], upper[3];
};
HWY_INLINE Whole whole_of(const Bounds& boxes) {
    Whole out;
    for (int k = 0; k < 3; ++k) {
        Floats lower(load(boxes[0][k])), upper(load(boxes[1][k]));
        for (int part = kLanes; part < kWidth; part += kLanes) {
            lower = min(lower, load(boxes[0][k] + part));
            upper = max(upper, load(boxes[1][k] + part));
        }
        out.lower[k] = least_lane(lower);
        out.upper[k] = greatest_lane(upper);
    }
    return out;
}
HWY_INLINE unsigned overlapping(const Bounds& boxes, const Whole& other) {
    unsigned met = 0;
    for (int part = 0; part < kWidth; part += kLanes) {
        Mask all = first_lanes(kLanes);
        for (int k = 0; k < 3; ++k) {
            all = all & (load(boxes[0][k] + part) <= Floats(other.upper[k])) & (load(boxes[1][k] + part) >= Floats(other.lower[k]));
        }
        met |= bits(all) << part;
    }
    return met;
}

/// The boxes of a that overlap box j of b in the frames of both, and how far the deepest reaches into it, at most: the least overlap along an
/// axis in the frame of a. That is not below zero just where two boxes overlap, as the sign of a difference is not rounded.
struct Met {
    unsigned boxes;
    float depth;
};
HWY_INLINE Met met_by(const Bounds& a, const Bounds& b_in_a, const Bounds& a_in_b, const Bounds& b, std::size_t j) {
    Met met{0, -1.0f};
    Floats deepest(-1.0f);
    for (int part = 0; part < kWidth; part += kLanes) {
        Floats depth(3e38f);
        Mask all = first_lanes(kLanes);
        for (int k = 0; k < 3; ++k) {
            depth = min(depth, min(load(a[1][k] + part), Floats(b_in_a[1][k][j])) - max(load(a[0][k] + part), Floats(b_in_a[0][k][j])));
            all = all & (load(a_in_b[0][k] + part) <= Floats(b[1][k][j])) & (load(a_in_b[1][k] + part) >= Floats(b[0][k][j]));
        }
        all = all & (depth >= Floats(0.0f));
        met.boxes |= bits(all) << part;
        deepest = max(deepest, select(all, depth, Floats(-1.0f)));
    }
    if (met.boxes != 0) met.depth = greatest_lane(deepest);
    return met;
}

/// Triangles of a leaf with what tells others apart from them, the planes only where they are wanted.
struct alignas(64) Described {
    Bounds box;                   ///< grown by the margin
    float corner[3][3][kWidth];   ///< [corner][x, y, z]
    float normal[3][kWidth];
    float size[kWidth];           ///< no less than the normal's length
    float longest;                ///< edge of a box, margin included
    Whole whole;                  ///< around all boxes
    bool has_planes = false;

    HWY_INLINE void set(const WideLeaf& leaf, const float (&vertex)[3][kWidth], float margin) {
        Floats length(0.0f);
        const Floats m(margin);
        for (int axis = 0; axis < 3; ++axis) {
            Table16 table;
            for (int p = 0; p < kParts; ++p) table.set(p, load(vertex[axis] + p * kLanes));
            for (int part = 0; part < kWidth; part += kLanes) {
                Floats p[3];
                for (int k = 0; k < 3; ++k) {
                    p[k] = Picks(leaf.corner[k] + part)(table);
                    store(p[k], corner[k][axis] + part);
                }
                const Floats lower = min(min(p[0], p[1]), p[2]) - m;
                const Floats upper = max(max(p[0], p[1]), p[2]) + m;
                length = max(length, upper - lower);
                store(lower, box[0][axis] + part);
                store(upper, box[1][axis] + part);
            }
        }
        longest = greatest_lane(length);
        whole = whole_of(box);
        has_planes = false;
    }

    HWY_INLINE void set_planes() {
        if (has_planes) return;
        has_planes = true;
        for (int part = 0; part < kWidth; part += kLanes) {
            const auto at = [&](int k) HWY_ATTR {
                return Floats3{load(corner[k][0] + part), load(corner[k][1] + part), load(corner[k][2] + part)};
            };
            const Floats3 n = cross(at(1) - at(0), at(2) - at(0));
            store(n.x, normal[0] + part);
            store(n.y, normal[1] + part);
            store(n.z, normal[2] + part);
            store(abs(n.x) + abs(n.y) + abs(n.z), size + part);
        }
    }
};

/// How far from zero determinants of triangles of two leaves must be to have a sign: the bounds of wide_pairs.hpp.
struct Doubts {
    float a, b;    ///< of heights over planes of triangles of a, and of b
    float across;  ///< of crossings
    float reach;

    HWY_INLINE Doubts(const Described& first, const Described& second, const WidePlacement& placement) : reach(placement.reach_a) {
        constexpr float u = 0x1p-24f;
        const float l_a = 1.7321f * first.longest, l_b = 1.7321f * second.longest;
        const float w = 1.7321f * (first.longest + second.longest + 4.0f * placement.margin_a);
        const float edge_a = u * l_a, edge_b = 2.0f * placement.corner_error + u * l_b, between = placement.corner_error + u * w;
        const float times = reach > 0.0f ? 4.0f : 1.0f;
        a = times * bound(l_a, edge_a, l_a, edge_a, w, between);
        b = times * bound(l_b, edge_b, l_b, edge_b, w, between);
        across = bound(l_a, edge_a, w, between, w, between);
    }
    /// Of a determinant of vectors of sizes e, f, g, wrong by de, df, dg in each component.
    HWY_INLINE static float bound(float e, float de, float f, float df, float g, float dg) {
        return 1.01f * (1.7321f * (de * f * g + e * df * g + e * f * dg) + 3.0f * (de * df * g + de * f * dg + e * df * dg) +
                        6.0f * de * df * dg + 0x1p-20f * e * f * g);
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

/// On triangle j of `other` and the triangles of `mine` in one part.
HWY_INLINE Verdicts judge(const Described& mine, int part, const Described& other, std::size_t j, const Doubts& doubts) {
    const auto own = [&](int k) HWY_ATTR {
        return Floats3{load(mine.corner[k][0] + part), load(mine.corner[k][1] + part), load(mine.corner[k][2] + part)};
    };
    const auto others = [&](int k) HWY_ATTR {
        return Floats3{Floats(other.corner[k][0][j]), Floats(other.corner[k][1][j]), Floats(other.corner[k][2][j])};
    };
    const Floats3 corner[3] = {own(0), own(1), own(2)}, other_corner[3] = {others(0), others(1), others(2)};
    const Floats3 normal{load(mine.normal[0] + part), load(mine.normal[1] + part), load(mine.normal[2] + part)};
    const Floats3 other_normal{Floats(other.normal[0][j]), Floats(other.normal[1][j]), Floats(other.normal[2][j])};
    Floats above[3], other_above[3];
    for (std::size_t k = 0; k < 3; ++k) {
        above[k] = dot(other_normal, corner[k] - other_corner[0]);
        other_above[k] = dot(normal, other_corner[k] - corner[0]);
    }
    const Floats off_other = Floats(doubts.b + doubts.reach * other.size[j]), off_mine = Floats(doubts.a) + Floats(doubts.reach) * load(mine.size + part);
    const Mask near = (min(min(above[0], above[1]), above[2]) <= off_other) & (max(max(above[0], above[1]), above[2]) >= -off_other) &
                      (min(min(other_above[0], other_above[1]), other_above[2]) <= off_mine) &
                      (max(max(other_above[0], other_above[1]), other_above[2]) >= -off_mine);
    const Mask never = !first_lanes(kLanes);
    if (doubts.reach > 0.0f || none(near)) return {near, never};

    const Floats zero(0.0f);
    const Turned a = turned(corner, above[0] > zero, above[1] > zero, above[2] > zero);
    const Turned b = turned(other_corner, other_above[0] > zero, other_above[1] > zero, other_above[2] > zero);
    const Floats3 to_q = select(b.up, a.next, a.last) - a.lone, to_r = select(b.up, a.last, a.next) - a.lone;
    const Floats3 to_u = b.lone - a.lone, to_v = select(a.up, b.next, b.last) - a.lone, to_w = select(a.up, b.last, b.next) - a.lone;
    const Floats first = dot(cross(to_q, to_u), to_v), second = dot(cross(to_r, to_w), to_u), across(doubts.across);
    const Mask clear = (min(min(abs(above[0]), abs(above[1])), abs(above[2])) > off_other) &
                       (min(min(abs(other_above[0]), abs(other_above[1])), abs(other_above[2])) > off_mine);
    const Mask apart = clear & ((first > across) | (second > across));
    return {near & (!apart), near & clear & (first < -across) & (second < -across)};
}

/// The vertices of a leaf of b in the frame of a.
HWY_INLINE void place_vertices(const WideLeaf& leaf, const float (&to)[3][4], float (&out)[3][kWidth]) {
    for (int row = 0; row < 3; ++row) {
        for (int part = 0; part < kWidth; part += kLanes) {
            Floats sum(to[row][3]);
            for (int k = 0; k < 3; ++k) sum += Floats(to[row][k]) * load(leaf.vertex[k] + part);
            store(sum, out[row] + part);
        }
    }
}

/// @return whether any triangles may meet; then `pair.partners` says which.
HWY_INLINE bool find_partners(Described& first, Described& second, const WidePlacement& placement, LeafPair& pair) {
    const unsigned near_b = overlapping(first.box, second.whole) & ((1u << pair.a.triangle_count) - 1u);
    const unsigned near_a = overlapping(second.box, first.whole) & ((1u << pair.b.triangle_count) - 1u);
    if (near_a == 0 || near_b == 0) return false;
    unsigned some = 0;
    for (unsigned rest = near_a; rest != 0; rest &= rest - 1) {
        const auto j = static_cast<std::size_t>(std::countr_zero(rest));
        pair.partners[j] = overlapping(first.box, second.box, j) & near_b;
        some |= pair.partners[j];
    }
    if (some == 0) return false;
    first.set_planes();
    second.set_planes();
    const Doubts doubts(first, second, placement);
    some = 0;
    for (std::size_t j = 0; j < pair.b.triangle_count; ++j) {
        if (pair.partners[j] == 0) continue;
        unsigned near = 0, certain = 0;
        for (int part = 0; part < kWidth; part += kLanes) {
            if ((pair.partners[j] >> part & ((1u << kLanes) - 1u)) == 0) continue;
            const Verdicts verdicts = judge(first, part, second, j, doubts);
            near |= bits(verdicts.near) << part;
            certain |= bits(verdicts.certain) << part;
        }
        pair.partners[j] &= near;
        pair.certain[j] = certain & pair.partners[j];
        some |= pair.partners[j];
    }
    return some != 0;
}

/// The children of a node, or a leaf as its own only child.
struct Side {
    const Bounds* bound;
    const WideRef* child;
    std::size_t count;
};

struct PairEntry {
    WideRef a, b;
};

/// The box of a leaf's vertices, in lane 0; the other lanes have none.
HWY_INLINE void bound_leaf(const WideLeaf& leaf, Bounds& out) {
    for (int axis = 0; axis < 3; ++axis) {
        Floats lower(load(leaf.vertex[axis])), upper(lower);
        for (int part = kLanes; part < kWidth; part += kLanes) {
            lower = min(lower, load(leaf.vertex[axis] + part));
            upper = max(upper, load(leaf.vertex[axis] + part));
        }
        for (int part = 0; part < kWidth; part += kLanes) {
            store(Floats(std::numeric_limits<float>::infinity()), out[0][axis] + part);
            store(Floats(-std::numeric_limits<float>::infinity()), out[1][axis] + part);
        }
        out[0][axis][0] = least_lane(lower);
        out[1][axis][0] = greatest_lane(upper);
    }
}

HWY_INLINE Side side_of(const WideBvh& tree, const WideRef& ref, Bounds& own) {
    if (is_leaf(ref)) {
        bound_leaf(tree.leaf(ref), own);
        return {&own, &ref, 1};
    }
    const WideNode& node = tree.node(ref);
    unsigned children = 0;
    for (int part = 0; part < kWidth; part += kLanes) {
        children |= bits(load(node.bound[0][0] + part) <= load(node.bound[1][0] + part)) << part;
    }
    return {&node.bound, node.child, static_cast<std::size_t>(std::popcount(children))};
}

void descend(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit) {
    // A visit may descend another pair of trees: the buffer is then in use.
    thread_local std::vector<PairEntry> kept;
    std::vector<PairEntry> stack = std::move(kept);
    stack.clear();
    stack.push_back({WideBvh::root(), WideBvh::root()});
    alignas(64) Bounds own_a, own_b, a_in_b, b_in_a;
    Described first_leaf, second_leaf;
    WideRef described_a = 0, described_b = 0;  // leaves are below zero
    while (!stack.empty()) {
        const PairEntry here = stack.back();
        stack.pop_back();
        if (is_leaf(here.a) && is_leaf(here.b)) {
            LeafPair pair{a.leaf(here.a), b.leaf(here.b), {}, {}};
            if (here.a != described_a) first_leaf.set(pair.a, pair.a.vertex, placement.margin_a);
            if (here.b != described_b) {
                alignas(64) float vertex[3][kWidth];
                place_vertices(pair.b, placement.to_a, vertex);
                second_leaf.set(pair.b, vertex, placement.margin_a + placement.reach_a);
            }
            described_a = here.a;
            described_b = here.b;
            if (find_partners(first_leaf, second_leaf, placement, pair) && !visit(pair)) break;
            continue;
        }
        const Side first = side_of(a, here.a, own_a), second = side_of(b, here.b, own_b);
        place_boxes(*first.bound, placement.to_b, placement.margin_b + placement.reach_b, a_in_b);
        place_boxes(*second.bound, placement.to_a, placement.margin_a + placement.reach_a, b_in_a);
        std::size_t deepest = stack.size();
        float depth = -1.0f;
        const unsigned there = (1u << second.count) - 1u;
        for (unsigned near = overlapping(b_in_a, whole_of(*first.bound)) & there; near != 0; near &= near - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(near));
            const Met met = met_by(*first.bound, b_in_a, a_in_b, *second.bound, j);
            if (met.depth > depth) {
                depth = met.depth;
                deepest = stack.size();
            }
            for (unsigned i = met.boxes; i != 0; i &= i - 1) stack.push_back({first.child[std::countr_zero(i)], second.child[j]});
        }
        if (depth >= 0.0f) std::swap(stack[deepest], stack.back());
    }
    kept = std::move(stack);
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
namespace {

HWY_EXPORT(descend);

}  // namespace

void visit_leaf_pairs(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit) {
    if (placement.too_unlike) {
        visit_leaf_pairs_in_double(a, b, placement, visit);
    } else {
        HWY_DYNAMIC_DISPATCH(descend)(a, b, placement, visit);
    }
}

}  // namespace carom
#endif
