#include <carom/dynamics/detail/body_parts.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr int kBins = 512;
constexpr int kMostAge = 16;

}  // namespace

void BodyParts::note(std::uint32_t slot, const dvec3& at) noexcept {
    const auto cuts = std::span{cuts_}.first(count_ - 1);
    part_of_slot_[slot] = static_cast<unsigned char>(std::count_if(cuts.begin(), cuts.end(), [&](double cut) { return at[axis_] >= cut; }));
}

void BodyParts::choose(std::span<const std::uint32_t> slots, std::span<const std::uint32_t> weights, std::span<const BodyState> states,
                       std::size_t parts) {
    count_ = std::clamp<std::size_t>(parts, 1, kMostParts);
    dvec3 mean{0.0}, spread{0.0};
    const double share = slots.empty() ? 0.0 : 1.0 / static_cast<double>(slots.size());
    for (const std::uint32_t slot : slots) mean += share * states[slot].pose.position;
    for (const std::uint32_t slot : slots) {
        const dvec3 off = states[slot].pose.position - mean;
        spread += share * off * off;
    }
    axis_ = spread.x >= spread.y ? (spread.x >= spread.z ? 0 : 2) : (spread.y >= spread.z ? 1 : 2);
    const double width = 2.0 * std::sqrt(3.0 * spread[axis_]);  // of what is evenly spread; the bins at the ends take what is beyond
    const double low = mean[axis_] - 0.5 * width, bins_a_metre = width > 0.0 ? kBins / width : 0.0;
    std::array<std::size_t, kBins> sums{};
    std::size_t all = 0;
    for (const std::uint32_t slot : slots) {
        const double bin = (states[slot].pose.position[axis_] - low) * bins_a_metre;
        sums[static_cast<std::size_t>(std::clamp(bin, 0.0, kBins - 1.0))] += weights[slot];
        all += weights[slot];
    }
    std::size_t below = 0, cut = 0;
    for (int bin = 0; bin < kBins && cut + 1 < count_; ++bin) {
        below += sums[static_cast<std::size_t>(bin)];
        for (; cut + 1 < count_ && below * count_ >= (cut + 1) * all; ++cut) cuts_[cut] = low + (bin + 1.0) / kBins * width;
    }
    for (const std::uint32_t slot : slots) note(slot, states[slot].pose.position);
}

void BodyParts::keep_up(std::span<const std::uint32_t> slots, std::span<const ContactPair> pairs, std::span<const BodyState> states,
                        std::size_t parts) {
    const bool changed = parts != count_ || 8 * slots.size() > 9 * bodies_ || 8 * slots.size() < 7 * bodies_;
    if (!changed && ++age_ < kMostAge) return;
    age_ = 0;
    bodies_ = slots.size();
    weights_.assign(states.size(), 1);
    for (const ContactPair& pair : pairs) {
        for (const std::uint32_t slot : {pair.body_a.slot, pair.body_b.slot}) weights_[slot] += pair.manifold_count;
    }
    choose(slots, weights_, states, parts);
}

}  // namespace carom::dynamics
