// A user's program that casts a ray and links nothing of dynamics.
#include <carom/collision/ray_cast.hpp>

int main() {
    const carom::Ray down{.origin = {0, 3, 0}, .direction = {0, -1, 0}};
    return carom::cast_ray(carom::Box{{1.0f, 1.0f, 1.0f}}, carom::Pose{}, down) ? 0 : 1;
}
