#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/mesh_surface.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

double depth_of(const Patch& patch) noexcept {
    double least = patch.points[0].separation;
    for (int i = 1; i < patch.count; ++i) least = std::min(least, patch.points[static_cast<std::size_t>(i)].separation);
    return least;
}

// A point and what counts as at it.
struct Place {
    dvec3 p{0.0}, lower{0.0}, upper{0.0};
    double tolerance_sq = 0.0;

    Place(const dvec3& point, double tolerance) noexcept
        : p(point), lower(point - dvec3{tolerance}), upper(point + dvec3{tolerance}), tolerance_sq(tolerance * tolerance) {}
    [[nodiscard]] bool is_on(const NearTriangle& t) const noexcept {
        if (t.lower.x > upper.x || t.lower.y > upper.y || t.lower.z > upper.z || t.upper.x < lower.x || t.upper.y < lower.y ||
            t.upper.z < lower.z) {
            return false;
        }
        const dvec3 gap = closest_on_triangle(t.corners, p).point - p;
        return glm::dot(gap, gap) <= tolerance_sq;
    }
};

void place(const PairFrame& pair, const TriangleMesh& mesh, std::uint32_t index, NearTriangle& t) noexcept {
    const std::array<vec3, 3> corners = mesh.corners(index);
    t.index = index;
    for (std::size_t k = 0; k < 3; ++k) t.corners[k] = pair.to_first(dvec3(corners[k]));
    t.lower = glm::min(glm::min(t.corners[0], t.corners[1]), t.corners[2]);
    t.upper = glm::max(glm::max(t.corners[0], t.corners[1]), t.corners[2]);
}

// Whether the triangle reaches beyond `p`, its own point, along the unit vector `outward`.
bool rises(const NearTriangle& t, const dvec3& p, const dvec3& outward, double tolerance) noexcept {
    return std::ranges::any_of(t.corners, [&](const dvec3& corner) {
        const dvec3 d = corner - p;
        const double rise = glm::dot(outward, d) - tolerance;
        return rise > 0.0 && rise * rise > kRidgeSine * kRidgeSine * glm::dot(d, d);
    });
}

}  // namespace

void MeshSurface::gather(const PairFrame& pair, const Aabb& bounds) {
    const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second);
    pair_ = &pair;
    mesh_ = &mesh;
    gathered_ = bounds;
    triangles.clear();
    patches.clear();
    in_front_.reset();
    foot_.reset();
    mesh.overlap(bounds, [&](std::uint32_t index) {
        place(pair, mesh, index, triangles.emplace_back());
        return true;
    });
}

// Among so many triangles the mesh's hierarchy finds those at a point sooner than a look at all of them.
constexpr std::size_t kManyTriangles = 64;

// A contact may be beside the shape's box, where a neighbour was not gathered: it is looked for in the mesh then.
template <class Test>
bool MeshSurface::any_at(const dvec3& p, double tolerance, const Test& test) const {
    const dvec3 own = pair_->to_second(p), reach{tolerance};
    const bool is_inside =
        glm::all(glm::lessThanEqual(gathered_.lower, own - reach)) && glm::all(glm::lessThanEqual(own + reach, gathered_.upper));
    const Place at(p, tolerance);
    if (is_inside && triangles.size() <= kManyTriangles) {
        for (const NearTriangle& t : triangles) {
            if (at.is_on(t) && test(t)) return true;
        }
        return false;
    }
    bool found = false;
    mesh_->overlap({own - reach, own + reach}, [&](std::uint32_t index) {
        NearTriangle t;
        place(*pair_, *mesh_, index, t);
        found = at.is_on(t) && test(t);
        return !found;
    });
    return found;
}

bool MeshSurface::allows(const dvec3& p, const dvec3& outward, double tolerance) const {
    return !any_at(p, tolerance, [&](const NearTriangle& t) { return rises(t, p, outward, tolerance); });
}

bool MeshSurface::is_in_front(const dvec3& p) noexcept {
    if (!in_front_) in_front_ = height_of(p) >= 0.0;
    return *in_front_;
}

// Signed distance to the plane of the triangle that decides.
double MeshSurface::height_of(const dvec3& p) const noexcept {
    double nearest = std::numeric_limits<double>::infinity(), height = 0.0;
    for (const NearTriangle& t : triangles) {
        const dvec3 gap = p - closest_on_triangle(t.corners, p).point;
        const double distance = std::sqrt(glm::dot(gap, gap));
        if (distance > nearest * (1.0 + kPointTolerance)) continue;
        const dvec3 n = glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
        const double area = std::sqrt(glm::dot(n, n));
        if (!(area > 0.0)) continue;
        const double over = glm::dot(n, p - t.corners[0]) / area;
        if (distance < nearest * (1.0 - kPointTolerance) || std::abs(over) > std::abs(height)) height = over;
        nearest = std::min(nearest, distance);
    }
    return height;
}

MeshSurface::Foot MeshSurface::foot_at(const dvec3& p, double tolerance) {
    const auto is_known = [&] {
        const dvec3 gap = p - *foot_;
        return glm::dot(gap, gap) <= tolerance * tolerance;
    };
    if (foot_ && is_known()) return passes_foot_ ? Foot::Known : Foot::None;
    foot_ = p;
    passes_foot_ = any_at(p, tolerance, [](const NearTriangle&) { return true; });
    return passes_foot_ ? Foot::New : Foot::None;
}

// Whether the contact, of that depth, leads the shape out of the triangle that the stand-in is for as well, and not as far.
bool spares(const TrianglePatch& contact, double depth, const TrianglePatch& stand_in, double tolerance) noexcept {
    return depth_of(stand_in.patch) < -depth - tolerance &&
           stand_in.along + depth * glm::dot(stand_in.way, contact.patch.normal) >= -tolerance;
}

