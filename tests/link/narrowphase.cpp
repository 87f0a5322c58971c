// carom::narrowphase linked alone.
#include <carom/narrowphase/collide.hpp>

int main() {
    const carom::Shape ball = carom::Sphere{1.0f};
    carom::ShapePair pair;
    pair.a = &ball;
    pair.b = &ball;
    pair.pose_b.position = {1.5, 0, 0};
    std::vector<carom::Manifold> manifolds;
    const carom::CollideStatus status = carom::collide(pair, 0, manifolds);
    return status == carom::CollideStatus::Ok && manifolds.size() == 1 ? 0 : 1;
}
