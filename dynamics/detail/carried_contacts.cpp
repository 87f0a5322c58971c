#include <carom/dynamics/detail/carried_contacts.hpp>

#include <algorithm>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr std::size_t kPart = 256;  // pairs that a thread works on together

CarriedPair carried(const ContactPair& pair, std::size_t first_point) {
    return {pair.key, pair.generation_a, pair.generation_b, static_cast<std::uint32_t>(first_point), pair.point_count};
}

/// @return behind the last one written.
CarriedPoint* write_points(const ContactSet& contacts, const ContactPair& pair, CarriedPoint* out) {
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        const ContactManifold& manifold = contacts.manifolds[m];
        for (std::size_t k = manifold.first_point; k < manifold.first_point + manifold.count; ++k) *out++ = {contacts.points[k].feature, contacts.impulses[k]};
    }
    return out;
}

/// The n-th point of the feature, n from 0; null where there are not so many.
const CarriedPoint* find_point(std::span<const CarriedPoint> points, std::uint64_t feature, int n) {
    for (const CarriedPoint& point : points) {
        if (point.feature == feature && n-- == 0) return &point;
    }
    return nullptr;
}

bool has_same_points(std::span<const ContactPoint> points, std::span<const CarriedPoint> old) {
    if (old.size() != points.size()) return false;
    std::uint64_t difference = 0;
    for (std::size_t k = 0; k < old.size(); ++k) difference |= points[k].feature ^ old[k].feature;
    return difference == 0;
}

PointImpulse scaled(const PointImpulse& impulse, float scale) { return {scale * impulse.normal, scale * impulse.friction}; }

}  // namespace

void CarriedContacts::take(const ContactSet& contacts, Executor& executor) {
    const std::size_t count = contacts.pairs.size(), parts = (count + kPart - 1) / kPart;
    firsts_.assign(parts + 1, 0);
    for (std::size_t i = 0; i < count; ++i) firsts_[i / kPart + 1] += contacts.pairs[i].point_count;
    for (std::size_t part = 0; part < parts; ++part) firsts_[part + 1] += firsts_[part];
    resize(count, firsts_[parts]);
    executor.parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
        CarriedPoint* next = points_.data() + firsts_[begin];
        for (std::size_t i = begin * kPart; i < std::min(count, end * kPart); ++i) {
            pairs_[i] = carried(contacts.pairs[i], static_cast<std::size_t>(next - points_.data()));
            next = write_points(contacts, contacts.pairs[i], next);
        }
    });
}

void CarriedContacts::add(const ContactSet& contacts) {
    CarriedContacts before(memory_.pool()), more(memory_.pool());
    before.swap(*this);
    SerialExecutor alone;
    more.take(contacts, alone);
    for (CarriedPair& pair : more.pairs_) pair.first_point += static_cast<std::uint32_t>(before.points_.size());
    resize(before.pairs_.size() + more.pairs_.size(), before.points_.size() + more.points_.size());
    std::ranges::merge(before.pairs_, more.pairs_, pairs_.begin(), {}, &CarriedPair::key, &CarriedPair::key);
    std::ranges::copy(more.points_, std::ranges::copy(before.points_, points_.begin()).out);
}

void CarriedContacts::resize(std::size_t pairs, std::size_t points) {
    memory_.resize(bytes_of<CarriedPair>(pairs) + bytes_of<CarriedPoint>(points));
    std::byte* next = memory_.data();
    pairs_ = cut<CarriedPair>(next, pairs), points_ = cut<CarriedPoint>(next, points);
}

void CarriedContacts::swap(CarriedContacts& other) noexcept {
    memory_.swap(other.memory_);
    std::swap(pairs_, other.pairs_), std::swap(points_, other.points_);
}

void CarriedContacts::clear() noexcept {
    pairs_ = {}, points_ = {};
    memory_.release();
}

void carry_impulses(std::span<const ContactPoint> points, std::span<const CarriedPoint> old, float scale, std::span<PointImpulse> impulses) noexcept {
    if (has_same_points(points, old)) {  // nearly always
        for (std::size_t k = 0; k < old.size(); ++k) impulses[k] = scaled(old[k].impulse, scale);
        return;
    }
    for (std::size_t k = 0; k < points.size(); ++k) {
        const std::uint64_t feature = points[k].feature;
        int twins = 0;
        for (std::size_t earlier = 0; earlier < k; ++earlier) twins += points[earlier].feature == feature;
        const CarriedPoint* const point = find_point(old, feature, twins);
        impulses[k] = point == nullptr ? PointImpulse{} : scaled(point->impulse, scale);
    }
}

}  // namespace carom::dynamics
