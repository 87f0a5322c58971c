// All pairs, many at once: the fastest method for a few hundred boxes.
#include <carom/broadphase/detail/method.hpp>
#include <carom/broadphase/detail/overlap_kernel.hpp>

#include <algorithm>

namespace carom::detail {
namespace {

constexpr std::size_t kRowsAPiece = 64;
constexpr std::size_t kMoversAPiece = 16;
constexpr int kAxes[3] = {0, 1, 2};

// Entries stand in the order of slots; free slots hold a box that overlaps nothing.
class BruteForce final : public Method {
public:
    [[nodiscard]] bool prefers_all(const ProxyTable& table, const ChangeLists& changes) const noexcept override {
        return 2 * (changes.moved.size() + changes.inserted.size()) > table.boxes.size();
    }

    void find_all(const ProxyTable& table, Executor& executor, PairPieces& out) override {
        const std::size_t n = table.boxes.size();
        entries_.grow(n + Entries::kSentinels);
        for (std::size_t i = 0; i < n; ++i) set(table, static_cast<std::uint32_t>(i), 0);
        entries_.close(n);
        const std::size_t pieces = (n + kRowsAPiece - 1) / kRowsAPiece;
        out.begin(pieces, out.limit());
        executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
                find_overlaps(entries_, k * kRowsAPiece, std::min((k + 1) * kRowsAPiece, n), n, Order::Any, out[k]);
                out.found(out[k].size());
            }
        });
    }

    void find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) override {
        const std::size_t n = table.boxes.size();
        entries_.grow(n + Entries::kSentinels);
        entries_.close(n);
        movers_.clear();
        for (const std::uint32_t slot : changes.removed) set(table, slot, 0);
        for (const auto& list : {changes.moved, changes.inserted}) {
            for (const std::uint32_t slot : list) {
                set(table, slot, kMoved);
                movers_.push_back(mover(table.boxes[slot], table.previous[slot], kAxes, static_cast<Tag>(entries_.tag[slot])));
            }
        }
        const std::size_t pieces = (movers_.size() + kMoversAPiece - 1) / kMoversAPiece;
        out.begin(pieces, out.limit());
        executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
                const std::size_t first = k * kMoversAPiece;
                find_begun(entries_, n, std::span(movers_).subspan(first, std::min(kMoversAPiece, movers_.size() - first)), out[k]);
                out.found(out[k].size());
            }
        });
        for (const Mover& m : movers_) entries_.tag[m.tag & kIndexMask] &= ~static_cast<std::int32_t>(kMoved);
    }

    void visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const override {
        for (std::size_t slot = 0; slot < table.boxes.size(); ++slot) {
            if (overlaps(table.boxes[slot], box) && !visit(static_cast<std::uint32_t>(slot))) return;
        }
    }

    [[nodiscard]] std::size_t memory() const noexcept override { return entries_.memory() + sizeof(Mover) * movers_.capacity(); }

private:
    void set(const ProxyTable& table, std::uint32_t slot, Tag more) noexcept {
        entries_.set(slot, table.boxes[slot], kAxes, slot | more | (table.movable[slot] != 0 ? 0 : kImmovable));
    }

    Entries entries_;
    std::vector<Mover> movers_;
};

}  // namespace

std::unique_ptr<Method> make_brute_force() { return std::make_unique<BruteForce>(); }

}  // namespace carom::detail
