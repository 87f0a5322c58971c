// Carom behind the interface of its peers.
#include <carom/studies/accuracy/engine.hpp>

#include <utility>

namespace carom::accuracy {
namespace {

class CaromEngine final : public Engine {
public:
    explicit CaromEngine(World world) : world_(std::move(world)), moving_(moving_bodies(world_)) {}

    std::string name() const override { return "carom"; }
    std::string version() const override { return CAROM_VERSION; }
    void step(double dt) override { world_.step(dt); }
    Pose pose(std::size_t index) const override { return world_.pose(moving_[index]); }
    dvec3 velocity(std::size_t index) const override { return world_.linear_velocity(moving_[index]); }
    dvec3 spin(std::size_t index) const override { return world_.angular_velocity(moving_[index]); }

private:
    World world_;
    std::vector<BodyId> moving_;
};

}  // namespace

std::unique_ptr<Engine> make_carom(World world) { return std::make_unique<CaromEngine>(std::move(world)); }

}  // namespace carom::accuracy
