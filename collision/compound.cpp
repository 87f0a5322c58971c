#include <carom/collision/compound.hpp>
#include <carom/collision/detail/ray_local.hpp>
#include <carom/collision/detail/sah_tree.hpp>
#include <carom/core/executor.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace carom {
namespace {

constexpr double kUnitTolerance = 1e-3;

Error fault(std::size_t part, ErrorCode code, const std::string& message) {
    return {code, message, "Compound::build, part " + std::to_string(part)};
}

/// @return null if all is well.
const char* fault_of(const PartMaterial& m) {
    if (m.density && !(is_finite(*m.density) && *m.density > 0.0)) return "density must be positive";
    if (m.friction && !(is_finite(*m.friction) && *m.friction >= 0.0f)) return "friction must not be negative";
    if (m.restitution && !(*m.restitution >= 0.0f && *m.restitution <= 1.0f)) return "restitution must be in [0, 1]";
    return nullptr;
}

Status check_part(std::size_t index, const CompoundPart& part) {
    if (!is_convex_solid(type_of(part.shape))) {
        return fault(index, ErrorCode::WrongType, std::string("a ") + to_string(type_of(part.shape)) + " cannot be a part");
    }
    if (const Status status = validate(part.shape); !status) return fault(index, status.error().code, status.error().message);
    if (!is_finite(part.pose)) return fault(index, ErrorCode::NotFinite, "the pose is not finite");
    if (!(std::abs(glm::length(part.pose.orientation) - 1.0) <= kUnitTolerance)) {
        return fault(index, ErrorCode::InvalidArgument, "the orientation must be a unit quaternion");
    }
    if (!(glm::length(part.pose.position) + bounding_radius(part.shape) <= Compound::kFarthest)) {
        return fault(index, ErrorCode::InvalidArgument, "the part reaches farther than 1e15 m from the compound's origin");
    }
    if (const char* what = fault_of(part.material)) return fault(index, ErrorCode::InvalidArgument, what);
    return {};
}

float round_down(double x) noexcept {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) <= x ? f : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float round_up(double x) noexcept { return -round_down(-x); }

SahItem item_of(std::uint32_t part, const Aabb& box) {
    SahItem item{};
    for (int k = 0; k < 3; ++k) {
        item.lower[k] = round_down(box.lower[k]);
        item.minus_upper[k] = -round_up(box.upper[k]);
    }
    item.tagged = part | SahItem::kTag;
    return item;
}

Aabb box_of(const std::array<float, 3>& lower, const std::array<float, 3>& upper) {
    return {{static_cast<double>(lower[0]), static_cast<double>(lower[1]), static_cast<double>(lower[2])},
            {static_cast<double>(upper[0]), static_cast<double>(upper[1]), static_cast<double>(upper[2])}};
}

/// Whether the ray meets the box within `reach`. Slabs; a ray parallel to one is in it or not. Two ulp of room on each side of the box for
/// the rounding of the quotients, whose error the box's distance bounds.
bool meets(const Aabb& box, const dvec3& origin, const dvec3& direction, double reach) {
    double enter = 0.0, leave = reach;
    for (int k = 0; k < 3; ++k) {
        const double room = 0x1p-50 * (std::abs(origin[k]) + std::max(std::abs(box.lower[k]), std::abs(box.upper[k])));
        const double lower = box.lower[k] - room - origin[k], upper = box.upper[k] + room - origin[k];
        if (direction[k] == 0.0) {
            if (lower > 0.0 || upper < 0.0) return false;
            continue;
        }
        const double first = (direction[k] > 0.0 ? lower : upper) / direction[k];
        const double last = (direction[k] > 0.0 ? upper : lower) / direction[k];
        enter = std::max(enter, first);
        leave = std::min(leave, last);
    }
    return enter <= leave * (1.0 + 0x1p-50);
}

}  // namespace

