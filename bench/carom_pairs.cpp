#include <carom/bench/pair_finder.hpp>

#include <numeric>

namespace carom::bench {
namespace {

std::vector<std::uint32_t> all_slots(std::size_t count) {
    std::vector<std::uint32_t> slots(count);
    std::iota(slots.begin(), slots.end(), 0u);
    return slots;
}

class CaromPairs final : public PairFinder {
public:
    CaromPairs(std::span<const FloatAabb> boxes, bool from_scratch)
        : filters_(boxes.size()), all_(all_slots(boxes.size())), from_scratch_(from_scratch) {
        update(boxes, all_);
    }
    std::string name() const override { return "carom"; }
    std::string version() const override { return CAROM_VERSION; }
    void update(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> moved) override {
        if (from_scratch_) broadphase_.clear();
        broadphase_.update({.bounds = boxes, .filters = filters_, .moved = from_scratch_ ? std::span(all_) : moved}, executor_);
    }
    std::vector<ProxyPair> pairs() const override {
        const std::span<const ProxyPair> found = broadphase_.result().pairs;
        return {found.begin(), found.end()};
    }

private:
    SerialExecutor executor_;
    Broadphase broadphase_;
    std::vector<ProxyFilter> filters_;
    std::vector<std::uint32_t> all_;
    bool from_scratch_;
};

}  // namespace

std::unique_ptr<PairFinder> make_carom_pairs(std::span<const FloatAabb> boxes) { return std::make_unique<CaromPairs>(boxes, false); }
std::unique_ptr<PairFinder> make_carom_scratch(std::span<const FloatAabb> boxes) { return std::make_unique<CaromPairs>(boxes, true); }

}  // namespace carom::bench
