#include <carom/viz/vtk/detail/display.hpp>

#include <X11/Xlib.h>
#undef Status  // Xlib's macro for int

#include <cstdlib>
#include <map>
#include <mutex>
#include <string>

namespace carom::detail {

Status check_display() {
    const char* name = std::getenv("DISPLAY");
    if (name == nullptr || *name == '\0') {
        return Error{ErrorCode::Io, "there is no display: DISPLAY is not set (on a machine without a screen: xvfb-run -a -s "
                                    "\"-screen 0 1280x1024x24\" ...)", "DISPLAY"};
    }
    Display* display = XOpenDisplay(name);
    if (display == nullptr) {
        return Error{ErrorCode::Io, std::string("no X server answers at DISPLAY=") + name, "DISPLAY"};
    }
    // Xvfb starts over when its last client leaves, and for a moment answers nobody: VTK, which connects next, would abort. So
    // the first connection to each server stays for as long as the process does, and so does the map that knows them.
    static std::mutex mutex;
    static auto& kept = *new std::map<std::string, Display*>();
    const std::scoped_lock lock(mutex);
    if (!kept.emplace(name, display).second) XCloseDisplay(display);
    return {};
}

}  // namespace carom::detail
