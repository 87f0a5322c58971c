// carom::broadphase linked alone.
#include <carom/broadphase/broadphase.hpp>

#include <array>

int main() {
    const std::array<carom::FloatAabb, 2> bounds{{{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}}};
    const std::array<carom::ProxyFilter, 2> filters{};
    carom::SerialExecutor executor;
    const auto broadphase = carom::make_broadphase(carom::BroadphaseMethod::SweepAndPrune);
    return broadphase->update(bounds, filters, executor).size() == 1 ? 0 : 1;
}
