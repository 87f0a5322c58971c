// Debug layers as VTK's polygonal data.
#pragma once

#include <carom/viz/debug_frame.hpp>

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace carom::detail {

/// Which primitives of a layer to convert.
struct PolyDataParts {
    bool points = true, lines = true, triangles = true, texts = true;
};

/// Cells come in VTK's order: vertices (points, then texts), lines, triangles, each in the order of the layer.
/// Cell arrays color, body_slot, body_generation; point array Normals where there are triangles, text where there are texts.
[[nodiscard]] vtkSmartPointer<vtkPolyData> make_polydata(const DebugLayer& layer, const PolyDataParts& parts);

}  // namespace carom::detail