void MeshSurface::drop_runaways(double tolerance) noexcept {
    const TrianglePatch* allowed = nullptr;  // the deepest
    for (const TrianglePatch& p : patches) {
        if (!p.replaced && (allowed == nullptr || depth_of(p.patch) < depth_of(allowed->patch))) allowed = &p;
    }
    if (allowed != nullptr && depth_of(allowed->patch) < 0.0) {
        const TrianglePatch contact = *allowed;
        std::erase_if(patches,
                      [&](const TrianglePatch& p) { return p.replaced && spares(contact, -depth_of(contact.patch), p, tolerance); });
    }
    double deepest = 0.0;
    const auto stands = [](const TrianglePatch& p) { return !p.replaced || p.holds_deepest; };
    for (const TrianglePatch& p : patches) {
        if (stands(p)) deepest = std::min(deepest, depth_of(p.patch));
    }
    if (deepest < 0.0) std::erase_if(patches, [&](const TrianglePatch& p) { return !stands(p) && depth_of(p.patch) < 2.0 * deepest; });
}

// Of the triangle with the deepest patch, the least of its own depths: no shorter motion frees it.
double least_motion(const TrianglePatch& p) noexcept { return p.replaced ? -p.along : -depth_of(p.patch); }

bool MeshSurface::leads_out(const TrianglePatch& way, const TrianglePatch& first,
                            FunctionRef<bool(const Corners&, const dvec3&)> frees) const {
    const dvec3 motion = -depth_of(way.patch) * way.patch.normal;
    const auto is_freed = [&](const TrianglePatch& p) {
        NearTriangle t;
        place(*pair_, *mesh_, p.triangle, t);
        return frees(t.corners, motion);
    };
    return is_freed(first) &&
           std::ranges::all_of(patches, [&](const TrianglePatch& p) { return &p == &first || &p == &way || is_freed(p); });
}

void MeshSurface::drop_spared(double tolerance, FunctionRef<bool(const Corners&, const dvec3&)> frees) {
    const auto deepest = std::ranges::min_element(patches, {}, [](const TrianglePatch& p) { return depth_of(p.patch); });
    if (deepest == patches.end() || !deepest->replaced) return;
    double least = 0.0;
    for (const TrianglePatch& p : patches) least = std::max(least, least_motion(p));
    ways_.clear();
    for (const TrianglePatch& p : patches) {
        const double depth = -depth_of(p.patch);
        const bool may = depth >= least - tolerance && depth < -depth_of(deepest->patch) - tolerance;
        if (may && glm::dot(p.patch.normal, deepest->patch.normal) < kSameRoundNormal)
            ways_.push_back(static_cast<std::uint32_t>(&p - patches.data()));
    }
    while (!ways_.empty()) {
        const auto shallowest = std::ranges::min_element(ways_, {}, [&](std::uint32_t k) { return -depth_of(patches[k].patch); });
        const TrianglePatch& way = patches[*shallowest];
        if (leads_out(way, *deepest, frees)) {
            const double enough = depth_of(way.patch) - tolerance;
            std::erase_if(patches, [&](const TrianglePatch& p) { return depth_of(p.patch) < enough; });
            return;
        }
        ways_.erase(shallowest);
    }
}

void MeshSurface::replace_deeper(const dvec3& normal, double depth, const dvec3& middle, double deep) {
    TrianglePatch whole;
    whole.triangle = patches.front().triangle;
    whole.patch.normal = normal;
    whole.patch.add(middle, -depth, feature_name(FeatureKind::Edges, 0, 0));
    std::erase_if(patches, [&](const TrianglePatch& p) {
        return p.replaced || depth_of(p.patch) < -std::min(deep, depth) || glm::dot(p.patch.normal, normal) < 0.0;
    });
    patches.push_back(whole);
}

bool MeshSurface::touches() const noexcept {
    return std::ranges::any_of(patches, [](const TrianglePatch& p) { return depth_of(p.patch) <= 0.0; });
}

void MeshSurface::emit(double same_normal, double tolerance, ManifoldSink& sink) {
    for (;;) {
        const TrianglePatch* leader = nullptr;
        for (const TrianglePatch& p : patches) {
            if (!p.used && p.patch.count > 0 && (leader == nullptr || depth_of(p.patch) < depth_of(leader->patch))) leader = &p;
        }
        if (leader == nullptr) return;
        Patch merged;
        merged.normal = leader->patch.normal;
        const dvec3 axis_u = any_perpendicular(merged.normal), axis_w = glm::cross(merged.normal, axis_u);
        candidates_.clear();
        for (TrianglePatch& p : patches) {
            const double cosine = glm::dot(p.patch.normal, merged.normal);
            if (p.used || p.patch.count == 0 || (&p != leader && cosine < same_normal)) continue;
            p.used = true;
            for (int i = 0; i < p.patch.count; ++i) {
                const PatchPoint& point = p.patch.points[static_cast<std::size_t>(i)];
                candidates_.push_back({point.position, &p == leader ? point.separation : point.separation * cosine,
                                       glm::dot(point.position, axis_u), glm::dot(point.position, axis_w),
                                       mesh_feature(mesh_->triangles()[p.triangle], point.feature)});
            }
        }
        Chosen chosen{};
        const int count = reduce_points(candidates_, tolerance, outline_start(merged.normal, axis_u, axis_w),
                                        overlook(pair_->steady, tolerance / kPointTolerance), chosen);
        for (int i = 0; i < count; ++i) {
            const Candidate& c = candidates_[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
            merged.add(c.position, c.separation, c.feature);
        }
        sink.add(merged);
    }
}

}  // namespace carom::detail
