// Memory of lists that every step fills anew: it grows with what a step needs, and goes back when steps need much less.
//
//   if (++steps % kTrimEvery == 0) trim_kept(contacts.pairs), trim_scratch(bundles);
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace carom::dynamics {

/// Steps. What falls apart or is poured out has most contacts long before it lies still, and standard vectors double as they grow. A list whose length
/// sways by less than a twentieth is allocated once more, at most, however long it goes on.
inline constexpr std::size_t kTrimEvery = 64;

/// A sixteenth more than is in use: what a trimmed list has room for.
[[nodiscard]] constexpr std::size_t with_room(std::size_t size) noexcept { return size + size / 16; }

/// Whether so much more is held than is in use that it is worth a new allocation: an eighth, and 32 values or 32 kB.
template <class T>
[[nodiscard]] constexpr bool is_roomy(const std::vector<T>& list, std::size_t size) noexcept {
    constexpr std::size_t kFew = std::max<std::size_t>(2, std::min<std::size_t>(32, 32768 / sizeof(T)));
    return list.capacity() > size + size / 8 + kFew;
}

/// Where there is no room for so many, a sixteenth more than they need: standard vectors double.
template <class T>
void reserve_with_room(std::vector<T>& list, std::size_t size) {
    if (list.capacity() < size) list.reserve(with_room(size));
}
template <class T>
void resize_with_room(std::vector<T>& list, std::size_t size) {
    reserve_with_room(list, size);
    list.resize(size);
}
template <class T>
T& append_with_room(std::vector<T>& list) {
    resize_with_room(list, list.size() + 1);
    return list.back();
}

/// The same of a list that is written before it is read, which gives back what is much more than that at once.
template <class T>
void resize_scratch(std::vector<T>& list, std::size_t size) {
    if (list.capacity() < size || is_roomy(list, size)) {
        std::vector<T>().swap(list);  // first, so that the two are not there at once
        list.reserve(with_room(size));
    }
    list.resize(size);
}

/// Keeps what is in the list, which moves.
template <class T>
void trim_kept(std::vector<T>& list) {
    if (!is_roomy(list, list.size())) return;
    std::vector<T> tighter;
    tighter.reserve(with_room(list.size()));
    tighter.assign(list.begin(), list.end());
    list.swap(tighter);
}

/// Of a list that is written before it is read: what is in it is lost. It is of its length still, so that who fills it finds it as it was.
template <class T>
void trim_scratch(std::vector<T>& list) {
    if (!is_roomy(list, list.size())) return;
    const std::size_t size = list.size();
    std::vector<T>().swap(list);
    list.reserve(with_room(size));
    list.resize(size);
}

/// All of it, and what is in it; lists of a few kilobytes are not worth a new allocation.
template <class... T>
void drop(std::vector<T>&... lists) noexcept {
    constexpr std::size_t kFew = 8192;  // [bytes]
    ((lists.capacity() * sizeof(T) > kFew ? std::vector<T>().swap(lists) : void()), ...);
}

/// How often steps had use for something since it was trimmed last.
class Uses {
public:
    void note() noexcept { ++count_; }
    /// @return whether it was so seldom, of kTrimEvery steps, that what it needs is better given back. Counts from 0 again.
    [[nodiscard]] bool take_seldom() noexcept { return std::exchange(count_, 0) <= kTrimEvery / 16; }

private:
    std::size_t count_ = 0;
};

/// @return what the lists hold, in use or not [bytes].
template <class... T>
[[nodiscard]] constexpr std::size_t held_by(const std::vector<T>&... lists) noexcept {
    return (std::size_t{0} + ... + (lists.capacity() * sizeof(T)));
}

}  // namespace carom::dynamics
