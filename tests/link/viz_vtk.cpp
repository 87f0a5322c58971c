// carom::viz_vtk linked alone. Reading needs no display.
#include <carom/viz/vtk/vtp_series.hpp>

int main() {
    const auto parts = carom::read_vtp_series("no such file.pvd");
    return !parts && parts.error().code == carom::ErrorCode::Io ? 0 : 1;
}
