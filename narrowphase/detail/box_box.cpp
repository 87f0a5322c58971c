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
#include <bit>
#include <cmath>
#include <iterator>
#include <span>
#include <vector>

namespace carom::detail {
namespace {

constexpr std::size_t kBlock = 128;  // pairs worked on at once: 45 kB, what fits into the first cache with the results
constexpr std::size_t kBundles = kBlock / kBundleWidth;

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

void put(FloatBundle* bundles, std::size_t lane, const dvec3& v) noexcept {
    for (int k = 0; k < 3; ++k) bundles[k].lane[lane] = static_cast<float>(v[k]);
}

// In double.
void place_unusual(const ShapePair& pair, BoxPairBundle& bundle, BoxWayBundle& way, std::size_t lane) {
    const dvec3 half_a(as<Box>(*pair.a).half_extents), half_b(as<Box>(*pair.b).half_extents);
    const dmat3 axes = glm::mat3_cast(pair.pose_a.orientation);
    const dmat3 rotation = glm::mat3_cast(glm::conjugate(pair.pose_a.orientation) * pair.pose_b.orientation);
    const dvec3 offset = (pair.pose_b.position - pair.pose_a.position) * axes;
    const double margin = static_cast<double>(pair.margin);
    const BoxPart a = part_near(half_a, offset, glm::length(half_b) + margin);
    const BoxPart b = part_near(half_b, -(offset * rotation), glm::length(half_a) + margin);
    const double unit = unit_for(std::max({a.half.x, a.half.y, a.half.z, b.half.x, b.half.y, b.half.z}));
    const double scale = 1.0 / unit;
    put(bundle.half_a, lane, scale * a.half);
    put(bundle.half_b, lane, scale * b.half);
    put(bundle.offset, lane, scale * ((offset - a.centre) + rotation * b.centre));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) bundle.rotation[i][j].lane[lane] = static_cast<float>(rotation[j][i]);
    }
    bundle.margin.lane[lane] = static_cast<float>(scale * margin);
    put(way.centre, lane, a.centre);
    way.unit.lane[lane] = static_cast<float>(unit);
}

// The way of pairs that are as they are.
void reset_way(BoxWayBundle& way) noexcept {
    std::fill(std::begin(way.unit.lane), std::end(way.unit.lane), 1.0f);
    for (FloatBundle& centre : way.centre) centre = {};
}

// Some pairs, on their way through the kernels.
struct Pairs {
    std::array<BoxNumberBundle, kBundles> numbers{};
    std::array<BoxWayBundle, kBundles> ways{};
    std::array<BoxPairBundle, kBundles> pairs{};
    std::array<BoxAxisBundle, kBundles> axes{};
    std::size_t count = 0;

    [[nodiscard]] std::size_t bundles() const noexcept { return bundle_count(count); }

    void add(std::int32_t pair, std::int32_t a, std::int32_t b, float margin) noexcept {
        const std::size_t bundle = count / kBundleWidth, lane = count % kBundleWidth;
        numbers[bundle].a.lane[lane] = a;
        numbers[bundle].b.lane[lane] = b;
        numbers[bundle].margin.lane[lane] = margin;
        ways[bundle].pair.lane[lane] = pair;
        ++count;
    }
    void place(const BatchInput& input, std::span<const BoxLine> lines) {
        for (std::size_t i = count; i < bundles() * kBundleWidth; ++i) {  // lanes without a pair
            BoxNumberBundle& last = numbers[i / kBundleWidth];
            last.a.lane[i % kBundleWidth] = last.a.lane[0];
            last.b.lane[i % kBundleWidth] = last.b.lane[0];
        }
        std::array<std::uint32_t, kBundles> unusual{};
        place_boxes(lines, {numbers.data(), bundles()}, {pairs.data(), bundles()}, {unusual.data(), bundles()});
        for (std::size_t k = 0; k < bundles(); ++k) {
            reset_way(ways[k]);
            for (std::uint32_t left = unusual[k]; left != 0; left &= left - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(left));
                if (k * kBundleWidth + lane >= count) break;
                place_unusual(input.pair(static_cast<std::uint32_t>(ways[k].pair.lane[lane])), pairs[k], ways[k], lane);
            }
        }
    }
};

