#include <carom/broadphase/detail/pair_pieces.hpp>

#include <algorithm>

namespace carom::detail {

void PairBuffer::grow(std::size_t count) {
    const std::size_t more = first_.size() + first_.size() / 2, size = std::max(more, count_ + count);
    for (std::vector<std::int32_t>* slots : {&second_, &first_}) {  // the first, by which room is told, once there is room in both
        slots->reserve(size);  // no more: vectors double as they are resized
        slots->resize(size);
    }
}

}  // namespace carom::detail
