// What a broadphase method does for the engine that keeps the pairs.
//
//   method.find_all(table, executor, pieces);                       // from scratch
//   method.find_moved(table, changes, executor, pieces);            // or only what the changes may have begun
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/broadphase/detail/pair_pieces.hpp>
#include <carom/broadphase/detail/proxy_table.hpp>
#include <carom/broadphase/method.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace carom::detail {

class Method {
public:
    Method() = default;
    Method(const Method&) = delete;
    Method& operator=(const Method&) = delete;
    virtual ~Method() = default;

    /// Whether finding all pairs anew costs less than finding those that the changes began.
    [[nodiscard]] virtual bool prefers_all(const ProxyTable& table, const ChangeLists& changes) const noexcept = 0;

    /// Builds the structure anew and finds every pair of live boxes that overlap, not both immovable, each once; in any order.
    virtual void find_all(const ProxyTable& table, Executor& executor, PairPieces& out) = 0;

    /// Takes the changes over and finds, in any order, at least every pair that overlaps now and did not before with `previous`
    /// for the moved ones. May also find others that overlap, and a pair more than once. Never called before find_all.
    virtual void find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) = 0;

    /// Where a method knows them, after find_moved with `want_ended`: the pairs of a slot that changed and one that did not which overlapped before and
    /// do not now, in any order, some maybe twice or never wanted. Null: it does not.
    [[nodiscard]] virtual const PairPieces* ended() const noexcept { return nullptr; }

    /// Visits every live slot whose box overlaps `box`, each once, in any order, until `visit` returns false. May visit others. Only after
    /// find_all; const: any number of threads.
    virtual void visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const = 0;

    /// Visits every live slot for whose box `touches` is true, each once, until `visit` returns false. `touches` is true of any region around
    /// such a box. This one looks at every box.
    virtual void visit_where(const ProxyTable& table, FunctionRef<bool(const FloatAabb&)> touches,
                             FunctionRef<bool(std::uint32_t)> visit) const {
        for (std::size_t slot = 0; slot < table.boxes.size(); ++slot) {
            if (table.alive[slot] != 0 && touches(table.boxes[slot]) && !visit(static_cast<std::uint32_t>(slot))) return;
        }
    }

    /// As visit_where, of boxes for which `touches` implies that the path meets them. path.t_max may become less on the way. This one looks at every box near
    /// the path's.
    virtual void visit_along(const ProxyTable& table, const SweepPath& path, FunctionRef<bool(const FloatAabb&)> touches,
                             FunctionRef<bool(std::uint32_t)> visit) const {
        const FloatAabb all = box_about(path);
        visit_where(
            table,
            [&](const FloatAabb& box) {
                return box.lower.x <= all.upper.x && all.lower.x <= box.upper.x && box.lower.y <= all.upper.y &&
                       all.lower.y <= box.upper.y && box.lower.z <= all.upper.z && all.lower.z <= box.upper.z && touches(box);
            },
            visit);
    }

    /// For pictures; most methods have neither parts nor ends.
    virtual void visit_parts(const ProxyTable& table, FunctionRef<void(const BroadphasePart&)> visit) const {
        static_cast<void>(table);
        static_cast<void>(visit);
    }
    /// The parts that hold a live slot, from the outermost in.
    virtual void visit_parts_of(std::uint32_t slot, FunctionRef<void(const BroadphasePart&)> visit) const {
        static_cast<void>(slot);
        static_cast<void>(visit);
    }
    virtual void visit_ends(const ProxyTable& table, FunctionRef<void(const BroadphaseEnd&)> visit) const {
        static_cast<void>(table);
        static_cast<void>(visit);
    }

    /// [bytes]
    [[nodiscard]] virtual std::size_t memory() const noexcept = 0;
};

[[nodiscard]] std::unique_ptr<Method> make_brute_force();
[[nodiscard]] std::unique_ptr<Method> make_sweep_and_prune();
[[nodiscard]] std::unique_ptr<Method> make_sorted_axes();
[[nodiscard]] std::unique_ptr<Method> make_uniform_grid(double cell_scale);
[[nodiscard]] std::unique_ptr<Method> make_hierarchical_grid(double cell_scale);
[[nodiscard]] std::unique_ptr<Method> make_dynamic_tree();

}  // namespace carom::detail
