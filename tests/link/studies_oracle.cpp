// carom::studies_oracle linked alone.
#include <carom/studies/oracle/ledger.hpp>

int main() {
    carom::World world;
    world.add_shape(world.create_body(), carom::Sphere{0.5f});
    carom::oracle::EnergyLedger ledger(world);
    world.step(1.0 / 60.0);
    ledger.stepped(world);
    return ledger.drift() <= 1e-3 ? 0 : 1;
}
