#include <carom/collision/ray_cast.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/detail/mesh_side.hpp>
#include <carom/narrowphase/detail/shape_way_out.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

// Directions that are looked at, triangles that they are taken from, and motions that are tried, shortest first.
constexpr std::size_t kMostDirections = 256;
constexpr std::size_t kMostTriangles = 1024;
constexpr std::size_t kMostTries = 24;

// What a search may take, a triangle held against a direction as the unit, and what a triangle takes that is held against the shape: a millisecond or
// so. What is met by more triangles than that is left to them, however deep.
constexpr std::size_t kMostWork = 50'000, kWorkOfAxis = 16;

// Times that a motion is made longer for what is met on the way.
constexpr int kMostStretches = 6;

// Patches lead out where no more than this share of what counts as deep is left: they are those of triangles, which curve away.
constexpr double kLeft = 0.5;

// Rounds in which motions along several normals are put together, and in which a point common to a triangle and a box is looked for.
constexpr int kRounds = 8;

// Faces that look away from each other by more than this are two sides of a thin part.
constexpr double kAway = -0.5;

// Another way has to be shorter by this, so that it is not taken in one step and left in the next; and where the patches do not lead out, but hold the
// shape from several sides, it may be so many times as long, or as long as the shape is thin.
constexpr double kShorter = 0.9;
constexpr double kLonger = 4.0;

// What is not as thick as this many times the shape's least extent is no room for it, but a thin part.
constexpr double kThinPart = 1.5;

// What is longer than this many times its least extent is long.
constexpr double kLong = 4.0;

double depth_of(const Patch& patch) noexcept {
    double least = patch.points[0].separation;
    for (int i = 1; i < patch.count; ++i) least = std::min(least, patch.points[static_cast<std::size_t>(i)].separation);
    return least;
}

// The motion by which all patches are led out, each along its own normal.
dvec3 motion_of(const std::vector<TrianglePatch>& patches, double tolerance) {
    dvec3 motion{0.0};
    for (int round = 0; round < kRounds; ++round) {
        for (const TrianglePatch& p : patches) {
            const double left = depth_of(p.patch) - tolerance - glm::dot(motion, p.patch.normal);
            if (left < 0.0) motion += left * p.patch.normal;
        }
    }
    return motion;
}

Corners moved(const Corners& corners, const dvec3& motion) noexcept {
    return {corners[0] + motion, corners[1] + motion, corners[2] + motion};
}

// The surface where it is nearest to the point, in the mesh's frame.
std::optional<SurfacePoint> surface_at(const TriangleMesh& mesh, const dvec3& p) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    MeshSide side;
    side.set(mesh, dmat3{1.0}, dvec3{0.0}, {p, kAny});  // to what is large a mesh has its winding's side
    return side.measure(p, kAny);
}

bool is_in_front(const TriangleMesh& mesh, const dvec3& p) {
    const std::optional<SurfacePoint> surface = surface_at(mesh, p);
    return !surface || surface->separation >= 0.0;
}

}  // namespace

bool ShapeWayOut::spend(std::size_t work) noexcept {
    work_left_ -= std::min(work, work_left_);
    return work_left_ > 0;
}

bool ShapeWayOut::meet(const PairFrame& pair, const Aabb& bounds, const DeepShape& shape, const dvec3& motion) {
    const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second);
    const dvec3 in_mesh = motion * pair.rotation;
    met_.clear();
    mesh.overlap({bounds.lower + in_mesh, bounds.upper + in_mesh}, [&](std::uint32_t index) {
        if (!spend(kWorkOfAxis)) return false;
        const std::array<vec3, 3> c = mesh.corners(index);
        Met met{{pair.to_first(dvec3(c[0])), pair.to_first(dvec3(c[1])), pair.to_first(dvec3(c[2]))}, {}, {}};
        met.corners = moved(met.corners, -motion);
        if (!shape.meets(met.corners, met.axis)) return true;
        const dvec3 n = glm::cross(met.corners[1] - met.corners[0], met.corners[2] - met.corners[0]);
        met.face = n / glm::length(n);
        met_.push_back(met);
        return true;
    });
    return work_left_ > 0;
}

bool ShapeWayOut::looks_both_ways() noexcept {
    for (std::size_t i = 1; i < met_.size() && spend(i / 4 + 1); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if (glm::dot(met_[i].face, met_[k].face) < kAway) return true;
        }
    }
    return false;
}

// How far along the motion the shape leaves the triangle at the latest: by the axis of least overlap, by the triangle's plane, or behind it.
double ShapeWayOut::leaving(const Met& met, const dvec3& along, const DeepShape& shape) const {
    const double highest = std::max({glm::dot(along, met.corners[0]), glm::dot(along, met.corners[1]), glm::dot(along, met.corners[2])});
    double length = highest + shape.reach(-along);
    const double slope = -glm::dot(along, met.axis.normal);
    if (slope > kLeastSlope) length = std::min(length, -met.axis.separation / slope);
    const double up = glm::dot(along, met.face);
    if (std::abs(up) > kLeastSlope) {
        const dvec3 out = up > 0.0 ? met.face : -met.face;
        length = std::min(length, (glm::dot(out, met.corners[0]) + shape.reach(-out)) / std::abs(up));
    }
    return length;
}

void ShapeWayOut::offer(const dvec3& along, double most, const DeepShape& shape) {
    const double length = glm::length(along);
    if (tries_.size() >= kMostDirections || !(length > 0.0)) return;
    Try way{along / length, 0.0};
    if (std::ranges::any_of(tries_, [&](const Try& t) { return glm::dot(t.along, way.along) > kSquareCosine; })) return;
    for (const Met& met : first_met_) {
        way.length = std::max(way.length, leaving(met, way.along, shape));
        if (!spend(1) || way.length >= most) return;
    }
    tries_.push_back(way);
}

