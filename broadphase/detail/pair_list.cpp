#include <carom/broadphase/detail/pair_list.hpp>

#include <algorithm>
#include <utility>

namespace carom::detail {
namespace {

// True if one layer bit is in every layer and every mask, as with filters that nobody has set: then all agree.
bool all_agree(std::span<const ProxyFilter> filters) noexcept {
    std::uint64_t common = ~std::uint64_t{0};
    for (const ProxyFilter& filter : filters) common &= filter.layer & filter.mask;
    return common != 0;
}

bool agree(const ProxyFilter& a, const ProxyFilter& b) noexcept {
    return (a.layer & b.mask) != 0 && (b.layer & a.mask) != 0;
}

void drop_disagreeing(PairBuffer& piece, std::span<const ProxyFilter> filters) noexcept {
    std::uint64_t* const keys = piece.data();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
        const std::uint64_t key = keys[i];
        if (agree(filters[key >> 32], filters[key & 0xffffffffu])) keys[kept++] = key;
    }
    piece.keep_first(kept);
}

// Counts to places: the sum of all counts before.
void accumulate(std::vector<std::uint32_t>& counts) noexcept {
    std::uint32_t start = 0;
    for (std::uint32_t& count : counts) start += std::exchange(count, start);
}

template <class T>
void grow(std::vector<T>& v, std::size_t size) {
    if (v.size() < size) v.resize(std::max(size, v.size() + v.size() / 2));
}

}  // namespace

const char* find_fault(std::span<const FloatAabb> bounds, std::span<const ProxyFilter> filters) noexcept {
    if (bounds.size() != filters.size()) return "bounds and filters differ in size";
    if (bounds.size() > kIndexMask) return "more than 2^30 - 1 boxes";
    bool ordered = true, finite = true;
    for (const FloatAabb& box : bounds) {
        ordered &= (box.lower.x <= box.upper.x) & (box.lower.y <= box.upper.y) & (box.lower.z <= box.upper.z);
        // The difference of two floats of either sign is finite in double.
        const double sum = (double(box.lower.x) - double(box.upper.x)) + (double(box.lower.y) - double(box.upper.y)) +
                           (double(box.lower.z) - double(box.upper.z));
        finite &= sum - sum == 0.0;
    }
    if (!finite) return "a bound is not finite";
    return ordered ? nullptr : "a box has lower > upper";
}

void PairList::begin(std::size_t pieces) {
    if (pieces_.size() < pieces) pieces_.resize(pieces);
    piece_count_ = pieces;
    for (std::size_t k = 0; k < pieces; ++k) pieces_[k].clear();
}

// Two counting sorts with whole indices as digits: by b, then stably by a.
void PairList::finish(std::span<const ProxyFilter> filters) {
    const std::size_t n = filters.size();
    const std::span<PairBuffer> pieces(pieces_.data(), piece_count_);
    if (!all_agree(filters)) {
        for (PairBuffer& piece : pieces) drop_disagreeing(piece, filters);
    }
    starts_a_.assign(n, 0);
    starts_b_.assign(n, 0);
    count_ = 0;
    for (const PairBuffer& piece : pieces) {
        for (std::size_t i = 0; i < piece.size(); ++i) {
            ++starts_a_[piece.data()[i] >> 32];
            ++starts_b_[piece.data()[i] & 0xffffffffu];
        }
        count_ += piece.size();
    }
    accumulate(starts_a_);
    accumulate(starts_b_);
    grow(by_b_, count_);
    grow(pairs_, count_);
    for (const PairBuffer& piece : pieces) {
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const std::uint64_t key = piece.data()[i];
            by_b_[starts_b_[key & 0xffffffffu]++] = key;
        }
    }
    for (std::size_t i = 0; i < count_; ++i) {
        const auto a = static_cast<std::uint32_t>(by_b_[i] >> 32);
        pairs_[starts_a_[a]++] = {a, static_cast<std::uint32_t>(by_b_[i])};
    }
}

}  // namespace carom::detail
