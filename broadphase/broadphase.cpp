#include <carom/broadphase/broadphase.hpp>

#include <carom/broadphase/chooser.hpp>
#include <carom/broadphase/detail/intake.hpp>
#include <carom/broadphase/detail/method.hpp>
#include <carom/broadphase/detail/pair_set.hpp>
#include <carom/core/check.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace carom {

using detail::kNowhere;

namespace {

// The scene is looked at again after so many updates, or once its size has changed by a quarter or the share that moves by half; each
// look that changes nothing makes the time to the next one twice as long.
constexpr int kFewUpdatesACheck = 32, kMostUpdatesACheck = 128;
constexpr double kShareChanged = 1.5, kSmallShare = 0.01;
constexpr double kMemory = 0.9;  // of the moving share, from update to update
constexpr std::size_t kMostPairs = std::size_t{1} << 31;

std::unique_ptr<detail::Method> make_method(BroadphaseMethod method, double cell_scale) {
    switch (method) {
        case BroadphaseMethod::SweepAndPrune:
            return detail::make_sweep_and_prune();
        case BroadphaseMethod::SortedAxes:
            return detail::make_sorted_axes();
        case BroadphaseMethod::UniformGrid:
            return detail::make_uniform_grid(cell_scale);
        case BroadphaseMethod::HierarchicalGrid:
            return detail::make_hierarchical_grid(cell_scale);
        case BroadphaseMethod::DynamicTree:
            return detail::make_dynamic_tree();
        default:
            return detail::make_brute_force();
    }
}

}  // namespace

/// What was found in a crowd is given back after so many updates.
constexpr std::uint64_t kUpdatesATrim = 64;

struct Broadphase::Impl {
    explicit Impl(const BroadphaseSettings& given) : settings(given) {}

    [[nodiscard]] bool wanted(ProxyPair pair) const {
        return (all_agree() || may_meet(table.filters[pair.a], table.filters[pair.b])) &&
               (settings.callback.wanted == nullptr || settings.callback.wanted(settings.callback.context, pair));
    }
    [[nodiscard]] bool all_agree() const noexcept { return intake.common_bits() != 0; }
    void drop_unwanted(Executor& executor);
    /// Whether looking up what ended for each changed slot costs less than looking through the list.
    [[nodiscard]] bool few_changed() const noexcept {
        constexpr std::size_t kPairsALook = 40;
        const detail::ChangeLists lists = intake.lists();
        return kPairsALook * (lists.moved.size() + lists.inserted.size() + lists.removed.size()) < set.pairs().size();
    }
    [[nodiscard]] bool find_begun(const detail::ChangeLists& lists, Executor& executor);
    void find_all(Executor& executor);
    /// The first pairs in order, up to the limit. @return the row that is cut off, or the number of slots.
    std::uint32_t list_first_rows();
    /// Appends the pairs (a, b) of one `a`, sorted.
    void append_row(std::uint32_t a, std::vector<ProxyPair>& out) const;

    /// Looks at the scene from time to time and takes another method where that suits it better.
    void choose();
    void use(BroadphaseMethod wanted) {
        in_use = wanted;
        method = make_method(wanted, settings.cell_scale);
        built = false;
    }

    BroadphaseSettings settings;
    BroadphaseMethod in_use = BroadphaseMethod::BruteForce;
    std::unique_ptr<detail::Method> method;
    bool built = false;  // the method has every live box
    detail::ProxyTable table;
    detail::Intake intake;
    detail::PairPieces pieces;
    detail::PairSet set;
    std::vector<ProxyPair> rows;
    PairUpdate result;
    MethodChoice choice;    // why this method
    SceneStatistics scene;  // when it was chosen, or last confirmed
    double moving_share = 1.0;
    int updates_since_check = 0, updates_a_check = kFewUpdatesACheck;
    std::size_t count_at_check = 0;
    BroadphaseMethod wanted_before = BroadphaseMethod::Automatic;  // by the check before; Automatic: there was none
    [[nodiscard]] bool is_undecided() const noexcept {
        return settings.method == BroadphaseMethod::Automatic && wanted_before == BroadphaseMethod::Automatic;
    }
};

