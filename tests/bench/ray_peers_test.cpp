// The peers of the studies of rays are asked what Carom is asked, and answer in the same measure.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/peers/ray_peers.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace carom::accuracy {
namespace {

// A square across z, 2 from the origin of its frame, which stands far away.
RayCases square(const dvec3& offset) {
    const std::array<vec3, 4> vertices{vec3{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}};
    const std::array<TriangleMesh::Triangle, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
    return {TriangleMesh::build(vertices, triangles).value(), offset, {}, {}};
}

TEST(RayPeers, AnswerInLengthsOfTheirOwnFrame) {
    for (const dvec3& offset : {dvec3{0.0}, dvec3{300, -200, 100}}) {
        const RayCases cases = square(offset);
        for (const RayCaster& caster : peers::ray_peers()) {
            const RayCaster::Cast cast = caster.prepare(cases);
            const std::string name = caster.who + " " + to_string(caster.settings);
            const std::optional<double> hit = cast({.origin = offset + dvec3{0.25, 0.5, -2}, .direction = {0, 0, 4}});
            ASSERT_TRUE(hit) << name;
            EXPECT_NEAR(*hit, 4.0, 1e-3) << name << ": distances are along the normalised direction";
            EXPECT_TRUE(cast({.origin = offset + dvec3{0.25, 0.5, 6}, .direction = {0, 0, -1}})) << name << ": from behind";
            EXPECT_FALSE(cast({.origin = offset + dvec3{0.25, 0.5, -2}, .direction = {0, 0, -1}})) << name << ": behind the ray";
            EXPECT_FALSE(cast({.origin = offset + dvec3{1.5, 0.5, -2}, .direction = {0, 0, 1}})) << name;
        }
    }
}

TEST(RayPeers, JoinTheStudiesUnderTheirNames) {
    const std::vector<Study> studies = ray_studies({.quick = true, .ray_peers = peers::ray_peers()});
    for (const Study& study : studies) {
        const StudyResult result = measure(study, {.repeats = 1});
        std::set<std::string> names;
        for (const Point& point : result.points) {
            names.insert(point.who);
            // What works in double answers every chord near by to a few roundings, whoever it is.
            if (study.name != "rays_near" || point.who != "cgal") continue;
            ASSERT_TRUE(point.error);
            EXPECT_LT(*point.error, 1e-12) << to_string(point.settings);
        }
        const std::set<std::string> wanted =
            study.name == "rays_ball" ? std::set<std::string>{"carom"} : std::set<std::string>{"bullet", "carom", "cgal", "embree"};
        EXPECT_EQ(names, wanted) << study.name;
    }
}

}  // namespace
}  // namespace carom::accuracy
