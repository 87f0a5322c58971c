// GJK in lockstep: sixteen pairs side by side, each lane going on to the next pair as soon as its own is done.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/search_cores.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/bundle.hpp>
#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/pair_lanes.hpp>
#include <carom/narrowphase/detail/place_lanes.hpp>
#include <carom/narrowphase/detail/simplex_lanes.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

constexpr int kMostRounds = 24;  // in float; what is not done then is left to double

// A pair as its lane needs it.
struct PairBundle {
    FloatBundle rotation[3][3], offset[3];
    FloatBundle error, radii;
    std::uint32_t fit = 0;
};

// Sixteen searches under way.
struct State {
    PairBundle pair;
    FloatBundle w[3][3];          // of corner k, coordinate i
    IntBundle a[3], b[3], count;  // the simplex
    FloatBundle v[3], v_sq;       // the direction, from a to b: the simplex's point nearest to the origin
    FloatBundle along_b[3];       // -v in B's frame
    FloatBundle point_a[3], point_b[3];
    IntBundle index_a, index_b;  // support points, in their own frames
    IntBundle rounds;
    std::array<const LaneCores*, kBundleWidth> cores{};
    std::array<std::uint32_t, kBundleWidth> number{};
};

struct Found {
    std::uint32_t index;
    float x, y, z;
};

HWY_INLINE Floats reach(const ConvexHull::VertexBundle& points, int lane, const Floats3& d) {
    return dot(d, {load(points.x.lane + lane), load(points.y.lane + lane), load(points.z.lane + lane)});
}

HWY_INLINE Found pick(const ConvexHull::VertexBundle* points, std::uint32_t index) {
    const ConvexHull::VertexBundle& p = points[index / kBundleWidth];
    const std::uint32_t lane = index % kBundleWidth;
    return {index, p.x.lane[lane], p.y.lane[lane], p.z.lane[lane]};
}

// The point farthest along the direction; of equals the first. Up to 32 points stay in registers, and no branch depends on them.
template <int bundles>
HWY_INLINE Found farthest_of(const ConvexHull::VertexBundle* points, const Floats3& d) {
    constexpr int kParts = kBundleWidth / kLanes;
    Floats along[bundles * kParts];
    for (int k = 0; k < bundles * kParts; ++k) along[k] = reach(points[k / kParts], k % kParts * kLanes, d);
    Floats most = along[0];
    for (int k = 1; k < bundles * kParts; ++k) most = max(most, along[k]);
    const Floats top{hn::MaxOfLanes(FloatTag(), most.raw)};
    std::uint32_t equal = 0;
    for (int k = 0; k < bundles * kParts; ++k) equal |= bits(along[k] == top) << (k * kLanes);
    return pick(points, static_cast<std::uint32_t>(std::countr_zero(equal)) % (bundles * kBundleWidth));
}

HWY_INLINE Found farthest_of_many(const LaneCore& core, const Floats3& d) {
    Floats most(-std::numeric_limits<float>::infinity());
    for (std::uint32_t k = 0; k < core.bundles; ++k) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) most = max(most, reach(core.points[k], lane, d));
    }
    const Floats top{hn::MaxOfLanes(FloatTag(), most.raw)};
    for (std::uint32_t k = 0; k < core.bundles; ++k) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            const unsigned equal = bits(reach(core.points[k], lane, d) == top);
            if (equal != 0) return pick(core.points, k * kBundleWidth + static_cast<std::uint32_t>(lane + std::countr_zero(equal)));
        }
    }
    return pick(core.points, 0);
}

HWY_INLINE Found farthest(const LaneCore& core, float dx, float dy, float dz) {
    if (core.points == nullptr) {
        const bool x = core.half.x * dx > 0.0f, y = core.half.y * dy > 0.0f, z = core.half.z * dz > 0.0f;
        return {(x ? 1u : 0u) + (y ? 2u : 0u) + (z ? 4u : 0u), x ? core.half.x : -core.half.x, y ? core.half.y : -core.half.y,
                z ? core.half.z : -core.half.z};
    }
    const Floats3 d{dx, dy, dz};
    if (core.bundles == 1) return farthest_of<1>(core.points, d);
    return core.bundles == 2 ? farthest_of<2>(core.points, d) : farthest_of_many(core, d);
}

class Lockstep {
public:
    Lockstep(std::span<const LaneCores> pairs, LaneGoal goal, LaneResult* results) : pairs_(pairs), goal_(goal), results_(results) {}

