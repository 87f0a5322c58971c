// Box against box, sixteen pairs at a time: fifteen axes, then the points of the faces or the edges that decide.
//
// Each pair is brought into the frame of its first box in double and rounded to float there; from the axes on everything is wide. The
// pairs that are not apart are gathered before their points are sought, so that no lane works for nothing.
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace carom::detail {
namespace {

constexpr std::size_t kBlock = 128;  // pairs worked on at once: 40 kB, what fits into the first cache with the results
constexpr std::size_t kBundles = kBlock / kBundleWidth;

// What the way back to the world needs of a pair, in double.
struct Placement {
    dmat3 axes{1.0};         // of A, in the world
    dvec3 centre{0.0};       // of the part of A that was worked on, in A's frame
    double unit = 1.0;       // metres of a unit of the bundles, a power of two
    std::uint32_t pair = 0;  // in the batch
};

struct BoxPart {
    dvec3 centre{0.0};
    dvec3 half{0.0};
};

// The part of a box within reach of another whose points lie within `radius` of `other`: cut where the other cannot be. A box of
// like size is left whole, and so is one whose sides are all far from the other, which lies deep inside then.
BoxPart part_near(const dvec3& half, const dvec3& other, double radius) {
    const double reach = 4.0 * radius;
    if (std::max({half.x, half.y, half.z}) <= 2.0 * reach) return {dvec3{0.0}, half};
    const dvec3 inside = half - glm::abs(other);  // how deep the other's centre is below each pair of sides
    // A side this near separates better than any cut: 3 radii of depth at most, against more than 4.
    if (std::min({inside.x, inside.y, inside.z}) > 0.5 * reach) return {dvec3{0.0}, half};
    const dvec3 lower = glm::max(-half, other - reach), upper = glm::min(half, other + reach);
    if (!(lower.x < upper.x && lower.y < upper.y && lower.z < upper.z)) return {dvec3{0.0}, half};  // apart
    return {0.5 * (lower + upper), 0.5 * (upper - lower)};
}

// Lengths are halved or doubled into the middle of the range of floats, so that their squares and areas stay in it.
double unit_for(double size) noexcept { return size > 0x1p-20 && size < 0x1p20 ? 1.0 : std::ldexp(1.0, std::ilogb(size)); }

void put(FloatBundle* bundles, std::size_t lane, const dvec3& v) noexcept {
    for (int k = 0; k < 3; ++k) bundles[k].lane[lane] = static_cast<float>(v[k]);
}

Placement place_pair(const ShapePair& pair, std::uint32_t index, BoxPairBundle& bundle, std::size_t lane) {
    const dvec3 half_a(as<Box>(*pair.a).half_extents), half_b(as<Box>(*pair.b).half_extents);
    Placement place;
    place.axes = glm::mat3_cast(pair.pose_a.orientation);
    place.pair = index;
    const dmat3 rotation = glm::mat3_cast(glm::conjugate(pair.pose_a.orientation) * pair.pose_b.orientation);
    const dvec3 offset = (pair.pose_b.position - pair.pose_a.position) * place.axes;
    const double margin = static_cast<double>(pair.margin);
    const BoxPart a = part_near(half_a, offset, glm::length(half_b) + margin);
    const BoxPart b = part_near(half_b, -(offset * rotation), glm::length(half_a) + margin);
    place.centre = a.centre;
    place.unit = unit_for(std::max({a.half.x, a.half.y, a.half.z, b.half.x, b.half.y, b.half.z}));
    const double scale = 1.0 / place.unit;
    put(bundle.half_a, lane, scale * a.half);
    put(bundle.half_b, lane, scale * b.half);
    put(bundle.offset, lane, scale * ((offset - a.centre) + rotation * b.centre));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) bundle.rotation[i][j].lane[lane] = static_cast<float>(rotation[j][i]);
    }
    bundle.margin.lane[lane] = static_cast<float>(scale * margin);
    return place;
}

// Bit k of a corner is set on the positive side of axis k; an edge is 4 * axis + the signs of the next two.
std::uint32_t edge_number(int axis, std::uint32_t corner) noexcept {
    return 4u * static_cast<std::uint32_t>(axis) + ((corner >> ((axis + 1) % 3)) & 1u) + 2u * ((corner >> ((axis + 2) % 3)) & 1u);
}

