#include <carom/narrowphase/detail/batch_check.hpp>

#include <atomic>

namespace carom::detail {
namespace {

constexpr unsigned char kNoShape = 255;

}  // namespace

const KernelEntry& kernel_of(std::size_t kind) noexcept {
    constexpr std::size_t kTypes = static_cast<std::size_t>(kShapeTypeCount);
    return kernel_for(static_cast<ShapeType>(kind / kTypes), static_cast<ShapeType>(kind % kTypes));
}

void BatchKinds::look_at_types(std::span<const Shape* const> shapes, Executor& executor) {
    types_.resize(shapes.size());
    executor.parallel_for(types_.size(), 256, [&](std::size_t begin, std::size_t end) {
        unsigned char* const types = types_.data();  // which may be anything's bytes: so pointers to what is read are kept
        const Shape* const* const all = shapes.data();
        for (std::size_t k = begin; k < end; ++k) types[k] = all[k] == nullptr ? kNoShape : static_cast<unsigned char>(all[k]->index());
    });
}

// Of the shapes that pairs name: the others' are looked at only because that is faster.
bool BatchKinds::poses_are_fit(const BatchInput& input, Executor& executor) const {
    std::atomic<bool> finite{true};
    executor.parallel_for(types_.size(), 256, [&](std::size_t begin, std::size_t end) {
        if (!poses_are_finite(input.placed.poses.subspan(begin, end - begin))) finite.store(false, std::memory_order_relaxed);
    });
    return finite.load() || named_poses_are_finite(input);
}

PairFault BatchKinds::look_at_pair(const BatchInput& input, const BatchBefore& before, std::size_t i) {
    const NumberedPair& pair = input.pairs[i];
    if (pair.a >= types_.size() || pair.b >= types_.size()) return {"collide: a pair names a shape beyond the last"};
    const std::size_t a = types_[pair.a], b = types_[pair.b];
    if (a == kNoShape || b == kNoShape) return {"collide: a shape is null"};
    if (!is_finite(pair.margin)) return {"collide: the margin is not finite", ErrorCode::NotFinite};
    if (pair.margin < 0.0f) return {"collide: the margin is negative"};
    if (!is_finite(pair.slack)) return {"collide: the slack is not finite", ErrorCode::NotFinite};
    if (pair.slack < 0.0f) return {"collide: the slack is negative"};
    if (pair.last != kNewPair) {
        if (before.memory == nullptr || !before.memory->knows(pair)) return {"collide: `last` is not this pair in the batch before"};
        if (before.manifolds != before.memory->manifold_count()) return {"collide: the manifolds are not those of the batch before"};
    }
    if (!kernel_of(kind_of(a, b)).exists()) return {"collide: two planes have no contact", ErrorCode::WrongType};
    of_pair[i] = static_cast<std::uint16_t>(kind_of(a, b));
    return {};
}

// Of pairs [begin, end). @return whether all are fit.
bool BatchKinds::look_at_pairs(const BatchInput& input, const BatchBefore& before, std::size_t begin, std::size_t end) {
    const unsigned char* const types = types_.data();
    std::uint16_t* const kinds = of_pair.data();
    const NumberedPair* const all = input.pairs.data();
    const std::size_t shapes = types_.size();
    std::size_t known = kKinds;  // a kind that has a kernel
    for (std::size_t i = begin; i < end; ++i) {
        if (is_plain(all[i], shapes) && kind_of(types[all[i].a], types[all[i].b]) == known) {
            kinds[i] = static_cast<std::uint16_t>(known);
            continue;
        }
        if (look_at_pair(input, before, i).what != nullptr) return false;
        known = kinds[i];
    }
    return true;
}

PairFault BatchKinds::find(const BatchInput& input, const BatchBefore& before, Executor& executor) {
    look_at_types(input.placed.shapes, executor);
    of_pair.resize(input.pairs.size());
    std::atomic<bool> good{true};
    executor.parallel_for(of_pair.size(), 1024, [&](std::size_t begin, std::size_t end) {
        if (!look_at_pairs(input, before, begin, end)) good.store(false, std::memory_order_relaxed);
    });
    for (std::size_t i = 0; !good.load(); ++i) {  // one of them has it
        if (const PairFault fault = look_at_pair(input, before, i); fault.what != nullptr) return fault;
    }
    return poses_are_fit(input, executor) ? PairFault{} : kPoseNotFinite;
}

}  // namespace carom::detail