struct Block {
    Pairs all, near;
    std::array<BoxLine, 2 * kBlock> lines;
    std::array<std::uint32_t, 2 * kBlock> boxes;
    std::array<BoxPatchBundle, kBundles> patches{};
    ManifoldList corners;                   // of pairs that touch corner to corner
    std::vector<std::uint32_t> corners_to;  // where they go

    // @return the lines of their boxes.
    std::span<const BoxLine> add_pairs(const BatchInput& input, std::span<const std::uint32_t> chosen) {
        const bool own_lines = input.boxes.empty();
        all.count = 0;
        for (const std::uint32_t i : chosen) {
            const NumberedPair& pair = input.pairs[i];
            const auto first = static_cast<std::uint32_t>(2 * all.count);
            boxes[first] = pair.a, boxes[first + 1] = pair.b;
            const std::uint32_t a = own_lines ? first : pair.a, b = own_lines ? first + 1 : pair.b;
            all.add(static_cast<std::int32_t>(i), static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), input.margin(i));
        }
        if (!own_lines) return input.boxes;
        static constexpr auto kPlaces = [] {
            std::array<std::uint32_t, 2 * kBlock> places{};
            for (std::uint32_t k = 0; k < places.size(); ++k) places[k] = k;
            return places;
        }();
        write_box_lines(input.placed, {boxes.data(), 2 * chosen.size()}, {kPlaces.data(), 2 * chosen.size()}, lines);
        return lines;
    }

    void keep_near() noexcept {
        near.count = 0;
        for (std::size_t i = 0; i < all.count; ++i) {  // without a branch a pair: which are apart cannot be foretold
            const std::size_t bundle = i / kBundleWidth, lane = i % kBundleWidth;
            const std::int32_t code = all.axes[bundle].code.lane[lane];
            BoxAxisBundle& axes = near.axes[near.count / kBundleWidth];
            axes.code.lane[near.count % kBundleWidth] = code;
            axes.separation.lane[near.count % kBundleWidth] = all.axes[bundle].separation.lane[lane];
            const BoxNumberBundle& numbers = all.numbers[bundle];
            near.add(all.ways[bundle].pair.lane[lane], numbers.a.lane[lane], numbers.b.lane[lane], numbers.margin.lane[lane]);
            near.count -= code == kApart ? 1 : 0;
        }
    }

    // Says where each manifold goes, `first` and after. @return how many there are.
    std::size_t number_manifolds(const BatchInput& input, std::size_t first, Workspace& workspace) {
        corners.clear();
        corners_to.clear();
        std::size_t next = first;
        for (std::size_t i = 0; i < near.bundles() * kBundleWidth; ++i) {
            const std::size_t bundle = i / kBundleWidth, lane = i % kBundleWidth;
            std::int32_t& to = near.ways[bundle].to.lane[lane];
            to = kNoManifold;
            if (i >= near.count) continue;
            if (patches[bundle].count.lane[lane] > 0) {
                to = static_cast<std::int32_t>(next++);
                continue;
            }
            const auto pair = static_cast<std::uint32_t>(near.ways[bundle].pair.lane[lane]);
            // The axes lie within the margin, but the faces are not over each other: corner to corner or corner to edge. The true
            // distance decides.
            run_pair(input.pair(pair), {box_box_alone, nullptr, false}, pair, workspace, corners);
            if (corners.size() > corners_to.size()) corners_to.push_back(static_cast<std::uint32_t>(next++));
        }
        return next - first;
    }
};

Block& thread_block() {
    thread_local Block block;
    return block;
}

