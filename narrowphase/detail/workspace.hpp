// Buffers of the kernels, one set a thread, that grow once and are reused.
#pragma once

#include <carom/narrowphase/detail/manifold_list.hpp>
#include <carom/narrowphase/detail/mesh_leaders.hpp>
#include <carom/narrowphase/detail/mesh_surface.hpp>
#include <carom/narrowphase/detail/mesh_way_out.hpp>
#include <carom/narrowphase/detail/polygon_contact.hpp>
#include <carom/narrowphase/detail/polytope_axis.hpp>
#include <carom/narrowphase/detail/shape_way_out.hpp>

namespace carom::detail {

struct Workspace {
    Polytope first, second;
    PolygonScratch polygons;
    MeshSurface surface;
    MeshContact meshes;
    WayOutFinder ways;
    ShapeWayOut shape_ways;
    ManifoldList alone;  ///< of a pair by itself
};

/// @return the calling thread's buffers.
[[nodiscard]] Workspace& thread_workspace();

}  // namespace carom::detail