void Broadphase::Impl::choose() {
    if (settings.method != BroadphaseMethod::Automatic) return;
    const auto live = static_cast<double>(table.live_count), then = static_cast<double>(count_at_check);
    const bool first = count_at_check == 0;
    if (!intake.lists().inserted.empty() && first)
        moving_share = 1.0;
    else if (table.live_count != 0)
        moving_share = kMemory * moving_share + (1.0 - kMemory) * static_cast<double>(intake.lists().moved.size()) / live;
    const bool grown = live > 1.25 * then || live < 0.75 * then;
    const double share = moving_share + kSmallShare, share_then = scene.moving_share + kSmallShare;
    const bool changed_pace = share > kShareChanged * share_then || kShareChanged * share < share_then;
    ++updates_since_check;
    const bool due = updates_since_check >= (changed_pace ? kFewUpdatesACheck : updates_a_check);
    if (!due && !grown) return;
    updates_since_check = 0;
    count_at_check = table.live_count;
    const BroadphaseMethod current = first ? BroadphaseMethod::Automatic : in_use;  // nothing to stay with yet
    const auto [best, now] = choose_for(table.boxes, table.alive, table.live_count, moving_share, current);
    // Two checks in a row must agree, but for scenes that have just changed size.
    const bool agreed = grown || wanted_before == best.method;
    wanted_before = best.method;
    updates_a_check = best.method == in_use ? std::min(2 * updates_a_check, kMostUpdatesACheck) : kFewUpdatesACheck;
    if (best.method != in_use && agreed) use(best.method);
    if (best.method != in_use) return;
    choice = best;
    scene = now;
}

void Broadphase::Impl::drop_unwanted(Executor& executor) {
    if (all_agree() && settings.callback.wanted == nullptr) return;
    executor.parallel_for(pieces.count(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            pieces[k].keep_if([&](ProxyPair pair) { return wanted(pair); });
        }
    });
}

bool Broadphase::Impl::find_begun(const detail::ChangeLists& lists, Executor& executor) {
    pieces.begin(0, settings.pair_limit);
    method->find_moved(table, lists, executor, pieces);
    if (pieces.is_full()) return false;
    drop_unwanted(executor);
    const bool check_wanted = !all_agree() || settings.callback.wanted != nullptr;
    const auto ask = [this](ProxyPair pair) { return wanted(pair); };
    const FunctionRef<bool(ProxyPair)> asked(ask);
    const detail::PairPieces* const ended = lists.want_ended ? method->ended() : nullptr;
    return set.patch(pieces, ended, intake.changed(), {table.boxes, check_wanted ? &asked : nullptr}, settings.pair_limit);
}

void Broadphase::Impl::append_row(std::uint32_t a, std::vector<ProxyPair>& out) const {
    const std::size_t start = out.size();
    method->visit_near(table, table.boxes[a], [&](std::uint32_t b) {
        if (b > a && (table.movable[a] | table.movable[b]) != 0 && wanted({a, b})) out.push_back({a, b});
        return true;
    });
    const auto first = out.begin() + static_cast<std::ptrdiff_t>(start);
    std::make_heap(first, out.end());
    std::sort_heap(first, out.end());
}

std::uint32_t Broadphase::Impl::list_first_rows() {
    rows.clear();
    for (std::uint32_t a = 0; a < table.boxes.size(); ++a) {
        if (table.alive[a] == 0) continue;
        append_row(a, rows);
        if (rows.size() <= settings.pair_limit) continue;
        rows.resize(settings.pair_limit);
        return a;
    }
    return static_cast<std::uint32_t>(table.boxes.size());
}

void Broadphase::Impl::find_all(Executor& executor) {
    pieces.begin(0, settings.pair_limit);
    method->find_all(table, executor, pieces);
    result.status = PairStatus::Complete;
    result.complete_below = static_cast<std::uint32_t>(table.boxes.size());
    if (!pieces.is_full()) {
        drop_unwanted(executor);
        set.replace(pieces, table.boxes.size(), executor);
        return;
    }
    // Too many, at least before filters: row by row, so that the same pairs are kept whatever the method.
    const std::uint32_t cut = list_first_rows();
    set.replace(rows);
    if (cut != result.complete_below) result.status = PairStatus::LimitReached;
    result.complete_below = cut;
}

Broadphase::Broadphase(const BroadphaseSettings& settings) : impl_(std::make_unique<Impl>(settings)) {
    if (!is_valid(settings.method)) {
        impl_->settings.method = BroadphaseMethod::Automatic;
        report_error(ErrorCode::InvalidArgument, "no such broadphase method");
    }
    if (settings.pair_limit == 0 || settings.pair_limit > kMostPairs) {
        impl_->settings.pair_limit = std::clamp(settings.pair_limit, std::size_t{1}, kMostPairs);
        report_error(ErrorCode::InvalidArgument, "pair_limit must be in 1..2^31");
    }
    constexpr double kMostCellScale = 16.0;
    if (!(settings.cell_scale >= 1.0 / kMostCellScale && settings.cell_scale <= kMostCellScale)) {
        impl_->settings.cell_scale = settings.cell_scale > 1.0 ? kMostCellScale : (settings.cell_scale < 1.0 ? 1.0 / kMostCellScale : 1.0);
        report_error(ErrorCode::InvalidArgument, "cell_scale must be in 1/16..16");
    }
    impl_->set.list_changes(impl_->settings.lists_changes);
    const bool automatic = impl_->settings.method == BroadphaseMethod::Automatic;
    impl_->use(automatic ? BroadphaseMethod::BruteForce : impl_->settings.method);
}
Broadphase::~Broadphase() = default;
Broadphase::Broadphase(Broadphase&&) noexcept = default;
Broadphase& Broadphase::operator=(Broadphase&&) noexcept = default;