void collide_block(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, Block& work, ManifoldList& out) {
    Pairs& all = work.all;
    Pairs& near = work.near;
    const std::span<const BoxLine> lines = work.add_pairs(input, chosen);
    all.place(input, lines);
    find_box_axes({all.pairs.data(), all.bundles()}, {all.axes.data(), all.bundles()});
    work.keep_near();
    if (near.count == 0) return;
    const std::size_t bundles = near.bundles();
    near.place(input, lines);
    build_box_patches({near.pairs.data(), bundles}, {near.axes.data(), bundles}, {work.patches.data(), bundles});
    const std::size_t first = out.size();
    out.add_unwritten(work.number_manifolds(input, first, workspace));
    write_box_manifolds(lines, {near.numbers.data(), bundles}, {near.ways.data(), bundles}, {near.axes.data(), bundles},
                        {work.patches.data(), bundles}, out.data());
    for (std::size_t k = 0; k < work.corners.size(); ++k) out.data()[work.corners_to[k]] = work.corners[k];
}

}  // namespace

BoxLine box_line(const Box& box, const Pose& pose) noexcept {
    BoxLine line;
    const dmat3 axes = glm::mat3_cast(pose.orientation);
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) line.axis[k][i] = static_cast<float>(axes[k][i]);
        line.axis[k][3] = box.half_extents[k];
    }
    constexpr double kMostDistance = 1e30;  // beyond, differences of positions may leave the range of floats
    bool far = false;
    for (int i = 0; i < 3; ++i) {
        double rest = pose.position[i];
        far |= std::abs(rest) > kMostDistance;
        for (auto& row : line.position) {
            row[i] = far ? 0.0f : static_cast<float>(rest);
            rest -= static_cast<double>(row[i]);
        }
    }
    for (auto& row : line.position) row[3] = 0.0f;
    line.position[0][3] = far ? 1.0f : 0.0f;
    return line;
}

void box_box_single(const ShapePair& pair, std::uint32_t index, Workspace& workspace, ManifoldList& out) {
    Block& work = thread_block();
    BoxNumberBundle& numbers = work.all.numbers[0];
    BoxPairBundle& placed = work.all.pairs[0];
    BoxWayBundle& way = work.all.ways[0];
    BoxAxisBundle& axis = work.all.axes[0];
    const std::array<BoxLine, 2> lines{box_line(as<Box>(*pair.a), pair.pose_a), box_line(as<Box>(*pair.b), pair.pose_b)};
    for (std::size_t lane = 0; lane < kBundleWidth; ++lane) {
        numbers.a.lane[lane] = 0;
        numbers.b.lane[lane] = 1;
        numbers.margin.lane[lane] = pair.margin;
        way.to.lane[lane] = kNoManifold;
    }
    way.pair.lane[0] = static_cast<std::int32_t>(index);
    reset_way(way);
    std::uint32_t unusual = 0;
    place_boxes(lines, {&numbers, 1}, {&placed, 1}, {&unusual, 1}, BoxLanes::First);
    if ((unusual & 1u) != 0) place_unusual(pair, placed, way, 0);
    find_box_axes({&placed, 1}, {&axis, 1}, BoxLanes::First);
    if (axis.code.lane[0] == kApart) return;
    BoxPatchBundle& patch = work.patches[0];
    build_box_patches({&placed, 1}, {&axis, 1}, {&patch, 1}, BoxLanes::First);
    if (patch.count.lane[0] == 0) {
        run_pair(pair, {box_box_alone, nullptr, false}, index, workspace, out);
        return;
    }
    way.to.lane[0] = static_cast<std::int32_t>(out.size());
    out.add_unwritten(1);
    write_box_manifolds(lines, {&numbers, 1}, {&way, 1}, {&axis, 1}, {&patch, 1}, out.data(), BoxLanes::First);
}

void box_box(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out) {
    Block& work = thread_block();
    for (std::size_t begin = 0; begin < chosen.size(); begin += kBlock) {
        collide_block(input, chosen.subspan(begin, std::min(kBlock, chosen.size() - begin)), workspace, work, out);
    }
}

}  // namespace carom::detail