    void run() {
        for (int lane = 0; lane < kBundleWidth; ++lane) refill(lane);
        while (active_ != 0) {
            for (int lane = 0; lane < kBundleWidth; lane += kLanes) turn_directions(lane);
            for (std::uint32_t rest = active_; rest != 0; rest &= rest - 1) find_supports(std::countr_zero(rest));
            std::uint32_t done = 0;
            for (int lane = 0; lane < kBundleWidth; lane += kLanes) done |= step(lane) << lane;
            done &= active_;
            for (std::uint32_t rest = done; rest != 0; rest &= rest - 1) finish(std::countr_zero(rest));
        }
    }

private:
    // Brings the next sixteen pairs into A's frames.
    void place_next() {
        alignas(64) float size[16], radii[16];
        const std::size_t count = std::min<std::size_t>(kBundleWidth, pairs_.size() - next_);
        ready_.fit = 0;
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            LaneRows<3> rows;
            for (int l = 0; l < kLanes; ++l) {
                const auto i = static_cast<std::size_t>(lane + l);
                const LaneCores& pair = pairs_[next_ + (i < count ? i : 0)];
                write_place(pair.place, l, rows);
                radii[i] = pair.a.radius + pair.b.radius;
                size[i] = (pair.a.reach + pair.b.reach) + radii[i];
            }
            const Placement p = placement_of(rows);
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) store(p.rotation[i][j], ready_.rotation[i][j].lane + lane);
                store(p.offset[i], ready_.offset[i].lane + lane);
            }
            const Floats all = ((abs(p.offset[0]) + abs(p.offset[1])) + abs(p.offset[2])) + load(size + lane);
            store(all * Floats(kLaneRounding), ready_.error.lane + lane);
            store(load(radii + lane), ready_.radii.lane + lane);
            ready_.fit |= bits(p.fit & (all > Floats(kSmallestLaneSize)) & (all < Floats(kLargestLaneSize))) << lane;
        }
        ready_first_ = next_;
    }

    // The lane takes the next pair that floats can take.
    void refill(int lane) {
        active_ &= ~(1u << lane);
        while (next_ < pairs_.size()) {
            if (next_ % kBundleWidth == 0) place_next();
            const std::size_t from = next_ - ready_first_;
            results_[next_] = {};
            if ((ready_.fit >> from & 1u) == 0) {
                ++next_;
                continue;
            }
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) state_.pair.rotation[i][j].lane[lane] = ready_.rotation[i][j].lane[from];
                state_.pair.offset[i].lane[lane] = ready_.offset[i].lane[from];
                state_.v[i].lane[lane] = ready_.offset[i].lane[from];
            }
            state_.pair.error.lane[lane] = ready_.error.lane[from];
            state_.pair.radii.lane[lane] = ready_.radii.lane[from];
            state_.count.lane[lane] = 0;
            state_.rounds.lane[lane] = 0;
            state_.v_sq.lane[lane] = std::numeric_limits<float>::infinity();
            state_.cores[static_cast<std::size_t>(lane)] = &pairs_[next_];
            state_.number[static_cast<std::size_t>(lane)] = static_cast<std::uint32_t>(next_++);
            active_ |= 1u << lane;
            return;
        }
    }

    void turn_directions(int lane) {
        const Floats3 v{load(state_.v[0].lane + lane), load(state_.v[1].lane + lane), load(state_.v[2].lane + lane)};
        for (int j = 0; j < 3; ++j) {
            const Floats3 axis{load(state_.pair.rotation[0][j].lane + lane), load(state_.pair.rotation[1][j].lane + lane),
                               load(state_.pair.rotation[2][j].lane + lane)};
            store(-dot(axis, v), state_.along_b[j].lane + lane);
        }
    }

    void find_supports(int lane) {
        const LaneCores& cores = *state_.cores[static_cast<std::size_t>(lane)];
        const Found a = farthest(cores.a, state_.v[0].lane[lane], state_.v[1].lane[lane], state_.v[2].lane[lane]);
        const Found b = farthest(cores.b, state_.along_b[0].lane[lane], state_.along_b[1].lane[lane], state_.along_b[2].lane[lane]);
        state_.index_a.lane[lane] = static_cast<std::int32_t>(a.index);
        state_.index_b.lane[lane] = static_cast<std::int32_t>(b.index);
        state_.point_a[0].lane[lane] = a.x, state_.point_a[1].lane[lane] = a.y, state_.point_a[2].lane[lane] = a.z;
        state_.point_b[0].lane[lane] = b.x, state_.point_b[1].lane[lane] = b.y, state_.point_b[2].lane[lane] = b.z;
    }

    // @return the lanes that are done, whose verdicts are set.
    unsigned step(int lane) {
        const auto three = [lane](const FloatBundle* b) {
            return Floats3{load(b[0].lane + lane), load(b[1].lane + lane), load(b[2].lane + lane)};
        };
        const auto row = [&](int i) { return three(state_.pair.rotation[i]); };
        const Floats3 v = three(state_.v), b = three(state_.point_b);
        const Floats3 turned{dot(row(0), b), dot(row(1), b), dot(row(2), b)};
        const WideCorner q((turned + three(state_.pair.offset)) - three(state_.point_a), load(state_.index_a.lane + lane),
                           load(state_.index_b.lane + lane));
        const Floats error = load(state_.pair.error.lane + lane), radii = load(state_.pair.radii.lane + lane);
        const Floats v_sq = load(state_.v_sq.lane + lane), far = length(v), plane = dot(v, q.w);
        const auto corner = [&](int k) {
            return WideCorner(three(state_.w[k]), load(state_.a[k].lane + lane), load(state_.b[k].lane + lane));
        };
        const WideSimplex simplex{{corner(0), corner(1), corner(2)}, load(state_.count.lane + lane)};
        // Nearer than the error, because double goes on from here, and each round of its own costs more.
        Mask met = (v_sq - plane <= Floats(0x1p-4f) * error * far) & (simplex.count > Ints(0));
        for (int k = 0; k < 3; ++k) {
            met = met | ((simplex.count > Ints(k)) & (simplex.corner[k].a == q.a) & (simplex.corner[k].b == q.b));
        }
        // A separating plane proves that the two are apart; who asks for the distance goes on.
        const Mask is_apart = plane > (error + radii) * far;
        const Mask apart = goal_ == LaneGoal::Verdict ? is_apart : (is_apart & met);

        const WideStep next = advance(simplex, q, error);
        const Floats rounds = to_floats(load(state_.rounds.lane + lane));
        const Floats near = length(next.nearest);
        const Mask stuck = (!(next.nearest_sq < v_sq)) | (near <= error + error) | (rounds >= Floats(static_cast<float>(kMostRounds)));
        const Mask overlap = (!apart) & (next.surely | (near + error < radii));
        const Mask done = apart | overlap | met | next.holds | stuck;

        const Mask goes_on = (!done);
        for (int k = 0; k < 3; ++k) {
            const WideCorner c = select(goes_on, next.simplex.corner[k], simplex.corner[k]);
            store(c.w.x, state_.w[k][0].lane + lane);
            store(c.w.y, state_.w[k][1].lane + lane);
            store(c.w.z, state_.w[k][2].lane + lane);
            store(c.a, state_.a[k].lane + lane);
            store(c.b, state_.b[k].lane + lane);
        }
        store(select(goes_on, next.simplex.count, simplex.count), state_.count.lane + lane);
        store(next.nearest.x, state_.v[0].lane + lane);
        store(next.nearest.y, state_.v[1].lane + lane);
        store(next.nearest.z, state_.v[2].lane + lane);
        store(next.nearest_sq, state_.v_sq.lane + lane);
        store(load(state_.rounds.lane + lane) + Ints(1), state_.rounds.lane + lane);
        apart_ = (apart_ & ~(((1u << kLanes) - 1u) << lane)) | bits(apart) << lane;
        overlap_ = (overlap_ & ~(((1u << kLanes) - 1u) << lane)) | bits(overlap) << lane;
        return bits(done);
    }

    void finish(int lane) {
        LaneResult& result = results_[state_.number[static_cast<std::size_t>(lane)]];
        if (goal_ == LaneGoal::Verdict && (apart_ >> lane & 1u) != 0) result.verdict = Overlap::Apart;
        if ((overlap_ >> lane & 1u) != 0) result.verdict = Overlap::Overlapping;
        result.rounds = state_.rounds.lane[lane];
        result.simplex.count = static_cast<std::uint32_t>(state_.count.lane[lane]);
        for (std::size_t k = 0; k < result.simplex.count; ++k) {
            result.simplex.a[k] = static_cast<std::uint32_t>(state_.a[k].lane[lane]);
            result.simplex.b[k] = static_cast<std::uint32_t>(state_.b[k].lane[lane]);
        }
        refill(lane);
    }

    std::span<const LaneCores> pairs_;
    LaneGoal goal_;
    LaneResult* results_;
    State state_;
    PairBundle ready_;
    std::size_t next_ = 0, ready_first_ = 0;
    std::uint32_t active_ = 0, apart_ = 0, overlap_ = 0;
};

void SearchCores(std::span<const LaneCores> pairs, LaneGoal goal, LaneResult* results) { Lockstep(pairs, goal, results).run(); }

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(SearchCores);
void search_cores(std::span<const LaneCores> pairs, LaneGoal goal, LaneResult* results) {
    HWY_DYNAMIC_DISPATCH(SearchCores)(pairs, goal, results);
}
}  // namespace carom::detail
#endif
