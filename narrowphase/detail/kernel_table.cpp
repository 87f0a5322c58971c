// Which kernel serves which pair of types. Every pair but two planes has one.
#include <carom/narrowphase/detail/kernels.hpp>

namespace carom {
namespace detail {
namespace {

struct Row {
    ShapeType first;
    ShapeType second;
    Kernel kernel = nullptr;
    WideKernel wide = nullptr;
};

constexpr Row kRows[] = {
    {ShapeType::Sphere, ShapeType::Sphere, sphere_sphere, sphere_sphere_lanes},
    {ShapeType::Sphere, ShapeType::Box, sphere_box, sphere_box_lanes},
    {ShapeType::Sphere, ShapeType::Capsule, sphere_capsule, sphere_capsule_lanes},
    {ShapeType::Sphere, ShapeType::Plane, sphere_plane, sphere_plane_lanes},
    {ShapeType::Box, ShapeType::Box, box_box_alone, box_box},
    {ShapeType::Box, ShapeType::Plane, box_plane, box_plane_lanes},
    {ShapeType::Capsule, ShapeType::Capsule, capsule_capsule, capsule_capsule_lanes},
    {ShapeType::Capsule, ShapeType::Plane, capsule_plane, capsule_plane_lanes},
    {ShapeType::Capsule, ShapeType::Box, capsule_box, capsule_box_lanes},
    {ShapeType::Capsule, ShapeType::ConvexHull, capsule_hull},
    {ShapeType::Sphere, ShapeType::ConvexHull, sphere_hull},
    {ShapeType::Box, ShapeType::ConvexHull, box_hull},
    {ShapeType::ConvexHull, ShapeType::ConvexHull, hull_hull},
    {ShapeType::ConvexHull, ShapeType::Plane, hull_plane},
    {ShapeType::Sphere, ShapeType::TriangleMesh, sphere_mesh},
    {ShapeType::Box, ShapeType::TriangleMesh, box_mesh},
    {ShapeType::Capsule, ShapeType::TriangleMesh, capsule_mesh},
    {ShapeType::ConvexHull, ShapeType::TriangleMesh, hull_mesh},
    {ShapeType::TriangleMesh, ShapeType::TriangleMesh, mesh_mesh},
    {ShapeType::TriangleMesh, ShapeType::Plane, mesh_plane},
    {ShapeType::Cylinder, ShapeType::Sphere, turned_sphere},
    {ShapeType::Cylinder, ShapeType::Box, turned_box},
    {ShapeType::Cylinder, ShapeType::Capsule, turned_capsule},
    {ShapeType::Cylinder, ShapeType::Plane, turned_plane},
    {ShapeType::Cylinder, ShapeType::ConvexHull, turned_hull},
    {ShapeType::Cylinder, ShapeType::TriangleMesh, turned_mesh},
    {ShapeType::Cylinder, ShapeType::Cylinder, turned_turned},
    {ShapeType::Cone, ShapeType::Sphere, turned_sphere},
    {ShapeType::Cone, ShapeType::Box, turned_box},
    {ShapeType::Cone, ShapeType::Capsule, turned_capsule},
    {ShapeType::Cone, ShapeType::Plane, turned_plane},
    {ShapeType::Cone, ShapeType::ConvexHull, turned_hull},
    {ShapeType::Cone, ShapeType::TriangleMesh, turned_mesh},
    {ShapeType::Cone, ShapeType::Cylinder, turned_turned},
    {ShapeType::Cone, ShapeType::Cone, turned_turned},
    {ShapeType::Compound, ShapeType::Sphere, compound_any},
    {ShapeType::Compound, ShapeType::Box, compound_any},
    {ShapeType::Compound, ShapeType::Capsule, compound_any},
    {ShapeType::Compound, ShapeType::Plane, compound_plane},
    {ShapeType::Compound, ShapeType::ConvexHull, compound_any},
    {ShapeType::Compound, ShapeType::TriangleMesh, compound_any},
    {ShapeType::Compound, ShapeType::Cylinder, compound_any},
    {ShapeType::Compound, ShapeType::Cone, compound_any},
    {ShapeType::Compound, ShapeType::Compound, compound_any},
};

struct Table {
    KernelEntry entries[kShapeTypeCount][kShapeTypeCount];
};

constexpr Table make_table() {
    Table table{};
    for (const Row& row : kRows) {
        const auto a = static_cast<std::size_t>(row.first);
        const auto b = static_cast<std::size_t>(row.second);
        table.entries[b][a] = {row.kernel, row.wide, true};
        table.entries[a][b] = {row.kernel, row.wide, false};
    }
    return table;
}

constexpr Table kTable = make_table();

}  // namespace

const KernelEntry& kernel_for(ShapeType a, ShapeType b) noexcept {
    return kTable.entries[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
}

}  // namespace detail

bool can_collide(ShapeType a, ShapeType b) noexcept { return detail::kernel_for(a, b).exists(); }

}  // namespace carom
