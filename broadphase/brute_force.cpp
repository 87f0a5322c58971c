// All pairs, many at once: the fastest method for a few hundred boxes.
#include <carom/broadphase/detail/method.hpp>
#include <carom/broadphase/detail/overlap_kernel.hpp>

#include <algorithm>
#include <bit>

namespace carom::detail {
namespace {

constexpr std::size_t kRowsAPiece = 64;
constexpr std::size_t kMoversAPiece = 16;
constexpr int kAxes[3] = {0, 1, 2};

// Entries stand in no order: the last one takes the place of one that goes.
class BruteForce final : public Method {
public:
    [[nodiscard]] bool prefers_all(const ProxyTable& table, const ChangeLists& changes) const noexcept override {
        return 2 * (changes.moved.size() + changes.inserted.size()) > table.live_count;
    }

    void find_all(const ProxyTable& table, Executor& executor, PairPieces& out) override {
        make_room(table);
        count_ = 0;
        for (std::size_t slot = 0; slot < table.boxes.size(); ++slot) {
            if (table.alive[slot] != 0) append(table, static_cast<std::uint32_t>(slot), 0);
        }
        const std::size_t n = count_;
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
        for (const std::uint32_t slot : changes.removed) remove(slot);
        make_room(table);
        for (const std::uint32_t slot : changes.moved) set(table, place_[slot], slot, kMoved);
        for (const std::uint32_t slot : changes.inserted) append(table, slot, kMoved);
        entries_.close(count_);
        movers_.clear();
        for (const auto& list : {changes.moved, changes.inserted}) {
            for (const std::uint32_t slot : list) {
                movers_.push_back(mover(table.boxes[slot], table.previous[slot], kAxes, static_cast<Tag>(entries_.tag[place_[slot]])));
            }
        }
        const std::size_t pieces = (movers_.size() + kMoversAPiece - 1) / kMoversAPiece;
        out.begin(pieces, out.limit());
        executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
                const std::size_t first = k * kMoversAPiece;
                const std::size_t count = std::min(kMoversAPiece, movers_.size() - first);
                find_begun(entries_, count_, std::span(movers_).subspan(first, count), out[k]);
                out.found(out[k].size());
            }
        });
        for (const Mover& m : movers_) entries_.tag[place_[m.tag & kIndexMask]] &= ~static_cast<std::int32_t>(kMoved);
    }

    void visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const override {
        for (std::size_t slot = 0; slot < table.boxes.size(); ++slot) {
            if (overlaps(table.boxes[slot], box) && !visit(static_cast<std::uint32_t>(slot))) return;
        }
    }

    void visit_along(const ProxyTable& table, const SweepPath& path, FunctionRef<bool(const FloatAabb&)> touches,
                     FunctionRef<bool(std::uint32_t)> visit) const override {
        const FloatAabb all = box_about(path);
        for (std::size_t first = 0; first < count_; first += 64) {
            for (std::uint64_t near = find_near(entries_, first, std::min<std::size_t>(first + 64, count_), all); near != 0;
                 near &= near - 1) {
                const std::uint32_t slot =
                    static_cast<Tag>(entries_.tag[first + static_cast<std::size_t>(std::countr_zero(near))]) & kIndexMask;
                if (touches(table.boxes[slot]) && !visit(slot)) return;
            }
        }
    }

    [[nodiscard]] std::size_t memory() const noexcept override {
        return entries_.memory() + sizeof(Mover) * movers_.capacity() + sizeof(std::uint32_t) * place_.capacity();
    }

private:
    void make_room(const ProxyTable& table) {
        entries_.grow(table.live_count + Entries::kSentinels);
        place_.resize(table.boxes.size());
    }
    void set(const ProxyTable& table, std::uint32_t at, std::uint32_t slot, Tag more) noexcept {
        entries_.set(at, table.boxes[slot], kAxes, slot | more | (table.movable[slot] != 0 ? 0 : kImmovable));
    }
    void append(const ProxyTable& table, std::uint32_t slot, Tag more) noexcept {
        place_[slot] = count_;
        set(table, count_++, slot, more);
    }
    void remove(std::uint32_t slot) noexcept {
        const std::uint32_t at = place_[slot], last = --count_;
        for (int k = 0; k < 3; ++k) {
            entries_.lower[k][at] = entries_.lower[k][last];
            entries_.upper[k][at] = entries_.upper[k][last];
        }
        entries_.tag[at] = entries_.tag[last];
        place_[static_cast<Tag>(entries_.tag[at]) & kIndexMask] = at;
    }

    Entries entries_;
    std::uint32_t count_ = 0;
    std::vector<std::uint32_t> place_;  // of each live slot
    std::vector<Mover> movers_;
};

}  // namespace

std::unique_ptr<Method> make_brute_force() { return std::make_unique<BruteForce>(); }

}  // namespace carom::detail
