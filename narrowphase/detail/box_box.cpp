// Box against box, sixteen pairs at a time: fifteen axes, then the points of the faces or the edges that decide.
//
// Everything is wide, but for the few pairs that floats cannot take as they are: those are brought into the frame of the first box in
// double. The pairs that are not apart are gathered before their points are sought, so that no lane works for nothing.
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

namespace carom::detail {
namespace {

constexpr std::size_t kBlock = BoxPairBlock::kPairs;

struct BoxPart {
    dvec3 centre{0.0};
    dvec3 half{0.0};
};

// The part of a box within reach of another whose points lie within `radius` of `other`: cut where the other cannot be. A box of
// like size is left whole, and so is one whose sides are all far from the other, which lies deep inside then.
BoxPart part_near(const dvec3& half, const dvec3& other, double radius) {
    const double reach = 0.5 * static_cast<double>(kUnusualRatio) * radius;
    if (std::max({half.x, half.y, half.z}) <= 2.0 * reach) return {dvec3{0.0}, half};
    const dvec3 inside = half - glm::abs(other);  // how deep the other's centre is below each pair of sides
    // A side this near separates better than any cut: 3 radii of depth at most, against more than 4.
    if (std::min({inside.x, inside.y, inside.z}) > 0.5 * reach) return {dvec3{0.0}, half};
    const dvec3 lower = glm::max(-half, other - reach), upper = glm::min(half, other + reach);
    if (!(lower.x < upper.x && lower.y < upper.y && lower.z < upper.z)) return {dvec3{0.0}, half};  // apart
    return {0.5 * (lower + upper), 0.5 * (upper - lower)};
}

// Lengths are halved or doubled into the middle of the range of floats, so that their squares and areas stay in it.
double unit_for(double size) noexcept {
    const bool usual = size > static_cast<double>(kSmallestUsual) && size < static_cast<double>(kLargestUsual);
    return usual ? 1.0 : std::ldexp(1.0, std::ilogb(size));
}

void put(BoxPairBlock::Column* columns, std::size_t at, const dvec3& v) noexcept {
    for (int k = 0; k < 3; ++k) columns[k][at] = static_cast<float>(v[k]);
}

// In double.
void place_unusual(const ShapePair& pair, BoxPairBlock& block, std::size_t at) {
    const dvec3 half_a(as<Box>(*pair.a).half_extents), half_b(as<Box>(*pair.b).half_extents);
    const dmat3 axes = glm::mat3_cast(pair.pose_a.orientation);
    const dmat3 rotation = glm::mat3_cast(glm::conjugate(pair.pose_a.orientation) * pair.pose_b.orientation);
    const dvec3 offset = (pair.pose_b.position - pair.pose_a.position) * axes;
    const double margin = static_cast<double>(pair.margin);
    const BoxPart a = part_near(half_a, offset, glm::length(half_b) + margin);
    const BoxPart b = part_near(half_b, -(offset * rotation), glm::length(half_a) + margin);
    const double unit = unit_for(std::max({a.half.x, a.half.y, a.half.z, b.half.x, b.half.y, b.half.z}));
    const double scale = 1.0 / unit;
    put(block.half_a, at, scale * a.half);
    put(block.half_b, at, scale * b.half);
    put(block.offset, at, scale * ((offset - a.centre) + rotation * b.centre));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) block.rotation[i][j][at] = static_cast<float>(rotation[j][i]);
    }
    block.margin[at] = static_cast<float>(scale * margin);
    put(block.centre, at, a.centre);
    block.unit[at] = static_cast<float>(unit);
}

// Some pairs, on their way through the kernels. Their manifolds have a place each, in the order of the pairs, before it is known whether
// there is one.
struct Work {
    BoxesNear near;
    BoxPatchBundle patch{};
    IntBundle to{};
    ManifoldList corner;    // of a pair that touches corner to corner
    bool any_hole = false;  // a place of no manifold: one without points

    Work() { clear_ways_of(near.faces), clear_ways_of(near.edges); }
    static void clear_ways_of(BoxPairBlock& block) noexcept {
        for (BoxPairBlock::Column& centre : block.centre) std::fill(std::begin(centre), std::end(centre), 0.0f);
        std::fill(std::begin(block.unit), std::end(block.unit), 1.0f);
    }

    // Pairs that float cannot take as they are.
    void place_all_unusual(const BatchInput& input, BoxLanes lanes) {
        BoxPairBlock& block = near.faces;
        for (std::size_t bundle = 0; bundle < bundle_count(block.count); ++bundle) {
            bool any = false;
            for (std::size_t i = bundle * kBundleWidth; i < std::min(block.count, (bundle + 1) * kBundleWidth); ++i) {
                if (block.unusual[i] == 0) continue;
                const ShapePair pair = input.pair(static_cast<std::uint32_t>(block.pair[i]));
                if (is_finite(pair.pose_a) && is_finite(pair.pose_b)) {
                    place_unusual(pair, block, i);
                } else {  // refused once all is done: apart until then
                    put(block.offset, i, dvec3(std::numeric_limits<double>::quiet_NaN()));
                    near.all_finite = false;
                }
                any = true;
            }
            if (any) find_box_axes(block, bundle, lanes);
        }
    }

