#include <carom/narrowphase/detail/batch_boxes.hpp>
#include <carom/narrowphase/detail/batch_check.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <algorithm>
#include <numeric>

namespace carom::detail {

bool are_few_boxes(const BatchInput& input) noexcept {
    if (input.pairs.size() > kFewBoxes) return false;
    return std::ranges::all_of(
        input.pairs, [shapes = input.placed.shapes.data(), count = input.placed.shapes.size()](const NumberedPair& pair) {
            if (!is_plain(pair, count)) return false;
            const Shape *const a = shapes[pair.a], *const b = shapes[pair.b];
            return a != nullptr && b != nullptr && std::holds_alternative<Box>(*a) && std::holds_alternative<Box>(*b);
        });
}

bool are_boxes(std::span<const std::uint16_t> kinds) noexcept {
    constexpr std::size_t kBox = static_cast<std::size_t>(ShapeType::Box);
    return std::ranges::all_of(kinds, [](std::size_t kind) { return kind == kind_of(kBox, kBox); });
}

// Of `count` pairs from `begin` on.
bool BoxBatch::find(const BatchInput& input, std::size_t begin, std::size_t count, ManifoldList& found) {
    if (order_.size() < count || (count > 0 && order_.front() != begin)) {
        order_.resize(count);
        std::iota(order_.begin(), order_.end(), static_cast<std::uint32_t>(begin));
    }
    return box_box_proving(input, std::span(order_).first(count), thread_workspace(), found);
}

void BoxBatch::give(std::size_t begin, std::size_t end, TakeManifolds take) const {
    const std::span<const Manifold> all = found_.manifolds();
    std::size_t next = 0;
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t from = next;
        while (next < all.size() && all[next].pair == i) ++next;
        take(i, all.subspan(from, next - from));
    }
}

bool BoxBatch::find(const BatchInput& input) {
    found_.clear();
    return find(input, 0, input.pairs.size(), found_);
}

void BoxBatch::find(const BatchInput& input, std::vector<Manifold>& out) {
    ManifoldList list;
    list.exchange(out);
    for (std::size_t begin = 0; begin < input.pairs.size(); begin += kBoxBlock) find(input, begin, std::min(kBoxBlock, input.pairs.size() - begin), list);
    list.exchange(out);
}

void BoxBatch::find(const BatchInput& input, TakeManifolds take) {
    for (std::size_t begin = 0; begin < input.pairs.size(); begin += kBoxBlock) {
        const std::size_t count = std::min(kBoxBlock, input.pairs.size() - begin);
        found_.clear();
        find(input, begin, count, found_);
        give(begin, begin + count, take);
    }
}

}  // namespace carom::detail
