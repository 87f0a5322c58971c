// carom::broadphase linked alone.
#include <carom/broadphase/broadphase.hpp>

#include <array>

int main() {
    const std::array<carom::FloatAabb, 2> bounds{{{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}}};
    const std::array<carom::ProxyFilter, 2> filters{};
    carom::SerialExecutor executor;
    carom::Broadphase broadphase;
    const std::array<std::uint32_t, 2> moved{0, 1};
    return broadphase.update({.bounds = bounds, .filters = filters, .moved = moved}, executor).pairs.size() == 1 ? 0 : 1;
}
