// Broadphase: bounds in, sorted unique pairs out, with what began and what ended. Every method stands behind this one class.
//
//   Broadphase broadphase;                                        // chooses its method by the scene
//   const PairUpdate& found = broadphase.update({.bounds = boxes, .filters = filters, .moved = moved}, executor);
//   for (const ProxyPair& pair : found.begun) { ... }
#pragma once

#include <carom/broadphase/method.hpp>
#include <carom/broadphase/proxy.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace carom {

/// A user's say in which pairs count: a pure function of the two slots, a < b. It may be called from any thread, any number of
/// times; its answer may change only for slots that are listed as moved.
struct PairCallback {
    bool (*wanted)(void* context, ProxyPair pair) = nullptr;  ///< null: all are wanted
    void* context = nullptr;
};

struct BroadphaseSettings {
    BroadphaseMethod method = BroadphaseMethod::Automatic;
    /// No more pairs than this are kept; memory stays in proportion to it. 1 .. 2^31.
    std::size_t pair_limit = std::size_t{1} << 27;
    PairCallback callback{};
    /// Edges of the grids' cells, in units of those that they would choose: changes times, never pairs. 1/16 .. 16.
    double cell_scale = 1.0;
    /// Whether PairUpdate::begun and ended are asked for; otherwise they are empty. They take three more lists of pairs where most boxes move.
    bool lists_changes = true;
};

/// What changed since the update before. A slot is the caller's stable name of a box; it comes alive when it is first listed as
/// moved and is free again once it is listed as removed.
struct ProxyChanges {
    std::span<const FloatAabb> bounds{};       ///< (n,) by slot; only those of moved slots are read
    std::span<const ProxyFilter> filters{};    ///< (n,) likewise
    std::span<const std::uint32_t> moved{};    ///< slots that are new, or whose box or filter changed; any order, repeats are harmless
    std::span<const std::uint32_t> removed{};  ///< live slots that go, each once
};

enum class PairStatus : unsigned char {
    Complete,
    LimitReached,  ///< more than BroadphaseSettings::pair_limit overlap: `pairs` holds the first of them, in order
};

/// The pairs of live boxes that overlap (closed test of the boxes passed in) and may meet, each once, sorted by (a, b).
/// The same lists for every method, number of threads and SIMD width. Valid until the next call of update or clear.
struct PairUpdate {
    std::span<const ProxyPair> pairs;
    std::span<const ProxyPair> begun;  ///< in `pairs` now and not after the update before
    std::span<const ProxyPair> ended;  ///< the other way round; of removed slots too
    PairStatus status = PairStatus::Complete;
    std::uint32_t complete_below = 0;  ///< pairs whose `a` is below this are all listed
    std::uint64_t number = 0;          ///< of updates that were taken over, this one included: a refused one does not count
};

/// A part of what a method keeps, for pictures: a cell of a grid with boxes in it, a stray (a box that no cell of its grid had room for),
/// or a node of a tree.
struct BroadphasePart {
    FloatAabb box{};        ///< of a cell: where the lower corners of its boxes are, but for those beyond the grid, which its outermost cells have; of a stray: itself
    int level = 0;          ///< of the grid, ascending with the size of boxes; of a node: steps from the root
    std::size_t count = 0;  ///< boxes in the cell, or in the node itself: 1 for a leaf, else 0; 1 for a stray
    bool is_stray = false;  ///< every search of its grid reads it
};

/// An end of a box on an axis along which a method keeps the ends sorted.
struct BroadphaseEnd {
    int axis = 0;  ///< 0, 1, 2
    float value = 0.0f;
    bool is_upper = false;
    std::uint32_t slot = 0;
};

/// Finds the pairs of boxes that overlap and whose filters agree, and keeps them up to date as the boxes move.
///
/// Planes and other unbounded shapes have no box: keep them in a list of their own and test it apart.
/// Memory: O(live slots + pairs), docs/broadphase.md has the bytes. Cost: that page too.
class Broadphase {
public:
    /// Settings out of range are misuse; the range's nearest end is then taken.
    explicit Broadphase(const BroadphaseSettings& settings = {});
    ~Broadphase();
    Broadphase(Broadphase&&) noexcept;
    Broadphase& operator=(Broadphase&&) noexcept;

    /// Takes over the changes and finds the pairs. Bad input (sizes that differ, a slot beyond them, bounds that are NaN, infinite or
    /// inverted, a removed slot that is not alive or also moved, 2^28 slots or more) is misuse: it is reported, nothing
    /// changes, and the result of the update before is returned.
    const PairUpdate& update(const ProxyChanges& changes, Executor& executor);

    /// The result of the last update.
    [[nodiscard]] const PairUpdate& result() const noexcept;

    /// Removes every box and every pair, without events. Keeps its memory.
    void clear();

    /// Hands every pair to `visit`, row by row in order, without keeping any: for sets with more pairs than memory holds. Rows
    /// are the pairs of one `a`. Stops when `visit` returns false.
    void stream_pairs(FunctionRef<bool(std::span<const ProxyPair> row)> visit) const;

    /// Visits the live slots for whose boxes `touches` is true, each once and in no promised order, until `visit` returns false. `touches`
    /// must be true of every region that holds a box of which it is true; regions may be open, with bounds at infinity.
    /// queries.hpp has the usual shapes. After update; const, so any number of threads may ask at once.
    void visit_where(FunctionRef<bool(const FloatAabb& region)> touches, FunctionRef<bool(std::uint32_t slot)> visit) const;
    /// The same where only boxes count that the path meets: `touches` implies it. Grids walk along the path, so boxes come roughly in the
    /// order in which it meets them; `visit` may make path.t_max less, and what lies beyond is then left out.
    void visit_along(const SweepPath& path, FunctionRef<bool(const FloatAabb& region)> touches,
                     FunctionRef<bool(std::uint32_t slot)> visit) const;
    /// The box of a live slot, as it was passed in; of any other a box that touches nothing.
    [[nodiscard]] FloatAabb box(std::uint32_t slot) const noexcept;

    /// What the method keeps at the moment: the occupied cells of grids, then their strays; the nodes of the tree, parents first. Nothing with other methods.
    /// Made on the spot from what is there; nothing is stored for it.
    void visit_parts(FunctionRef<void(const BroadphasePart& part)> visit) const;
    /// Of these, those that hold a live slot: its cell or the stray that it is; the nodes from the root to its leaf. Nothing of any other.
    void visit_parts_of(std::uint32_t slot, FunctionRef<void(const BroadphasePart& part)> visit) const;
    /// The sorted ends of the axes along which a method keeps some, axis by axis, ascending: all of sorted_axes, the lower ones along the
    /// axis that sweep_and_prune swept last.
    void visit_ends(FunctionRef<void(const BroadphaseEnd& end)> visit) const;

    /// The method in use: the one asked for, or the one chosen for the scene as it stands; Automatic before the first update.
    [[nodiscard]] BroadphaseMethod method() const noexcept;
    /// Why this method, in one sentence.
    [[nodiscard]] std::string reason() const;

    [[nodiscard]] std::size_t live_count() const noexcept;
    /// Memory in use by boxes, pairs and the method [bytes].
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace carom
