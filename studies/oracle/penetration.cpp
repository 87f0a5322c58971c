#include <carom/studies/oracle/penetration.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/studies/oracle/polytope.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace carom::oracle {
namespace {

/// One placed convex shape, with its exact box.
struct Item {
    const Shape* shape = nullptr;
    const ShapeDef* def = nullptr;
    BodyId body;
    Pose pose;
    Aabb box{};
    bool dynamic = false;
    std::optional<Round> round{};
    std::optional<Polytope> polytope{};  ///< of a hull at once, of a box when it is first asked for
};

/// One mesh or plane.
struct Ground {
    const Shape* shape = nullptr;
    const ShapeDef* def = nullptr;
    BodyId body;
    Pose pose;
};

struct Inventory {
    std::vector<Item> items;
    std::vector<Ground> grounds;
};

class Tally {
public:
    void add(double depth) {
        if (!(depth > 0.0)) return;
        maximum_ = std::max(maximum_, depth);
        sum_ += depth;
        ++pairs_;
    }
    [[nodiscard]] PenetrationSummary summary() const {
        return {maximum_, pairs_ == 0 ? 0.0 : sum_ / static_cast<double>(pairs_), pairs_};
    }

private:
    double maximum_ = 0.0;
    double sum_ = 0.0;
    std::size_t pairs_ = 0;
};

bool may_meet(const ShapeDef& a, const ShapeDef& b) { return (a.layer & b.mask) != 0 && (b.layer & a.mask) != 0; }

Aabb box_of_points(std::span<const dvec3> points, double margin) {
    Aabb box;
    for (const dvec3& p : points) box = merge(box, {p, p});
    return inflate(box, margin);
}

/// @param shape, pose  of the shape `id` or of a part of it, in the world.
Item make_item(const World& world, BodyId body, ShapeId id, const Shape& shape, const Pose& pose) {
    Item item{.shape = &shape, .def = &world.shape_def(id), .body = body, .pose = pose};
    item.dynamic = world.type(body) == BodyType::Dynamic;
    item.round = make_round(*item.shape, item.pose);
    if (item.round) {
        const dvec3 ends[] = {item.round->a, item.round->b};
        item.box = box_of_points(ends, item.round->radius);
    } else if (const Box* box = std::get_if<Box>(item.shape)) {
        const dmat3 axes = glm::mat3_cast(item.pose.orientation);
        const dvec3 half(box->half_extents);
        const dvec3 reach = glm::abs(axes[0]) * half.x + glm::abs(axes[1]) * half.y + glm::abs(axes[2]) * half.z;
        item.box = {item.pose.position - reach, item.pose.position + reach};
    } else {
        item.polytope = make_polytope(*item.shape, item.pose);
        item.box = box_of_points(item.polytope->vertices, 0.0);
        item.box = {item.box.lower + item.pose.position, item.box.upper + item.pose.position};
    }
    return item;
}

Inventory take_inventory(const World& world) {
    Inventory inventory;
    for (const BodyId body : world.bodies()) {
        if (world.is_quarantined(body)) continue;
        for (const ShapeId id : world.shapes(body)) {
            const ShapeType type = type_of(world.shape(id));
            if (type == ShapeType::Plane || type == ShapeType::TriangleMesh) {
                inventory.grounds.push_back({&world.shape(id), &world.shape_def(id), body, world.shape_pose(id)});
            } else if (const CompoundPtr* compound = std::get_if<CompoundPtr>(&world.shape(id))) {
                for (const CompoundPart& part : (*compound)->parts()) {
                    inventory.items.push_back(make_item(world, body, id, part.shape, world.shape_pose(id) * part.pose));
                }
            } else {
                inventory.items.push_back(make_item(world, body, id, world.shape(id), world.shape_pose(id)));
            }
        }
    }
    return inventory;
}

const Polytope& polytope_of(Item& item) {
    if (!item.polytope) item.polytope = make_polytope(*item.shape, item.pose);
    return *item.polytope;
}

double depth_of(Item& a, Item& b) {
    if (a.round && b.round) return overlap_depth(*a.round, *b.round);
    if (a.round) return overlap_depth(*a.round, polytope_of(b));
    if (b.round) return overlap_depth(*b.round, polytope_of(a));
    const Box* box_a = std::get_if<Box>(a.shape);
    const Box* box_b = std::get_if<Box>(b.shape);
    if (box_a != nullptr && box_b != nullptr) return overlap_depth(*box_a, a.pose, *box_b, b.pose);
    return overlap_depth(polytope_of(a), polytope_of(b));
}

/// @return the axis along which the boxes' centres are spread most.
int widest_axis(const std::vector<Item>& items) {
    dvec3 mean{0.0};
    for (const Item& item : items) mean += 0.5 * (item.box.lower + item.box.upper);
    mean /= static_cast<double>(std::max<std::size_t>(items.size(), 1));
    dvec3 spread{0.0};
    for (const Item& item : items) {
        const dvec3 from = 0.5 * (item.box.lower + item.box.upper) - mean;
        spread += from * from;
    }
    return spread.x >= spread.y && spread.x >= spread.z ? 0 : (spread.y >= spread.z ? 1 : 2);
}

/// Calls visit(a, b) for every two items whose boxes overlap, at least one of them dynamic, of different bodies.
template <class Visit>
void sweep(std::vector<Item>& items, Visit visit) {
    const int axis = widest_axis(items);
    struct Entry {
        Aabb box;
        std::uint32_t item = 0;
        bool dynamic = false;
    };
    std::vector<Entry> entries;
    entries.reserve(items.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) entries.push_back({items[i].box, i, items[i].dynamic});
    std::ranges::stable_sort(entries, {}, [axis](const Entry& e) { return e.box.lower[axis]; });
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Entry& a = entries[i];
        for (std::size_t j = i + 1; j < entries.size() && entries[j].box.lower[axis] <= a.box.upper[axis]; ++j) {
            const Entry& b = entries[j];
            if ((a.dynamic || b.dynamic) && overlaps(a.box, b.box)) visit(items[a.item], items[b.item]);
        }
    }
}