// The names of features of one face, from its axis and the normal that leaves it.
class FaceNames {
public:
    FaceNames(int axis, const float (&normal)[3]) noexcept : axis_(axis) {
        for (std::uint32_t k = 0; k < 3; ++k) toward_ |= normal[k] < 0.0f ? 0u : 1u << k;
    }
    // Corner 0..3, which run (+,+), (-,+), (-,-), (+,-).
    [[nodiscard]] std::uint32_t corner(int k) const noexcept {
        return (toward_ & (1u << axis_)) | (k == 0 || k == 3 ? 1u << p() : 0u) | (k < 2 ? 1u << q() : 0u);
    }
    // From corner k to k + 1.
    [[nodiscard]] std::uint32_t edge(int k) const noexcept { return edge_number(k % 2 == 0 ? p() : q(), corner(k)); }
    // On the side p+, p-, q+, q-: the edges 3, 1, 0 and 2.
    [[nodiscard]] std::uint32_t side(int s) const noexcept {
        constexpr int kEdgeOfSide[4] = {3, 1, 0, 2};
        return edge(kEdgeOfSide[s]);
    }
    // The edge along `axis` that is farthest along the normal.
    [[nodiscard]] std::uint32_t leading_edge(int axis) const noexcept { return edge_number(axis, toward_); }

private:
    [[nodiscard]] int p() const noexcept { return (axis_ + 1) % 3; }
    [[nodiscard]] int q() const noexcept { return (axis_ + 2) % 3; }
    int axis_;
    std::uint32_t toward_ = 0;
};

// Names a point after a corner of B, or else of A, that it lies at; otherwise after the two edges. `plain` leaves the corners out.
std::uint64_t name_of(const BoxPatchBundle::Point& point, std::size_t lane, const FaceNames& a, const FaceNames& b, int axis_code, bool plain) {
    const int candidate = point.candidate.lane[lane];
    const int corner_a = candidate >= kCornerOfA && candidate < kCrossing ? candidate - kCornerOfA : (plain ? -1 : point.corner_a.lane[lane]);
    const int corner_b = candidate < kCornerOfA ? candidate : (plain ? -1 : point.corner_b.lane[lane]);
    if (corner_b >= 0) return feature_name(FeatureKind::VertexOfSecond, 0, b.corner(corner_b));
    if (corner_a >= 0) return feature_name(FeatureKind::VertexOfFirst, a.corner(corner_a), 0);
    if (candidate == kEdges) {
        const int edges = axis_code - kFirstEdge;
        return feature_name(FeatureKind::Edges, a.leading_edge(edges / 3), b.leading_edge(edges % 3));
    }
    const int crossing = candidate - kCrossing;
    return feature_name(FeatureKind::Edges, a.side(crossing / 4), b.edge(crossing % 4));
}

void write_manifold(const BoxPatchBundle& patch, std::size_t lane, int axis_code, const Placement& place, std::vector<Manifold>& out) {
    Manifold& m = out.emplace_back();
    m.pair = place.pair;
    m.count = static_cast<std::uint32_t>(patch.count.lane[lane]);
    const float normal[3] = {patch.normal[0].lane[lane], patch.normal[1].lane[lane], patch.normal[2].lane[lane]};
    const float against_b[3] = {-patch.normal_b[0].lane[lane], -patch.normal_b[1].lane[lane], -patch.normal_b[2].lane[lane]};
    m.normal = vec3(place.axes * dvec3(normal[0], normal[1], normal[2]));
    const FaceNames a(patch.face_a.lane[lane], normal), b(patch.face_b.lane[lane], against_b);
    for (std::uint32_t k = 0; k < m.count; ++k) {
        const BoxPatchBundle::Point& from = patch.points[k];
        const dvec3 local{from.position[0].lane[lane], from.position[1].lane[lane], from.position[2].lane[lane]};
        std::uint64_t name = name_of(from, lane, a, b, axis_code, false);
        for (std::uint32_t i = 0; i < k; ++i) {
            if (m.points[i].feature == name) name = name_of(from, lane, a, b, axis_code, true);
        }
        m.points[k] = {vec3(place.axes * (place.unit * local + place.centre)),
                       static_cast<float>(place.unit * static_cast<double>(from.separation.lane[lane])), name};
    }
}

