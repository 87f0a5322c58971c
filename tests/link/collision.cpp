// carom::collision linked alone.
#include <carom/collision/ray_cast.hpp>

int main() {
    const carom::Ray down{.origin = {0, 3, 0}, .direction = {0, -1, 0}};
    const auto hit = carom::cast_ray(carom::Sphere{1.0f}, carom::Pose{}, down);
    return hit && hit->distance > 1.999 && hit->distance < 2.001 ? 0 : 1;
}
