// carom::viz_png linked alone.
#include <carom/viz/png/png_file.hpp>

int main() {
    const auto image = carom::read_png("no such file.png");
    return !image && image.error().code == carom::ErrorCode::Io ? 0 : 1;
}