void copy_lane(const BoxPairBundle& from, std::size_t lane, BoxPairBundle& to, std::size_t to_lane) noexcept {
    static_assert(sizeof(BoxPairBundle) % sizeof(FloatBundle) == 0);
    constexpr std::size_t kRows = sizeof(BoxPairBundle) / sizeof(FloatBundle);
    const auto* source = reinterpret_cast<const FloatBundle*>(&from);
    auto* target = reinterpret_cast<FloatBundle*>(&to);
    for (std::size_t row = 0; row < kRows; ++row) target[row].lane[to_lane] = source[row].lane[lane];
}

// The axes lie within the margin, but the faces are not over each other: corner to corner or corner to edge. The true distance
// decides.
CollideStatus touch_corners(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents), dmat3{1.0}, dvec3{0.0});
    load_box(workspace.second, dvec3(as<Box>(pair.second).half_extents), pair.rotation, pair.translation);
    const GjkResult distance = gjk(workspace.first.vertices, workspace.second.vertices, pair.margin);
    ContactAxis axis;
    if (distance.beyond || !find_axis(workspace.first, workspace.second, distance, pair.margin, workspace.edges, axis)) return CollideStatus::Ok;
    Patch patch;
    build_patch(workspace.first, workspace.second, axis, pair.margin, AxisPoint::Keep, workspace.polygons, patch);
    sink.add(patch);
    return CollideStatus::Ok;
}

// One block of pairs on its way through the kernels.
struct Block {
    std::array<BoxPairBundle, kBundles> pairs{};
    std::array<BoxAxisBundle, kBundles> axes{};
    std::array<BoxPatchBundle, kBundles> patches{};
    std::array<Placement, kBlock> places;

    // Moves the pairs that are not apart to the front. @return how many.
    std::size_t keep_near(std::size_t count) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t from = i / kBundleWidth, lane = i % kBundleWidth;
            const std::int32_t code = axes[from].code.lane[lane];
            if (code == kApart) continue;
            const std::size_t to = kept / kBundleWidth, to_lane = kept % kBundleWidth;
            if (kept != i) {
                copy_lane(pairs[from], lane, pairs[to], to_lane);
                axes[to].separation.lane[to_lane] = axes[from].separation.lane[lane];
                axes[to].code.lane[to_lane] = code;
                places[kept] = places[i];
            }
            ++kept;
        }
        return kept;
    }
};

// Lanes that a block leaves alone keep what they held before, which no other lane sees.
Block& thread_block() {
    thread_local Block block;
    return block;
}

void collide_block(std::span<const ShapePair> all, std::span<const std::uint32_t> block, Workspace& workspace, Block& work,
                   std::vector<Manifold>& out) {
    for (std::size_t i = 0; i < block.size(); ++i) {
        work.places[i] = place_pair(all[block[i]], block[i], work.pairs[i / kBundleWidth], i % kBundleWidth);
    }
    const std::size_t bundles = bundle_count(block.size());
    find_box_axes({work.pairs.data(), bundles}, {work.axes.data(), bundles});
    const std::size_t near = work.keep_near(block.size());
    const std::size_t near_bundles = bundle_count(near);
    build_box_patches({work.pairs.data(), near_bundles}, {work.axes.data(), near_bundles}, {work.patches.data(), near_bundles});
    for (std::size_t i = 0; i < near; ++i) {
        const std::size_t bundle = i / kBundleWidth, lane = i % kBundleWidth;
        const Placement& place = work.places[i];
        if (work.patches[bundle].count.lane[lane] > 0) {
            write_manifold(work.patches[bundle], lane, work.axes[bundle].code.lane[lane], place, out);
        } else {
            run_pair(all[place.pair], {touch_corners, nullptr, false}, place.pair, workspace, out);
        }
    }
}

}  // namespace

void box_box(std::span<const ShapePair> all, std::span<const std::uint32_t> chosen, Workspace& workspace, std::vector<Manifold>& out) {
    Block& work = thread_block();
    for (std::size_t begin = 0; begin < chosen.size(); begin += kBlock) {
        collide_block(all, chosen.subspan(begin, std::min(kBlock, chosen.size() - begin)), workspace, work, out);
    }
}

}  // namespace carom::detail
