#include <carom/studies/accuracy/integrator_baselines.hpp>

#include <glm/geometric.hpp>

#include <utility>
#include <vector>

namespace carom::accuracy {
namespace {

struct Moving {
    Pose pose;  // of the principal frame
    dvec3 velocity{0.0}, spin{0.0};
    FreeRotation rotation;
    Pose shape_in_mass;
};

/// Steps bodies one by one by `Advance`: (Moving&, gravity, dt).
template <class Advance>
class FreeEngine final : public Engine {
public:
    FreeEngine(const SceneBodies& bodies, std::string name, Advance advance)
        : name_(std::move(name)), gravity_(bodies.gravity), advance_(std::move(advance)) {
        for (const MovingBody& b : bodies.moving) {
            moving_.push_back({b.pose, b.linear_velocity, b.angular_velocity, classify(b.moments), b.shape_in_mass});
        }
    }

    std::string name() const override { return name_; }
    std::string version() const override { return "1"; }
    void step(double dt) override {
        for (Moving& body : moving_) advance_(body, gravity_, dt);
    }
    Pose pose(std::size_t index) const override { return moving_[index].pose * moving_[index].shape_in_mass; }
    dvec3 velocity(std::size_t index) const override { return moving_[index].velocity; }
    dvec3 spin(std::size_t index) const override { return moving_[index].spin; }

private:
    std::string name_;
    dvec3 gravity_;
    Advance advance_;
    std::vector<Moving> moving_;
};

void advance_naively(Moving& body, const dvec3& gravity, double dt) {
    body.velocity += gravity * dt;
    body.pose.position += body.velocity * dt;
    dquat& q = body.pose.orientation;
    const dvec3 momentum = rotate(q, body.rotation.moments * rotate_inverse(q, body.spin));
    body.spin += dt * rotate(q, body.rotation.inverse_moments * rotate_inverse(q, glm::cross(momentum, body.spin)));
    const dquat turned = dquat{0.0, body.spin.x, body.spin.y, body.spin.z} * q;
    q = glm::normalize(q + turned * (0.5 * dt));
}

}  // namespace

std::unique_ptr<Engine> make_semi_implicit_euler(const SceneBodies& bodies) {
    return std::make_unique<FreeEngine<decltype(&advance_naively)>>(bodies, "euler", &advance_naively);
}

std::unique_ptr<Engine> make_rotation(const SceneBodies& bodies, const SpinSettings& settings) {
    const auto advance = [settings](Moving& body, const dvec3& gravity, double dt) {
        body.pose.position += (body.velocity + 0.5 * dt * gravity) * dt;
        body.velocity += gravity * dt;
        Rotation turning{body.pose.orientation, body.spin};
        rotate_free(turning, body.rotation, dt, settings);
        body.pose.orientation = turning.orientation;
        body.spin = turning.spin;
    };
    return std::make_unique<FreeEngine<decltype(advance)>>(bodies, "rotation", advance);
}

}  // namespace carom::accuracy
