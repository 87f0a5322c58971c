// Buffers of the kernels, one set a thread, that grow once and are reused.
#pragma once

#include <carom/narrowphase/detail/polygon_contact.hpp>

#include <vector>

namespace carom::detail {

struct Workspace {
    PolygonScratch polygons;
};

/// @return the calling thread's buffers.
[[nodiscard]] Workspace& thread_workspace();

}  // namespace carom::detail
