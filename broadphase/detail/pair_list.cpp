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
    if (bounds.size() > kIndexMask) return "more than 2^29 - 1 boxes";
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
        for (PairBuffer& piece : pieces) {
            piece.keep_if([&](std::uint32_t a, std::uint32_t b) { return agree(filters[a], filters[b]); });
        }
    }
    next_of_a_.assign(n, 0);
    next_of_b_.assign(n, 0);
    count_ = 0;
    for (const PairBuffer& piece : pieces) {
        for (std::size_t i = 0; i < piece.size(); ++i) {
            ++next_of_a_[piece.lesser(i)];
            ++next_of_b_[piece.greater(i)];
        }
        count_ += piece.size();
    }
    accumulate(next_of_a_);
    accumulate(next_of_b_);
    grow(a_by_b_, count_);
    grow(pairs_, count_);
    for (const PairBuffer& piece : pieces) {
        for (std::size_t i = 0; i < piece.size(); ++i) a_by_b_[next_of_b_[piece.greater(i)]++] = piece.lesser(i);
    }
    std::size_t i = 0;
    for (std::uint32_t b = 0; b < n; ++b) {
        for (; i < next_of_b_[b]; ++i) pairs_[next_of_a_[a_by_b_[i]]++] = {a_by_b_[i], b};
    }
}

}  // namespace carom::detail
