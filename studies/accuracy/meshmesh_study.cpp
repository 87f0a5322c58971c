// The studies "meshmesh": pairs of triangles of two meshes, by the trees and by plain determinants in float and double, where surfaces cross,
// nearly touch, touch, lie in one plane, coincide, are tiny, and are far from the origin.
#include <carom/studies/accuracy/catalogue.hpp>

#include <carom/collision/mesh_pairs.hpp>
#include <carom/core/random.hpp>
#include <carom/scenes/bumpy.hpp>
#include <carom/studies/oracle/exact_triangles.hpp>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

namespace carom::accuracy {
namespace {

using Corners = std::array<dvec3, 3>;

/// Two meshes at a pose, and the pairs that meet.
struct Case {
    std::shared_ptr<const MeshData> mesh;
    std::shared_ptr<const StaticBvh> bvh;
    Pose b_in_a;
    std::vector<Corners> a, b;  ///< where they lie
    std::vector<TrianglePair> exact;
};
using Cases = std::vector<Case>;

bool boxes_meet(const Corners& a, const Corners& b) {
    const auto lower = [](const Corners& t) { return glm::min(glm::min(t[0], t[1]), t[2]); };
    const auto upper = [](const Corners& t) { return glm::max(glm::max(t[0], t[1]), t[2]); };
    const dvec3 la = lower(a), ua = upper(a), lb = lower(b), ub = upper(b);
    return la.x <= ub.x && lb.x <= ua.x && la.y <= ub.y && lb.y <= ua.y && la.z <= ub.z && lb.z <= ua.z;
}

template <class Meet>
std::vector<TrianglePair> every_pair(const Case& c, const Meet& meet) {
    std::vector<TrianglePair> pairs;
    for (std::uint32_t i = 0; i < c.a.size(); ++i) {
        for (std::uint32_t j = 0; j < c.b.size(); ++j) {
            if (boxes_meet(c.a[i], c.b[j]) && meet(c.a[i], c.b[j])) pairs.push_back({i, j});
        }
    }
    return pairs;
}

/// The determinants that tell triangles that cross, as they come; zero counts as touching. In one plane the boxes decide.
template <class T>
bool plainly_meet(const Corners& first, const Corners& second) {
    using V = glm::vec<3, T>;
    const std::array<V, 3> a{V(first[0]), V(first[1]), V(first[2])}, b{V(second[0]), V(second[1]), V(second[2])};
    const auto side = [](const V& p, const V& q, const V& r, const V& s) {
        const T d = glm::dot(glm::cross(q - p, r - p), s - p);
        return (d > T(0) ? 1 : 0) - (d < T(0) ? 1 : 0);
    };
    const auto pierces = [&](const std::array<V, 3>& edges, const std::array<V, 3>& t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const V &p = edges[k], &q = edges[(k + 1) % 3];
            if (side(t[0], t[1], t[2], p) * side(t[0], t[1], t[2], q) > 0) continue;
            const int x = side(p, q, t[0], t[1]), y = side(p, q, t[1], t[2]), z = side(p, q, t[2], t[0]);
            if ((x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0)) return true;
        }
        return false;
    };
    return pierces(a, b) || pierces(b, a);
}

Pose random_pose(Random& random, double nearest, double farthest) {
    const auto in = [&] { return random.range(-1.0, 1.0); };
    Pose pose;
    dquat& q = pose.orientation;
    q.w = in(), q.x = in(), q.y = in(), q.z = in();
    q = glm::normalize(q);
    dvec3 way{0.0};
    way.x = in(), way.y = in(), way.z = in();
    pose.position = glm::normalize(way) * random.range(nearest, farthest);
    return pose;
}

/// A grid of n x n quads of two triangles in one plane.
MeshData grid(int n) {
    MeshData mesh;
    for (int i = 0; i <= n; ++i) {
        for (int k = 0; k <= n; ++k) {
            mesh.vertices.push_back({static_cast<float>(i) / 8.0f, static_cast<float>(k) / 8.0f, 0.0f});
        }
    }
    const auto at = [n](int i, int k) { return static_cast<std::uint32_t>(i * (n + 1) + k); };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    }
    return mesh;
}

Cases cases_of(const MeshData& data, const std::vector<Pose>& poses) {
    Cases cases;
    const auto mesh = std::make_shared<const MeshData>(data);
    const auto bvh = std::make_shared<const StaticBvh>(*StaticBvh::build(data.vertices, data.triangles));
    for (const Pose& pose : poses) {
        Case c{mesh, bvh, pose, {}, {}, {}};
        for (const auto& t : data.triangles) {
            const auto at = [&](std::size_t k) { return dvec3(data.vertices[t[k]]); };
            c.a.push_back({at(0), at(1), at(2)});
            c.b.push_back({transform_point(pose, at(0)), transform_point(pose, at(1)), transform_point(pose, at(2))});
        }
        c.exact = every_pair(c, [](const Corners& a, const Corners& b) { return oracle::triangles_meet(a, b); });
        cases.push_back(std::move(c));
    }
    return cases;
}

MeshData scaled(MeshData mesh, float factor, const vec3& shift) {
    for (vec3& v : mesh.vertices) v = factor * v + shift;
    return mesh;
}

