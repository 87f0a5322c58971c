#include <carom/broadphase/detail/pair_pieces.hpp>

namespace carom::detail {

void PairBuffer::grow(std::size_t count) {
    const std::size_t doubled = 2 * first_.size(), needed = count_ + count;
    first_.resize(doubled > needed ? doubled : needed);
    second_.resize(first_.size());
}

}  // namespace carom::detail
