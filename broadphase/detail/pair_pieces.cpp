#include <carom/broadphase/detail/pair_pieces.hpp>

#include <algorithm>
#include <utility>

namespace carom::detail {

void PairBuffer::grow(std::size_t count) {
    const std::size_t more = first_.size() + first_.size() / 2, size = std::max(more, count_ + count);
    for (std::vector<std::int32_t>* slots : {&second_, &first_}) {  // the first, by which room is told, once there is room in both
        slots->reserve(size);  // no more: vectors double as they are resized
        slots->resize(size);
    }
}

void PairBuffer::trim() {
    constexpr std::size_t kFew = 1024, kSpare = 8, kRoom = 16;
    clear(limit_);
    const std::size_t needed = std::exchange(most_, 0) + kReadAhead;
    if (first_.size() <= needed + needed / kSpare + kFew) return;
    const std::size_t size = needed + needed / kRoom;
    std::vector<std::int32_t>().swap(first_), std::vector<std::int32_t>().swap(second_);
    for (std::vector<std::int32_t>* slots : {&second_, &first_}) {  // as in grow()
        slots->reserve(size);
        slots->resize(size);
    }
}

}  // namespace carom::detail