struct Condition {
    std::string name;
    std::string what;
    Cases cases;
};

std::vector<Condition> conditions(bool quick) {
    const int count = quick ? 3 : 12;
    const MeshData ball = scenes::bumpy(quick ? 3 : 4);
    Random random(20'261'103);
    std::vector<Pose> crossing, near, coincident, along, tiny, far;
    const vec3 away{1e4f, -2e4f, 3e3f};
    for (int n = 0; n < count; ++n) {
        crossing.push_back(random_pose(random, 0.5, 1.9));
        // The ball beside itself, a little turned: surfaces nowhere farther apart than some roundings of float.
        Pose pose = random_pose(random, 0.0, 1e-7);
        pose.orientation = glm::normalize(dquat{1.0, 1e-8 * pose.orientation.x, 1e-8 * pose.orientation.y, 1e-8 * pose.orientation.z});
        near.push_back(pose);
        const double step = std::floor(random.range(1.0, 8.0));
        along.push_back({.position = {step / 8.0, std::floor(random.range(0.0, 8.0)) / 8.0, 0.0}});
        pose = random_pose(random, 0.5, 1.9);
        tiny.push_back({1e-12 * pose.position, pose.orientation});
        pose = random_pose(random, 0.5, 1.6);
        pose.position += dvec3(away) - rotate(pose.orientation, dvec3(away));
        far.push_back(pose);
    }
    coincident.push_back({});
    // The lower edge of the standing grid is on the other one, corners on corners and in the middle of edges.
    std::vector<Pose> standing;
    for (const Pose& pose : along) standing.push_back({{pose.position.x, pose.position.y + 0.0625, 0.0}, {0.5, 0.5, 0.5, 0.5}});
    std::vector<Condition> out;
    out.push_back({"random", "balls of bumps that cross", cases_of(ball, crossing)});
    out.push_back({"near", "a ball and itself, moved and turned by some 1e-8 of its size", cases_of(ball, near)});
    out.push_back({"touching", "a grid that stands on another with its edge", cases_of(grid(8), standing)});
    out.push_back({"coplanar", "a grid beside and on another in one plane", cases_of(grid(8), along)});
    out.push_back({"coincident", "a ball where it is itself", cases_of(ball, coincident)});
    out.push_back({"tiny", "balls of 1e-12 m that cross", cases_of(scaled(ball, 1e-12f, vec3{0.0f}), tiny)});
    out.push_back({"far", "balls that cross 2e4 m from their origins", cases_of(scaled(ball, 1.0f, away), far)});
    return out;
}

template <class Find>
Sample run(const Cases& cases, const Find& find) {
    Sample sample;
    std::size_t wrong = 0, all = 0;
    for (const Case& c : cases) {
        const Stopwatch watch;
        const std::vector<TrianglePair> found = find(c);
        sample.time_s += watch.seconds();
        std::vector<TrianglePair> differing;
        std::ranges::set_symmetric_difference(found, c.exact, std::back_inserter(differing));
        wrong += differing.size();
        all += c.exact.size();
    }
    sample.error = static_cast<double>(wrong) / static_cast<double>(std::max<std::size_t>(all, 1));
    return sample;
}

Study study_of(const std::string& name, const std::string& what, std::shared_ptr<const Cases> cases) {
    std::size_t pairs = 0;
    for (const Case& c : *cases) pairs += c.exact.size();
    Study study{.name = name,
                .stage = "mesh against mesh",
                .error = "pairs of triangles missed or added, over those that meet",
                .unit = "1",
                .oracle = fmt::format("separating axes in rational numbers, {} pairs of meshes with {} pairs of triangles that meet: {}",
                                      cases->size(), pairs, what),
                .candidates = {}};
    study.candidates.push_back({"carom", {{"method", "trees, exact"}}, [cases] {
                                    return run(*cases, [](const Case& c) {
                                        std::vector<TrianglePair> found;
                                        overlapping_pairs(*c.bvh, *c.bvh, c.b_in_a, found);
                                        return found;
                                    });
                                }});
    study.candidates.push_back({"carom", {{"method", "plain determinants in float"}}, [cases] {
                                    return run(*cases, [](const Case& c) { return every_pair(c, plainly_meet<float>); });
                                }});
    study.candidates.push_back({"carom", {{"method", "plain determinants in double"}}, [cases] {
                                    return run(*cases, [](const Case& c) { return every_pair(c, plainly_meet<double>); });
                                }});
    return study;
}

}  // namespace

std::vector<Study> meshmesh_studies(const StudyOptions& options) {
    std::vector<Condition> all = conditions(options.quick);
    const auto together = std::make_shared<Cases>();
    for (const Condition& condition : all) together->insert(together->end(), condition.cases.begin(), condition.cases.end());
    std::vector<Study> studies{study_of("meshmesh", "all conditions", together)};
    for (Condition& condition : all) {
        studies.push_back(study_of("meshmesh_" + condition.name, condition.what, std::make_shared<const Cases>(std::move(condition.cases))));
    }
    for (Study& study : meshmesh_contact_studies(options)) studies.push_back(std::move(study));
    for (Study& study : meshmesh_wall_studies(options)) studies.push_back(std::move(study));
    return studies;
}

}  // namespace carom::accuracy
