// carom::core linked alone.
#include <carom/core/math.hpp>

int main() {
    const carom::SinCos unit = carom::sin_cos(0.0);
    return unit.sin == 0.0 && unit.cos == 1.0 ? 0 : 1;
}