Result<CompoundPtr> Compound::build(std::vector<CompoundPart> parts) {
    if (parts.empty()) return Error{ErrorCode::Empty, "a compound needs a part", "Compound::build"};
    if (parts.size() > kMaxParts) {
        return Error{ErrorCode::InvalidArgument, "a compound has at most " + std::to_string(kMaxParts) + " parts", "Compound::build"};
    }
    HugePageVector<SahItem> items;
    std::vector<Corners> corners;  // of triangles in this tree's other use; no two parts share any
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (const Status status = check_part(i, parts[i]); !status) return status.error();
        parts[i].pose.orientation = glm::normalize(parts[i].pose.orientation);
        const auto index = static_cast<std::uint32_t>(i);
        boxes.push_back(bounds(parts[i].shape, parts[i].pose));
        items.push_back(item_of(index, boxes.back()));
        corners.push_back({3 * index, 3 * index + 1, 3 * index + 2});
    }
    SerialExecutor serial;
    const SahTree tree = build_sah_tree(std::move(items), corners, serial);

    std::shared_ptr<Compound> compound(new Compound);
    compound->parts_ = std::move(parts);
    compound->order_.assign(tree.order.begin(), tree.order.end());
    for (const std::uint32_t part : compound->order_) compound->boxes_.push_back(boxes[part]);
    for (const SahNode& node : tree.nodes) {
        Node& own = compound->nodes_.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            own.lower[k] = node.box.minimum[k];
            own.upper[k] = -node.box.minimum[4 + k];
        }
        own.first = node.first;
        own.count = node.count;
        own.skip = node.skip;
    }
    compound->bounds_ = box_of(compound->nodes_[0].lower, compound->nodes_[0].upper);
    return CompoundPtr(std::move(compound));
}

template <class Enter, class Leaf>
void Compound::descend(const Enter& enter, const Leaf& leaf) const {
    // The tree is at most 64 deep: 48 levels by area, then halves of at most 2^16 parts.
    std::array<std::uint32_t, 80> later;
    std::size_t waiting = 0;
    std::uint32_t i = 0;
    for (;;) {
        const Node& node = nodes_[i];
        if (enter(box_of(node.lower, node.upper))) {
            if (node.skip != 0) {
                later[waiting++] = i + node.skip;
                ++i;
                continue;
            }
            for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
                if (enter(boxes_[k]) && !leaf(order_[k])) return;
            }
        }
        if (waiting == 0) return;
        i = later[--waiting];
    }
}

void Compound::overlap(const Aabb& box, FunctionRef<bool(std::uint32_t)> visit) const {
    descend([&](const Aabb& node) { return overlaps(node, box); }, [&](std::uint32_t part) { return visit(part); });
}

void Compound::along(const dvec3& origin, const dvec3& direction, double reach, FunctionRef<double(std::uint32_t)> visit) const {
    descend([&](const Aabb& node) { return meets(node, origin, direction, reach); },
            [&](std::uint32_t part) {
                reach = visit(part);
                return true;
            });
}

void Compound::visit_nodes(FunctionRef<void(const Aabb&, int)> visit) const {
    std::vector<std::pair<std::uint32_t, int>> stack{{0, 0}};
    while (!stack.empty()) {
        const auto [i, depth] = stack.back();
        stack.pop_back();
        visit(box_of(nodes_[i].lower, nodes_[i].upper), depth);
        if (nodes_[i].skip == 0) continue;
        stack.push_back({i + nodes_[i].skip, depth + 1});
        stack.push_back({i + 1, depth + 1});
    }
}

// The parts that are hit at one distance: the lowest.
std::optional<RayHit> cast_local(const Compound& compound, const LocalRay& ray) noexcept {
    std::optional<RayHit> best;
    double reach = ray.max_distance;
    compound.along(ray.origin, ray.direction, reach, [&](std::uint32_t index) {
        const CompoundPart& part = compound.parts()[index];
        std::optional<RayHit> hit = cast_ray(part.shape, part.pose, Ray{ray.origin, ray.direction, reach});
        if (hit && (!best || hit->distance < best->distance || (hit->distance == best->distance && index < best->part))) {
            hit->part = index;
            best = hit;
            reach = hit->distance;
        }
        return reach;
    });
    return best;
}

}  // namespace carom
