#include <carom/dynamics/detail/scratch_pool.hpp>

#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <new>

namespace carom::dynamics {
namespace {

constexpr std::size_t kFew = 65536;  // [bytes] that are not worth a new allocation

}  // namespace

ScratchPool::Block ScratchPool::take(std::size_t size) {
    auto best = free_.end();
    for (auto block = free_.begin(); block != free_.end(); ++block) {
        if (block->size >= size && (best == free_.end() || block->size < best->size)) best = block;
    }
    Block out;
    if (best != free_.end()) {
        out = *best;
        free_.erase(best);
    } else {
        const auto largest = std::ranges::max_element(free_, {}, &Block::size);
        if (largest != free_.end()) {
            free(*largest);
            free_.erase(largest);
        }
        free_.reserve(blocks_ + 1);  // so that all can be given back
        out.size = with_room(size);
        out.data = static_cast<std::byte*>(::operator new(out.size, std::align_val_t{kAlignment}));
        held_ += out.size;
        ++blocks_;
    }
    out.asked = size;
    asked_ += size;
    most_asked_ = std::max(most_asked_, asked_);
    return out;
}

void ScratchPool::give_back(Block block) noexcept {
    asked_ -= block.asked;
    free_.push_back(block);
}

void ScratchPool::trim() noexcept {
    if (held_ > most_asked_ + most_asked_ / 4 + kFew) drop();
    most_asked_ = asked_;
}

void ScratchPool::drop() noexcept {
    for (const Block block : free_) free(block);
    free_.clear();
}

void ScratchPool::free(Block block) noexcept {
    held_ -= block.size;
    --blocks_;
    ::operator delete(block.data, std::align_val_t{kAlignment});
}

}  // namespace carom::dynamics