    // What a call is about: manifolds go to `out` from place `first` on.
    struct Call {
        const BatchInput& input;
        Workspace& workspace;
        ManifoldList& out;
        std::size_t first;
        BoxLanes lanes;
    };

    // Says which places the manifolds of a bundle go to, and fills those that need more than lanes.
    void assign_places(const Call& call, const BoxPairBlock& block, std::size_t bundle) {
        for (std::size_t lane = 0; lane < kBundleWidth; ++lane) {
            const std::size_t i = bundle * kBundleWidth + lane;
            const bool is_near = i < block.count && block.code[i] != kApart, is_patch = is_near && patch.count.lane[lane] > 0;
            to.lane[lane] = is_patch ? static_cast<std::int32_t>(call.first) + block.place[i] : kNoManifold;
            if (is_patch || i >= block.count) continue;
            const std::size_t place = call.first + static_cast<std::size_t>(block.place[i]);
            // The axes lie within the margin, but what is nearest along them is no point of both: corner to corner, corner to edge, or a
            // corner beside a face. The true distance decides.
            corner.clear();
            const auto pair = static_cast<std::uint32_t>(block.pair[i]);
            if (is_near) run_pair(call.input.pair(pair), {box_box_alone, nullptr, false}, pair, call.workspace, corner);
            if (corner.size() > 0) {
                call.out.data()[place] = corner[0];
            } else {
                call.out.data()[place].count = 0;
                any_hole = true;
            }
        }
    }

    // Of full bundles of a block, or of all that it has: what waits besides stays.
    // @param build, write  the kernels of its kind of pairs.
    void finish(BoxPairBlock& block, bool all, decltype(build_box_patch)& build, decltype(write_box_manifolds)& write, const Call& call) {
        const std::size_t bundles = all ? bundle_count(block.count) : block.count / kBundleWidth;
        for (std::size_t bundle = 0; bundle < bundles; ++bundle) {
            build(block, bundle, patch, call.lanes);
            assign_places(call, block, bundle);
            write(block, bundle, patch, to, call.out.data(), call.lanes);
        }
        block.drop_before(bundles);
    }

    // Pairs that are boxes all. Those near that fill no bundle wait for what comes after. @return whether the poses are known to be finite.
    bool collide(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out, BoxLanes lanes) {
        const Call call{input, workspace, out, out.size(), lanes};
        near.faces.count = near.edges.count = 0;
        near.listed = 0;
        near.faces.steady = input.placed.steady;
        near.all_finite = true;
        any_hole = false;
        for (std::size_t begin = 0; begin < chosen.size(); begin += kBlock) {
            const std::size_t end = std::min(begin + kBlock, chosen.size());
            if (std::exchange(near.faces.any_unusual, false)) clear_ways_of(near.faces);  // of the block before, maybe of a call that threw
            find_near_boxes(input, chosen.subspan(begin, end - begin), near, lanes);
            if (near.faces.any_unusual) place_all_unusual(input, lanes);
            out.add_unwritten(call.first + static_cast<std::size_t>(near.listed) - out.size());
            const bool last = end == chosen.size();
            // Unusual pairs do not wait: they would take their ways with them.
            finish(near.faces, last || near.faces.any_unusual, build_box_patch, write_box_manifolds, call);
            finish(near.edges, last, build_edge_patch, write_edge_manifolds, call);
        }
        if (any_hole) close_holes(call.first, out);
        return near.all_finite;
    }

    static void close_holes(std::size_t first, ManifoldList& out) {
        std::size_t next = first;
        for (std::size_t from = first; from < out.size(); ++from) {
            if (out[from].count > 0) out.data()[next++] = out[from];
        }
        out.shorten(next);
    }
};

Work& thread_work() {
    thread_local Work work;
    return work;
}

}  // namespace

void BoxPairBlock::drop_before(std::size_t first) noexcept {
    if (first == 0) return;
    if (first * kBundleWidth >= count) {
        count = 0;
        return;
    }
    const auto drop = [from = first * kBundleWidth](auto& column) { std::memcpy(column, column + from, kBundleWidth * sizeof(column[0])); };
    const auto drop_three = [&](Column(&columns)[3]) { drop(columns[0]), drop(columns[1]), drop(columns[2]); };
    drop_three(half_a), drop_three(half_b), drop_three(offset), drop(margin), drop(separation), drop(code), drop(pair), drop(place);
    for (int i = 0; i < 3; ++i) drop_three(rotation[i]), drop_three(axis_a[i]);
    count -= first * kBundleWidth;
}

void box_box_single(const ShapePair& pair, std::uint32_t index, Workspace& workspace, ManifoldList& out) {
    const std::array<const Shape*, 2> shapes{pair.a, pair.b};
    const std::array<Pose, 2> poses{pair.pose_a, pair.pose_b};
    const NumberedPair numbered{.a = 0, .b = 1, .margin = pair.margin};
    const std::uint32_t first = 0;
    const std::size_t before = out.size();
    thread_work().collide({.placed = {shapes, poses, pair.steady}, .pairs = {&numbered, 1}}, {&first, 1}, workspace, out, BoxLanes::First);
    if (out.size() > before) out.data()[before].pair = index;
}

void box_box(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out) {
    box_box_proving(input, chosen, workspace, out);
}
bool box_box_proving(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out) {
    return thread_work().collide(input, chosen, workspace, out, BoxLanes::All);
}

}  // namespace carom::detail
