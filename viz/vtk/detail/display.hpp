// Is there a display to draw on? VTK ends the process where there is none, so we ask before it does.
#pragma once

#include <carom/core/result.hpp>

namespace carom::detail {

/// @return Io where DISPLAY is not set or no X server answers there.
[[nodiscard]] Status check_display();

}  // namespace carom::detail