const PairUpdate& Broadphase::update(const ProxyChanges& changes, Executor& executor) {
    Impl& w = *impl_;
    const char* const fault = w.intake.find_fault(changes, w.table, executor);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, w.result);
    w.intake.take_over(changes, w.settings.callback.wanted != nullptr, w.table, executor);
    w.choose();
    if (w.result.number % kUpdatesATrim == kUpdatesATrim - 1) w.set.trim() ? w.pieces.drop() : w.pieces.trim();
    detail::ChangeLists lists = w.intake.lists();
    // A method may know which pairs end because boxes part, but not which are no longer wanted.
    lists.want_ended = !w.intake.filter_changed() && w.few_changed();
    if (!w.built || w.result.status != PairStatus::Complete || w.method->prefers_all(w.table, lists)) {
        w.find_all(executor);
    } else if (lists.moved.empty() && lists.inserted.empty() && lists.removed.empty()) {
        w.set.keep();
    } else if (!w.find_begun(lists, executor)) {
        w.find_all(executor);
    }
    w.built = true;
    ++w.result.number;
    w.result.pairs = w.set.pairs();
    if (w.settings.lists_changes) w.result.begun = w.set.begun(), w.result.ended = w.set.ended();
    if (w.result.status == PairStatus::Complete) w.result.complete_below = static_cast<std::uint32_t>(w.table.boxes.size());
    return w.result;
}

const PairUpdate& Broadphase::result() const noexcept { return impl_->result; }

void Broadphase::clear() {
    Impl& w = *impl_;
    w.table.clear();
    w.intake.clear();
    w.set.clear();
    w.count_at_check = 0;
    w.wanted_before = BroadphaseMethod::Automatic;
    w.built = false;
    const std::uint64_t number = w.result.number;
    w.result = {};
    w.result.number = number;
}

void Broadphase::stream_pairs(FunctionRef<bool(std::span<const ProxyPair> row)> visit) const {
    const Impl& w = *impl_;
    if (!w.built) return;
    std::vector<ProxyPair> row;
    for (std::uint32_t a = 0; a < w.table.boxes.size(); ++a) {
        if (w.table.alive[a] == 0) continue;
        row.clear();
        w.append_row(a, row);
        if (!row.empty() && !visit(row)) return;
    }
}

void Broadphase::visit_where(FunctionRef<bool(const FloatAabb&)> touches, FunctionRef<bool(std::uint32_t)> visit) const {
    if (impl_->built) impl_->method->visit_where(impl_->table, touches, visit);
}

void Broadphase::visit_along(const SweepPath& path, FunctionRef<bool(const FloatAabb&)> touches,
                             FunctionRef<bool(std::uint32_t)> visit) const {
    if (impl_->built) impl_->method->visit_along(impl_->table, path, touches, visit);
}

void Broadphase::visit_parts(FunctionRef<void(const BroadphasePart&)> visit) const {
    if (impl_->built) impl_->method->visit_parts(impl_->table, visit);
}

void Broadphase::visit_parts_of(std::uint32_t slot, FunctionRef<void(const BroadphasePart&)> visit) const {
    const detail::ProxyTable& table = impl_->table;
    if (impl_->built && slot < table.alive.size() && table.alive[slot] != 0) impl_->method->visit_parts_of(slot, visit);
}

void Broadphase::visit_ends(FunctionRef<void(const BroadphaseEnd&)> visit) const {
    if (impl_->built) impl_->method->visit_ends(impl_->table, visit);
}

FloatAabb Broadphase::box(std::uint32_t slot) const noexcept {
    return slot < impl_->table.boxes.size() ? impl_->table.boxes[slot] : kNowhere;
}

BroadphaseMethod Broadphase::method() const noexcept { return impl_->is_undecided() ? BroadphaseMethod::Automatic : impl_->in_use; }
std::size_t Broadphase::live_count() const noexcept { return impl_->table.live_count; }

std::size_t Broadphase::memory() const noexcept {
    const Impl& w = *impl_;
    return w.table.memory() + w.intake.memory() + w.pieces.memory() + w.set.memory() + sizeof(ProxyPair) * w.rows.capacity() + w.method->memory();
}

std::string Broadphase::reason() const {
    const Impl& w = *impl_;
    if (w.settings.method != BroadphaseMethod::Automatic) return "asked for";
    return w.is_undecided() ? "chosen at the first update" : describe(w.choice, w.scene);
}

}  // namespace carom
