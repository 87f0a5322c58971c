#include <carom/broadphase/detail/pair_pieces.hpp>

namespace carom::detail {

void PairBuffer::grow(std::size_t count) {
    const std::size_t doubled = 2 * lesser_.size(), needed = count_ + count;
    lesser_.resize(doubled > needed ? doubled : needed);
    greater_.resize(lesser_.size());
}

}  // namespace carom::detail
