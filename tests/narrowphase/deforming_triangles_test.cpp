// Vertices against faces and edges against edges in motion: never a missed contact, never a time too late, against exact rationals.
#include <carom/core/check.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/deforming_triangles.hpp>

#include <support/exact_impact.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carom {
namespace {

using exact::Verdict;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A coordinate: from a coarse grid, on which features meet at corners and edges and lie in one plane often; with 0 any.
double coordinate(Random& random, int grid) { return grid > 0 ? std::floor(random.range(-grid, grid + 1)) : random.range(-1.0, 1.0); }
constexpr int kFine = 1 << 16;

MovingPoint moving_point(Random& random, int grid) {
    MovingPoint p;
    for (int k = 0; k < 3; ++k) p.start[k] = coordinate(random, grid), p.end[k] = coordinate(random, grid);
    return p;
}
void fill(Random& random, int grid, VertexFaceMotion& m) {
    m.vertex = moving_point(random, grid);
    for (MovingPoint& p : m.face) p = moving_point(random, grid);
}
void fill(Random& random, int grid, EdgeEdgeMotion& m) {
    for (MovingPoint& p : m.a) p = moving_point(random, grid);
    for (MovingPoint& p : m.b) p = moving_point(random, grid);
}

struct Tally {
    int meet = 0, apart = 0, unknown = 0, false_positives = 0;
    double earliest = 0.0;  ///< the most by which a time was too early
};

template <class Motion>
Tally judge_random(std::uint64_t seed, int grid, int count) {
    Random random(seed);
    Tally tally;
    for (int i = 0; i < count; ++i) {
        Motion motion;
        fill(random, grid, motion);
        const exact::FirstMeeting truth = exact::first_meeting(motion);
        const Impact impact = time_of_impact(motion);
        EXPECT_TRUE(impact.t >= 0.0 && impact.t <= 1.0);
        if (truth.verdict == Verdict::Unknown) {
            ++tally.unknown;
        } else if (truth.verdict == Verdict::Meet) {
            ++tally.meet;
            EXPECT_TRUE(may_touch(impact.status)) << "missed, grid " << grid << ", number " << i;
            EXPECT_TRUE(exact::number(impact.t) <= truth.latest) << "late, grid " << grid << ", number " << i;
            tally.earliest = std::max(tally.earliest, static_cast<double>(truth.latest) - impact.t);
        } else {
            ++tally.apart;
            tally.false_positives += may_touch(impact.status) ? 1 : 0;
        }
    }
    return tally;
}

template <class Motion>
void expect_exact(std::uint64_t seed) {
    for (const int grid : {1, 2, 5, kFine, 0}) {
        const Tally tally = judge_random<Motion>(seed, grid, grid == 0 ? 16 : grid == kFine ? 120 : 300);
        EXPECT_GE(tally.meet, grid == 0 ? 0 : 4) << grid;
        EXPECT_GE(tally.apart, 8) << grid;
        EXPECT_EQ(tally.false_positives, 0) << grid;
        // A search ends within 1e-8 of the size; what is nearly parallel to the other stays that near for longer.
        EXPECT_LT(tally.earliest, 1e-3) << grid;
        testing::Test::RecordProperty("earliest_" + std::to_string(grid), std::to_string(tally.earliest));
    }
}

TEST(DeformingTriangles, VertexAndFaceAgreeWithExactRoots) { expect_exact<VertexFaceMotion>(0xfa11); }
TEST(DeformingTriangles, EdgesAgreeWithExactRoots) { expect_exact<EdgeEdgeMotion>(0xed6e); }

/// Contacts made by construction, where no cubic helps: everything in one plane, parallel edges, folded faces.
TEST(DeformingTriangles, ContactsWithoutAPlaneAreNotMissed) {
    Random random(0xf1a7);
    for (int i = 0; i < 400; ++i) {
        // At t = m / 64 the vertex is at a corner-weighted point of a face; all of it in the plane z = 0.
        const double t = std::floor(random.range(1, 64)) / 64.0;
        VertexFaceMotion m;
        fill(random, 4, m);
        const double s = std::floor(random.range(0, 9)) / 8.0, r = std::floor(random.range(0, 8.0 * (1.0 - s) + 1.0)) / 8.0;
        if (i % 2 == 0) m.face[2] = m.face[1];  // folded to a line
        dvec3 at{0.0};
        const double weights[3] = {1.0 - s - r, s, r};
        for (std::size_t k = 0; k < 3; ++k) {
            m.face[k].start.z = m.face[k].end.z = 0.0;
            at += weights[k] * ((1.0 - t) * m.face[k].start + t * m.face[k].end);
        }
        const dvec3 along{coordinate(random, 4), coordinate(random, 4), 0.0};
        m.vertex = {at - t * along, at + (1.0 - t) * along};
        ASSERT_TRUE(exact::distance_sq_at(m, exact::number(t)).sign() == 0);
        const Impact impact = time_of_impact(m);
        ASSERT_TRUE(may_touch(impact.status)) << i;
        ASSERT_LE(impact.t, t) << i;

        // Two parallel edges that come to lie on each other, in part.
        EdgeEdgeMotion e;
        const dvec3 dir{coordinate(random, 3), coordinate(random, 3), 1.0};
        const dvec3 corner{coordinate(random, 4), coordinate(random, 4), coordinate(random, 4)};
        const dvec3 u{coordinate(random, 4), coordinate(random, 4), coordinate(random, 4)};
        const dvec3 v{coordinate(random, 4), coordinate(random, 4), coordinate(random, 4)};
        const double shift = std::floor(random.range(-8, 9)) / 8.0;
        e.a = {{{corner - t * u, corner + (1.0 - t) * u}, {corner + dir - t * u, corner + dir + (1.0 - t) * u}}};
        const dvec3 other = corner + shift * dir;
        e.b = {{{other - t * v, other + (1.0 - t) * v}, {other + dir - t * v, other + dir + (1.0 - t) * v}}};
        ASSERT_TRUE(exact::distance_sq_at(e, exact::number(t)).sign() == 0);
        const Impact edges = time_of_impact(e);
        ASSERT_TRUE(may_touch(edges.status)) << i;
        ASSERT_LE(edges.t, t) << i;
    }
}

/// A vertex that falls past the side of a face, or onto it, by k least steps of its coordinate.
TEST(DeformingTriangles, GrazingByOneUlpIsToldApart) {
    const double side = 0.7;
    for (const double k : {-8.0, -1.0, 0.0, 1.0, 2.0, 8.0, 1e3, 1e6, 1e9}) {
        const double x = side + k * 0x1p-53;
        VertexFaceMotion m{{{x, 1.0, 0.1}, {x, -1.0, 0.3}},
                           {{{{-1.0, 0.0, -1.0}, {-1.0, 0.0, -1.0}}, {{side, 0.0, -1.0}, {side, 0.0, -1.0}}, {{side, 0.0, 1.0}, {side, 0.0, 1.0}}}}};
        EXPECT_EQ(may_touch(time_of_impact(m).status), x <= side) << k;
    }
    // The same, turned and moved so that no coordinate is special: no contact is missed, and gaps of 1e-7 r are seen.
    Random random(0x9a2e);
    int meet = 0, apart = 0;
    for (int i = 0; i < 36; ++i) {
        VertexFaceMotion m;
        fill(random, 0, m);
        const double t = random.range(0.1, 0.9), s = random.unit();
        const auto at = [&](const MovingPoint& p) { return (1.0 - t) * p.start + t * p.end; };
        const dvec3 on_side = glm::mix(at(m.face[0]), at(m.face[1]), s);
        const dvec3 outward = glm::normalize(glm::cross(at(m.face[1]) - at(m.face[0]), glm::cross(at(m.face[1]) - at(m.face[0]), at(m.face[2]) - at(m.face[0]))));
        const double gap = (i % 2 == 0 ? 1.0 : -1.0) * (i % 3 == 0 ? 0x1p-53 : i % 3 == 1 ? 1e-12 : 1e-7);
        const dvec3 along{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        m.vertex = {on_side - gap * outward - t * along, on_side - gap * outward + (1.0 - t) * along};
        const exact::FirstMeeting truth = exact::first_meeting(m);
        const Impact impact = time_of_impact(m);
        if (truth.verdict == Verdict::Meet) {
            ++meet;
            ASSERT_TRUE(may_touch(impact.status)) << i;
            ASSERT_TRUE(exact::number(impact.t) <= truth.latest) << i;
        } else if (i % 3 == 2) {
            ++apart;
            EXPECT_EQ(impact.status, ImpactStatus::Separated) << i;
        }
    }
    EXPECT_GT(meet, 12);
    EXPECT_GT(apart, 2);
}

template <class Motion>
void expect_separation_kept(std::uint64_t seed) {
    Random random(seed);
    int touching = 0, separated = 0, overlapping = 0;
    for (int i = 0; i < 150; ++i) {
        Motion m;
        fill(random, 0, m);
        const double d = std::pow(10.0, random.range(-6.0, -0.3));
        const Impact impact = time_of_impact(m, {.separation = d});
        const exact::Rational d_sq = exact::square(exact::number(d));
        // At no time before the answer are they that near; where they are said to be, they are, to 1e-6 of the size.
        for (int k = 0; k < 12; ++k) {
            const exact::Rational t = exact::number(impact.t) * k / 12;
            ASSERT_TRUE(impact.t == 0.0 || exact::distance_sq_at(m, t) > d_sq) << i;
        }
        const exact::Rational at = exact::distance_sq_at(m, exact::number(impact.t));
        if (impact.status == ImpactStatus::Separated) {
            ++separated;
            ASSERT_TRUE(at > d_sq) << i;
        } else {
            ASSERT_TRUE(at < exact::square(exact::number(d + 1e-6))) << i << " " << to_string(impact.status);
            ++(impact.status == ImpactStatus::Overlapping ? overlapping : touching);
            ASSERT_TRUE(impact.status != ImpactStatus::Touching || at > d_sq);
            ASSERT_LE(impact.t, time_of_impact(m).t);
        }
    }
    EXPECT_GT(touching, 8);
    EXPECT_GT(separated, 20);
    EXPECT_GT(overlapping, 2);
}
TEST(DeformingTriangles, SeparationIsKeptByVertexAndFace) { expect_separation_kept<VertexFaceMotion>(0x5e9a); }
TEST(DeformingTriangles, SeparationIsKeptByEdges) { expect_separation_kept<EdgeEdgeMotion>(0x5e9b); }

TEST(DeformingTriangles, NormalAndPointAreThoseOfTheContact) {
    const VertexFaceMotion drop{{{0.25, 2.0, 0.25}, {0.25, -2.0, 0.25}},
                                {{{{0, 0, 0}, {0, 0, 0}}, {{0, 0, 1}, {0, 0, 1}}, {{1, 0, 0}, {1, 0, 0}}}}};
    const Impact hit = time_of_impact(drop);
    EXPECT_EQ(hit.status, ImpactStatus::Touching);
    EXPECT_NEAR(hit.t, 0.5, 1e-14);
    EXPECT_LE(hit.t, 0.5);
    EXPECT_NEAR(hit.normal.y, -1.0, 1e-14);  // from the vertex to the face
    EXPECT_LT(glm::length(hit.point - dvec3(0.25, 0.0, 0.25)), 1e-13);

    const EdgeEdgeMotion crossing{{{{{-1, 1, 0.5}, {-1, -1, 0.5}}, {{1, 1, 0.5}, {1, -1, 0.5}}}},
                                  {{{{0.25, 0, -1}, {0.25, 0, -1}}, {{0.25, 0, 1}, {0.25, 0, 1}}}}};
    const Impact edges = time_of_impact(crossing);
    EXPECT_EQ(edges.status, ImpactStatus::Touching);
    EXPECT_NEAR(edges.t, 0.5, 1e-14);
    EXPECT_NEAR(edges.normal.y, -1.0, 1e-14);
    EXPECT_LT(glm::length(edges.point - dvec3(0.25, 0.0, 0.5)), 1e-13);
}

TEST(DeformingTriangles, ATriangleMeetsATriangleAtItsFirstFeature) {
    // A corner down onto a face, and the other way round.
    const std::array<MovingPoint, 3> tip{{{{0, 1, 0}, {0, -1, 0}}, {{1, 2, 0}, {1, 0, 0}}, {{-1, 2, 0}, {-1, 0, 0}}}};
    const std::array<MovingPoint, 3> floor{{{{-2, 0, -2}, {-2, 0, -2}}, {{0, 0, 4}, {0, 0, 4}}, {{2, 0, -2}, {2, 0, -2}}}};
    for (const bool swap : {false, true}) {
        const Impact hit = swap ? time_of_impact(floor, tip) : time_of_impact(tip, floor);
        EXPECT_EQ(hit.status, ImpactStatus::Touching);
        EXPECT_NEAR(hit.t, 0.5, 1e-14);
        EXPECT_LE(hit.t, 0.5);
        EXPECT_NEAR(hit.normal.y, swap ? 1.0 : -1.0, 1e-14);
    }
    std::array<MovingPoint, 3> broken = tip;
    broken[1].end.x = kInfinity;
    EXPECT_EQ(time_of_impact(broken, floor).status, ImpactStatus::Invalid);
}

TEST(DeformingTriangles, TheCapSaysSoAndStaysEarly) {
    Random random(0xca9);
    int clamped = 0;
    for (int i = 0; i < 300; ++i) {
        EdgeEdgeMotion m;
        fill(random, 0, m);
        const Impact whole = time_of_impact(m), cut = time_of_impact(m, {.most_checks = 1});
        if (cut.status == ImpactStatus::Clamped) ++clamped;
        EXPECT_LE(cut.t, whole.t);
        EXPECT_TRUE(!may_touch(whole.status) || may_touch(cut.status)) << i;
    }
    EXPECT_GT(clamped, 50);
}

TEST(DeformingTriangles, ToleranceEndsTheSearchWithinIt) {
    Random random(0x701e);
    int nearer = 0;
    for (int i = 0; i < 200; ++i) {
        VertexFaceMotion m;
        fill(random, 0, m);
        const Impact fine = time_of_impact(m), coarse = time_of_impact(m, {.tolerance = 1e-3});
        EXPECT_LE(coarse.t, fine.t);
        EXPECT_TRUE(!may_touch(fine.status) || may_touch(coarse.status)) << i;
        if (coarse.status != ImpactStatus::Touching) continue;
        EXPECT_TRUE(exact::distance_sq_at(m, exact::number(coarse.t)) < exact::square(exact::number(1.001e-3)));
        nearer += coarse.checks < fine.checks ? 1 : 0;
    }
    EXPECT_GT(nearer, 5);
}

/// Powers of two change nothing but the scale, down to where coordinates are denormal and up to where their differences overflow.
TEST(DeformingTriangles, ScaleDoesNotMatter) {
    Random random(0x5ca1e);
    for (int i = 0; i < 100; ++i) {
        VertexFaceMotion m;
        fill(random, 3, m);
        const Impact one = time_of_impact(m);
        for (const int exponent : {-1060, -400, -290, 20, 290, 400, 1021}) {
            VertexFaceMotion s = m;
            for (MovingPoint* p : {&s.vertex, &s.face[0], &s.face[1], &s.face[2]}) {
                p->start = dvec3{std::scalbn(p->start.x, exponent), std::scalbn(p->start.y, exponent), std::scalbn(p->start.z, exponent)};
                p->end = dvec3{std::scalbn(p->end.x, exponent), std::scalbn(p->end.y, exponent), std::scalbn(p->end.z, exponent)};
            }
            const Impact scaled = time_of_impact(s);
            ASSERT_EQ(scaled.status, one.status) << i << " " << exponent;
            ASSERT_EQ(scaled.t, one.t) << i << " " << exponent;
        }
    }
}

TEST(DeformingTriangles, MotionlessAndSizelessInputIsAnswered) {
    const MovingPoint here{dvec3{1.0}, dvec3{1.0}}, there{dvec3{2.0}, dvec3{2.0}}, passing{dvec3{0.0}, dvec3{2.0}};
    EXPECT_EQ(time_of_impact(VertexFaceMotion{here, {here, here, here}}).status, ImpactStatus::Overlapping);
    EXPECT_EQ(time_of_impact(VertexFaceMotion{here, {there, there, there}}).status, ImpactStatus::Separated);
    EXPECT_EQ(time_of_impact(EdgeEdgeMotion{{here, here}, {here, here}}).status, ImpactStatus::Overlapping);
    EXPECT_EQ(time_of_impact(EdgeEdgeMotion{{here, here}, {there, there}}).status, ImpactStatus::Separated);
    // Two points that pass through each other.
    const Impact points = time_of_impact(VertexFaceMotion{passing, {here, here, here}});
    EXPECT_EQ(points.status, ImpactStatus::Touching);
    EXPECT_LE(points.t, 0.5);
    EXPECT_GT(points.t, 0.5 - 1e-12);
    EXPECT_TRUE(may_touch(time_of_impact(EdgeEdgeMotion{{passing, passing}, {here, here}}).status));
}

TEST(DeformingTriangles, BadInputIsInvalid) {
    const MovingPoint here{dvec3{1.0}, dvec3{1.0}}, there{dvec3{2.0}, dvec3{2.0}};
    for (const double bad : {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
        for (std::size_t corner = 0; corner < 4; ++corner) {
            for (int k = 0; k < 6; ++k) {
                std::array<MovingPoint, 4> p{here, there, there, there};
                (k < 3 ? p[corner].start : p[corner].end)[k % 3] = bad;
                const Impact face = time_of_impact(VertexFaceMotion{p[0], {p[1], p[2], p[3]}});
                EXPECT_EQ(face.status, ImpactStatus::Invalid);
                EXPECT_EQ(face.t, 0.0);
                EXPECT_EQ(time_of_impact(EdgeEdgeMotion{{p[0], p[1]}, {p[2], p[3]}}).status, ImpactStatus::Invalid);
            }
        }
        const EdgeEdgeMotion fine{{here, here}, {there, there}};
        EXPECT_EQ(time_of_impact(fine, {.separation = bad}).status, ImpactStatus::Invalid);
        EXPECT_EQ(time_of_impact(fine, {.tolerance = bad}).status, ImpactStatus::Invalid);
    }
    const EdgeEdgeMotion fine{{here, here}, {there, there}};
    EXPECT_EQ(time_of_impact(fine, {.separation = -1e-300}).status, ImpactStatus::Invalid);
    EXPECT_EQ(time_of_impact(fine, {.tolerance = -1.0}).status, ImpactStatus::Invalid);
    EXPECT_EQ(time_of_impact(fine, {.most_checks = 0}).status, ImpactStatus::Invalid);
    EXPECT_TRUE(may_touch(ImpactStatus::Invalid));
    EXPECT_TRUE(may_touch(ImpactStatus::Clamped));
    EXPECT_STREQ(to_string(ImpactStatus::Clamped), "clamped");
}

TEST(DeformingTriangles, BatchesAreTheSingleCalls) {
    Random random(0xba7c);
    std::vector<VertexFaceMotion> faces(50);
    std::vector<EdgeEdgeMotion> edges(50);
    for (auto& m : faces) fill(random, 0, m);
    for (auto& m : edges) fill(random, 0, m);
    std::vector<Impact> out(50);
    times_of_impact(faces, out);
    for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(out[i].t, time_of_impact(faces[i]).t);
    times_of_impact(edges, out);
    for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(out[i].t, time_of_impact(edges[i]).t);
    out.resize(49);
    EXPECT_THROW(times_of_impact(faces, out), MisuseError);
    EXPECT_THROW(times_of_impact(edges, out), MisuseError);
}

}  // namespace
}  // namespace carom
