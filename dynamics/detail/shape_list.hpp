// The shapes of a body in the order in which they came: nearly every body has one, which takes no memory of its own.
//
//   list.push_back(id);
//   for (const ShapeId id : list) ...
#pragma once

#include <carom/core/ids.hpp>

#include <cstddef>
#include <span>
#include <utility>

namespace carom::dynamics {

class ShapeList {
public:
    ShapeList() noexcept = default;
    ShapeList(ShapeList&& other) noexcept { swap(other); }
    ShapeList& operator=(ShapeList&& other) noexcept {
        swap(other);
        return *this;
    }
    ShapeList(const ShapeList&) = delete;
    ShapeList& operator=(const ShapeList&) = delete;
    ~ShapeList() {
        if (size_ > 1) delete[] many_;
    }

    /// Amortised O(1).
    void push_back(ShapeId id) {
        if (size_ == 0) {
            one_ = id;
        } else {
            if ((size_ & (size_ - 1)) == 0) grow();
            many_[size_] = id;
        }
        ++size_;
    }

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
    [[nodiscard]] const ShapeId* begin() const noexcept { return size_ > 1 ? many_ : &one_; }
    [[nodiscard]] const ShapeId* end() const noexcept { return begin() + size_; }
    operator std::span<const ShapeId>() const noexcept { return {begin(), size_}; }
    /// Beside the list itself [bytes].
    [[nodiscard]] std::size_t memory() const noexcept { return size_ > 1 ? room() * sizeof(ShapeId) : 0; }

private:
    /// A power of two.
    [[nodiscard]] std::size_t room() const noexcept {
        std::size_t room = 2;
        while (room < size_) room *= 2;
        return room;
    }
    /// Twice the room of a list that is full.
    void grow() {
        auto* const more = new ShapeId[2 * size_];
        for (std::size_t i = 0; i < size_; ++i) more[i] = begin()[i];
        if (size_ > 1) delete[] many_;
        many_ = more;
    }
    void swap(ShapeList& other) noexcept {
        std::swap(one_, other.one_);
        std::swap(many_, other.many_);
        std::swap(size_, other.size_);
    }

    ShapeId one_;              ///< of one
    ShapeId* many_ = nullptr;  ///< of more
    std::size_t size_ = 0;
};

}  // namespace carom::dynamics