void ShapeWayOut::collect_ways(const PairFrame& pair, const Aabb& bounds, double most, const DeepShape& shape) {
    tries_.clear();
    for (const Met& met : first_met_) {
        offer(-met.axis.normal, most, shape);
        offer(met.face, most, shape);
        offer(-met.face, most, shape);
    }
    const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second);
    for (const bool edges : {false, true}) {
        std::size_t left = kMostTriangles;
        mesh.overlap(inflate(bounds, most), [&](std::uint32_t index) {
            const std::array<vec3, 3> c = mesh.corners(index);
            const Corners t{pair.to_first(dvec3(c[0])), pair.to_first(dvec3(c[1])), pair.to_first(dvec3(c[2]))};
            if (!edges) offer(glm::cross(t[1] - t[0], t[2] - t[0]), most, shape);
            for (std::size_t k = 0; edges && k < 9; ++k) {
                dvec3 axis{0.0};
                axis[static_cast<glm::length_t>(k / 3)] = 1.0;
                const dvec3 across = glm::cross(t[(k + 1) % 3] - t[k % 3], axis);
                offer(across, most, shape);
                offer(-across, most, shape);
            }
            return --left > 0 && work_left_ > 0;
        });
    }
}

std::optional<double> ShapeWayOut::length_of(const PairFrame& pair, const Aabb& bounds, const DeepShape& shape, const Try& way,
                                             double most) {
    double length = way.length;
    for (int k = 0; k < kMostStretches && length < most; ++k) {
        if (!meet(pair, bounds, shape, length * way.along)) return std::nullopt;
        if (met_.empty()) return length;
        double more = 0.0;
        for (const Met& met : met_) more = std::max(more, leaving(met, way.along, shape));
        length += std::max(more, shape.tolerance);
    }
    return std::nullopt;
}

// Whether the shape's centre may go to the outside: it is there, or in a part of the solid that is thinner than the shape.
bool ShapeWayOut::belongs_outside(const PairFrame& pair, const DeepShape& shape) {
    const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second);
    const std::optional<SurfacePoint> surface = surface_at(mesh, pair.to_second(shape.centre));
    if (!surface || surface->separation >= 0.0) return true;
    return mesh.is_closed() && is_in_front(mesh, surface->point - kThinPart * shape.thin * surface->outward);
}

// Whether the centre comes to the side where it belongs, and not through a wall from one room to the other, unless the shape is long: of a rod in a wall the
// centre says little of where it came from.
bool ShapeWayOut::may_go(const PairFrame& pair, const DeepShape& shape, const dvec3& motion, bool outside) {
    const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second);
    const dvec3 from = pair.to_second(shape.centre), to = pair.to_second(shape.centre + motion);
    if (is_in_front(mesh, to) != outside) return false;
    const double length = glm::length(to - from);
    const dvec3 extent = shape.own.upper - shape.own.lower;
    if (std::max({extent.x, extent.y, extent.z}) > kLong * shape.thin || is_in_front(mesh, from) != outside) return true;
    return !cast_ray(pair.second, {.origin = from, .direction = (to - from) / length, .max_distance = length});
}

// Points of both, each found by turns in the triangle and in the shape's box, and their mean.
dvec3 ShapeWayOut::middle_of(const DeepShape& shape) const noexcept {
    dvec3 sum{0.0};
    for (const Met& met : first_met_) {
        dvec3 p{0.0};
        for (int k = 0; k < kRounds; ++k) p = glm::clamp(closest_on_triangle(met.corners, p).point, shape.own.lower, shape.own.upper);
        sum += p;
    }
    return sum / static_cast<double>(first_met_.size());
}

ShapeWayOut::Verdict ShapeWayOut::find(const PairFrame& pair, const Aabb& bounds, const MeshSurface& surface, const DeepShape& shape,
                                       Way& way) {
    const bool is_deep = std::ranges::any_of(surface.patches, [&](const TrianglePatch& p) { return depth_of(p.patch) < -shape.deep; });
    if (!is_deep) return Verdict::Right;
    work_left_ = kMostWork;
    const dvec3 said = motion_of(surface.patches, shape.tolerance);
    if (!meet(pair, bounds, shape, said)) return Verdict::Right;
    const bool leads_out = std::ranges::none_of(met_, [&](const Met& met) { return met.axis.separation < -kLeft * shape.deep; });
    if (!meet(pair, bounds, shape, dvec3{0.0}) || met_.empty() || (leads_out && !looks_both_ways())) return Verdict::Right;
    first_met_.swap(met_);
    const double length = glm::length(said);
    double most = leads_out ? kShorter * length : std::max(kLonger * length, shape.thin);
    collect_ways(pair, bounds, most, shape);
    const bool outside = belongs_outside(pair, shape);
    bool found = false;
    for (std::size_t k = 0; k < kMostTries && !tries_.empty(); ++k) {
        const auto shortest = std::ranges::min_element(tries_, {}, &Try::length);
        if (!(shortest->length < most)) break;
        const Try next = *shortest;
        tries_.erase(shortest);
        const std::optional<double> depth = length_of(pair, bounds, shape, next, most);
        if (!depth || !may_go(pair, shape, *depth * next.along, outside)) continue;
        found = true;
        most = *depth;
        way = {-next.along, *depth, middle_of(shape)};
    }
    if (found) return Verdict::Other;
    return leads_out ? Verdict::Right : Verdict::None;
}

}  // namespace carom::detail