/// The samples of a shape in the ground's frame: points, and the radius about them.
struct Samples {
    std::vector<dvec3> points;
    dvec3 centre{0.0};  ///< their mean
    double radius = 0.0;
    double reach = 0.0;  ///< how deep a sample is looked for [m]
};

Samples samples_of(Item& item, const Pose& frame) {
    Samples samples;
    if (item.round) {
        samples.points = {item.round->a, item.round->b};
        samples.radius = item.round->radius;
    } else {
        const Polytope& polytope = polytope_of(item);
        for (const dvec3& v : polytope.vertices) samples.points.push_back(polytope.position + v);
    }
    for (dvec3& point : samples.points) {
        point = inverse_transform_point(frame, point);
        samples.centre += point / static_cast<double>(samples.points.size());
    }
    for (const dvec3& point : samples.points) samples.reach = std::max(samples.reach, glm::distance(point, samples.centre));
    samples.reach += samples.radius;
    return samples;
}

double plane_depth(const Samples& samples, const Plane& plane) {
    const dvec3 normal(plane.normal);
    const double length = glm::length(normal);  // unit to float's accuracy only
    double deepest = -std::numeric_limits<double>::infinity();
    for (const dvec3& point : samples.points) {
        const double height = (glm::dot(normal, point) - static_cast<double>(plane.offset)) / length;
        deepest = std::max(deepest, samples.radius - height);
    }
    return deepest;
}

/// The triangle nearest to a sample. Of several at the same distance (a shared edge or corner) the one that faces the
/// sample most tells on which side the sample is.
struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    double facing = -1.0;  ///< |height over the triangle's plane|
    double height = 0.0;   ///< signed distance from the triangle's plane

    void offer(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
        const dvec3 normal = glm::cross(b - a, c - a);
        const double area = glm::length(normal);
        if (area == 0.0) return;
        const double d = glm::distance(p, closest_on_triangle(p, a, b, c));
        const double tie = 1e-12 * (glm::length(p - a) + d);
        const double h = glm::dot(normal, p - a) / area;
        if (d < distance - tie || (d <= distance + tie && std::abs(h) > facing)) {
            distance = d;
            height = h;
            facing = std::abs(h);
        }
    }
};

double mesh_depth(const Samples& samples, const TriangleMesh& mesh) {
    std::vector<Nearest> nearest(samples.points.size());
    Nearest of_centre;
    mesh.overlap(box_of_points(samples.points, samples.reach), [&](std::uint32_t triangle) {
        const std::array<vec3, 3> corners = mesh.corners(triangle);
        const dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
        for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i].offer(samples.points[i], a, b, c);
        of_centre.offer(samples.centre, a, b, c);
        return true;
    });
    double deepest = -std::numeric_limits<double>::infinity();
    if (mesh.is_one_sided() && of_centre.height < 0.0) return deepest;  // it is on its way through, and may be
    for (const Nearest& n : nearest) {
        if (n.distance > samples.reach) continue;
        deepest = std::max(deepest, samples.radius - (n.height < 0.0 ? -n.distance : n.distance));
    }
    return deepest;
}

void tally_grounds(Inventory& inventory, Tally& tally) {
    for (const Ground& ground : inventory.grounds) {
        for (Item& item : inventory.items) {
            if (!item.dynamic || item.body == ground.body || !may_meet(*item.def, *ground.def)) continue;
            const Samples samples = samples_of(item, ground.pose);
            if (const Plane* plane = std::get_if<Plane>(ground.shape)) {
                tally.add(plane_depth(samples, *plane));
            } else {
                tally.add(mesh_depth(samples, *std::get<TriangleMeshPtr>(*ground.shape)));
            }
        }
    }
}

}  // namespace

Penetration geometric_penetration(const World& world, const PenetrationSettings& settings) {
    Inventory inventory = take_inventory(world);
    Tally polytopes, round, terrain;
    if (settings.polytopes || settings.round) {
        sweep(inventory.items, [&](Item& a, Item& b) {
            const bool is_round = a.round || b.round;
            if (!(is_round ? settings.round : settings.polytopes)) return;
            if (a.body == b.body || !may_meet(*a.def, *b.def)) return;
            (is_round ? round : polytopes).add(depth_of(a, b));
        });
    }
    if (settings.terrain) tally_grounds(inventory, terrain);
    return {polytopes.summary(), round.summary(), terrain.summary()};
}

}  // namespace carom::oracle
