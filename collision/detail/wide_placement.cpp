// Where two hierarchies lie to each other, and the descent box by box in double.
#include <carom/collision/detail/wide_pairs.hpp>

#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace carom {
namespace {

struct DoubleBox {
    dvec3 lower, upper;
};

bool overlap(const DoubleBox& a, const DoubleBox& b) noexcept {
    return glm::all(glm::lessThanEqual(a.lower, b.upper)) && glm::all(glm::lessThanEqual(b.lower, a.upper));
}

/// Around a box of b's tree at its place, grown by the reach and a share of its size.
DoubleBox placed(const DoubleBox& box, const WidePlacement& placement) noexcept {
    DoubleBox out{dvec3{1e308}, dvec3{-1e308}};
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 p{(corner & 1) != 0 ? box.upper.x : box.lower.x, (corner & 2) != 0 ? box.upper.y : box.lower.y,
                      (corner & 4) != 0 ? box.upper.z : box.lower.z};
        const dvec3 q = transform_point(placement.pose, placement.metres * p) * placement.units;
        out.lower = glm::min(out.lower, q);
        out.upper = glm::max(out.upper, q);
    }
    const dvec3 size = glm::max(glm::abs(out.lower), glm::abs(out.upper)) + glm::abs(placement.pose.position) * placement.units;
    const dvec3 margin = dvec3{0x1p-46 * std::max({size.x, size.y, size.z}) + placement.reach * placement.units};
    return {out.lower - margin, out.upper + margin};
}

struct Child {
    WideRef ref;
    DoubleBox box;
};

std::vector<Child> children_of(const WideBvh& tree, const Child& parent) {
    if (is_leaf(parent.ref)) return {parent};
    const WideNode& node = tree.node(parent.ref);
    std::vector<Child> children;
    for (std::size_t k = 0; k < static_cast<std::size_t>(child_count(node)); ++k) {
        const auto at = [&](int side) { return dvec3{vec3{node.bound[side][0][k], node.bound[side][1][k], node.bound[side][2][k]}}; };
        children.push_back({node.child[k], {at(0), at(1)}});
    }
    return children;
}

VisitedPair visited(const Child& first, const Child& second) {
    VisitedPair pair{first.ref, second.ref, {}, {}};
    for (int k = 0; k < 3; ++k) {
        pair.box_a[0][k] = static_cast<float>(first.box.lower[k]);
        pair.box_a[1][k] = static_cast<float>(first.box.upper[k]);
        pair.box_b[0][k] = static_cast<float>(second.box.lower[k]);
        pair.box_b[1][k] = static_cast<float>(second.box.upper[k]);
    }
    return pair;
}

}  // namespace

dvec3 WidePlacement::place(float x, float y, float z) const noexcept {
    const dvec3 corner = metres * dvec3{vec3{x, y, z}};
    dvec3 p = units * transform_point(pose, corner);
    for (int k = 0; k < 3; ++k) p[k] = std::abs(p[k]) < 0x1p-300 ? 0.0 : p[k];
    return p;
}

void WidePlacement::set_reach(double metres_away) noexcept {
    reach = metres_away;
    reach_a = static_cast<float>(units * reach * (1.0 + 0x1p-22));
    reach_b = static_cast<float>(reach / metres * (1.0 + 0x1p-22));
}

bool place(const WideBvh& a, const WideBvh& b, const Pose& b_in_a, double reach, WidePlacement& out) noexcept {
    if (!is_finite(b_in_a)) return false;
    out.pose = b_in_a;
    out.reach = reach;
    out.units = static_cast<double>(a.scale);
    out.metres = 1.0 / static_cast<double>(b.scale);
    const DoubleBox whole_a{dvec3{a.lower}, dvec3{a.upper}};
    if (!overlap(whole_a, placed({dvec3{b.lower}, dvec3{b.upper}}, out))) return false;

    const double ratio = out.units * out.metres;
    glm::dmat3 turn{rotate(b_in_a.orientation, dvec3{1.0, 0.0, 0.0}), rotate(b_in_a.orientation, dvec3{0.0, 1.0, 0.0}),
                    rotate(b_in_a.orientation, dvec3{0.0, 0.0, 1.0})};
    const glm::dmat3 back = glm::inverse(turn);
    const dvec3 shift = out.units * b_in_a.position, shift_back = -(back * b_in_a.position) / out.metres;
    const auto largest = [](const dvec3& x, const dvec3& y) {
        const dvec3 size = glm::max(glm::abs(x), glm::abs(y));
        return std::max({size.x, size.y, size.z});
    };
    const double of_a = largest(dvec3{a.lower}, dvec3{a.upper}), of_b = ratio * largest(dvec3{b.lower}, dvec3{b.upper});
    const double size = std::max({of_a, of_b, out.units * reach});
    const bool turns = std::abs(glm::dot(b_in_a.orientation, b_in_a.orientation) - 1.0) < 1e-3;
    out.too_unlike = !(of_a > 0x1p-40 * size && of_b > 0x1p-40 * size && size < 0x1p30 && size > 0x1p-30 && turns);
    if (out.too_unlike) return true;
    for (int row = 0; row < 3; ++row) {
        for (int k = 0; k < 3; ++k) {
            out.exact_to_a[row][k] = ratio * turn[k][row];
            out.to_a[row][k] = static_cast<float>(out.exact_to_a[row][k]);
            out.to_b[row][k] = static_cast<float>(back[k][row] / ratio);
        }
        out.exact_to_a[row][3] = shift[row];
        out.to_a[row][3] = static_cast<float>(shift[row]);
        out.to_b[row][3] = static_cast<float>(shift_back[row]);
    }
    out.stretch = static_cast<float>(1.01 * ratio);
    out.set_reach(reach);
    out.margin_a = 0x1p-20f * static_cast<float>(size + largest(shift, shift));
    out.margin_b = 0x1p-20f * static_cast<float>(size / ratio + largest(shift_back, shift_back));
    return true;
}

void visit_leaf_pairs_in_double(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit,
                                const PairWalk& walk) {
    std::vector<std::pair<Child, Child>> stack{{{WideBvh::root(), {dvec3{a.lower}, dvec3{a.upper}}},
                                                {WideBvh::root(), {dvec3{b.lower}, dvec3{b.upper}}}}};
    while (!stack.empty()) {
        const auto [first, second] = stack.back();
        stack.pop_back();
        if (walk.visited != nullptr) walk.visited->push_back(visited(first, second));
        if (is_leaf(first.ref) && is_leaf(second.ref)) {
            LeafPair pair;
            pair.a = &a.leaf(first.ref);
            pair.b = &b.leaf(second.ref);
            for (std::uint32_t j = 0; j < pair.b->triangle_count; ++j) {
                for (std::uint32_t i = 0; i < pair.a->triangle_count; ++i) pair.candidate[pair.count++] = static_cast<std::int32_t>(i + 16 * j);
            }
            if (!visit(pair)) return;
            continue;
        }
        for (const Child& y : children_of(b, second)) {
            const DoubleBox box = placed(y.box, placement);
            for (const Child& x : children_of(a, first)) {
                if (overlap(x.box, box)) stack.push_back({x, y});
            }
        }
    }
}

}  // namespace carom
