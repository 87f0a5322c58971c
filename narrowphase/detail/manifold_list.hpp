// Manifolds as kernels append them: what was written before stays in memory, and is not cleared before it is written over.
//
//   list.add().normal = n;                          // one, cleared
//   Manifold* all = list.add_unwritten(16);         // the caller writes all of them
//   list.exchange(vector);                          // the memory of a vector, instead of copies
#pragma once

#include <carom/narrowphase/manifold.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace carom::detail {

class ManifoldList {
public:
    void clear() noexcept { count_ = 0; }
    [[nodiscard]] std::size_t size() const noexcept { return count_; }
    [[nodiscard]] Manifold* data() noexcept { return all_.data(); }
    [[nodiscard]] std::span<const Manifold> manifolds() const noexcept { return {all_.data(), count_}; }
    [[nodiscard]] const Manifold& operator[](std::size_t i) const noexcept { return all_[i]; }

    /// Appends one without points.
    Manifold& add() {
        Manifold& manifold = *add_unwritten(1);
        manifold = Manifold{};
        return manifold;
    }
    /// Appends `n` that hold anything. @return the first of them, valid until the next call.
    Manifold* add_unwritten(std::size_t n) {
        if (all_.size() < count_ + n) all_.resize(count_ + n);
        count_ += n;
        return all_.data() + (count_ - n);
    }
    /// Keeps the first `count` only.
    void shorten(std::size_t count) noexcept { count_ = count; }
    /// Gives away what it holds for the memory of `other`, and is empty.
    void exchange(std::vector<Manifold>& other) {
        all_.resize(count_);
        all_.swap(other);
        count_ = 0;
    }

private:
    std::vector<Manifold> all_;
    std::size_t count_ = 0;  // of those in use
};

}  // namespace carom::detail
