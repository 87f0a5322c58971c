// The passes of a step's substeps: what is done in which order, and by whom.
#include <carom/dynamics/detail/body_kernels.hpp>
#include <carom/dynamics/detail/contact_kernels.hpp>
#include <carom/dynamics/detail/contact_solver.hpp>

#include <algorithm>
#include <tuple>

namespace carom::dynamics {

void ContactSolver::list(std::size_t count, Stage stage, const Task& task, const std::uint32_t* starts) {
    phases_.push_back({.count = count, .label = static_cast<int>(stage), .starts = starts});
    tasks_.push_back(task);
}

void ContactSolver::list_velocities(WarmStart warm_start) {
    list(static_cast<std::size_t>(rows_.movable), Stage::Velocities, {.work = Work::Kick, .warm_start = warm_start}, part_rows_.data());
    if (rules_.damp_any()) list(1, Stage::Velocities, {.work = Work::Damp});
    if (slender_.any()) list(1, Stage::Velocities, {.work = Work::Precess});
}

void ContactSolver::list_contacts(Stage stage, const Task& task) {
    const auto count = static_cast<std::uint32_t>(colors_.size());
    const auto color_at = [&](std::uint32_t k) { return task.backward ? count - 1 - k : k; };
    const auto list_overflow = [&] {
        Task overflow = task;
        overflow.work = task.work == Work::WarmStart ? Work::WarmStartOverflow : Work::SolveOverflow;
        if (first_overflow_bundle_ < bundles_.size()) list(1, stage, overflow);
    };
    if (task.backward) list_overflow();
    for (std::uint32_t k = 0; k < count;) {
        std::uint32_t end = k;
        while (end < count && colors_[color_at(end)].count == 1) ++end;
        Task some = task;
        if (end > k) {  // there is nothing to share
            std::tie(some.first_color, some.end_color) = std::minmax(color_at(k), color_at(end - 1));
            ++some.end_color;
            list(1, stage, some);
            k = end;
            continue;
        }
        some.first_color = some.end_color = color_at(k++);
        some.first_bundle = colors_[some.first_color].first;
        list(colors_[some.first_color].count, stage, some, color_parts_.data() + some.first_color * (part_count_ + 1));
    }
    if (!task.backward) list_overflow();
    Task rows = task;
    rows.work = task.work == Work::WarmStart ? Work::WarmStartRows : Work::SolveRows;
    if (!rolling_.is_empty() || rules_.lock_any()) list(1, stage, rows);
}

void ContactSolver::list_warm_start() { list_contacts(Stage::WarmStart, {.work = Work::WarmStart}); }

void ContactSolver::list_pass(bool bias, bool backward) {
    const SolveSettings settings{.soft = soft_, .inverse_h = static_cast<float>(1.0 / settings_.substep()), .bias = bias, .gaps_known = gaps_known_};
    list_contacts(bias ? Stage::Solve : Stage::Relax, {.work = Work::Solve, .settings = settings, .substep = moves_listed_, .backward = backward});
    gaps_known_ = true;
}

void ContactSolver::list_positions() {
    gaps_known_ = false;
    if (round_.any()) list(1, Stage::Positions, {.work = Work::Show});
    list(slot_of_row_.size(), Stage::Positions, {.work = Work::Advance, .substep = ++moves_listed_}, all_parts_.data());
    if (slender_.any()) list(1, Stage::Positions, {.work = Work::Swing});
    if (round_.any()) list(1, Stage::Positions, {.work = Work::Hide});
}

void ContactSolver::run_listed(Executor& executor, std::span<double> milliseconds) {
    SerialExecutor alone;
    loop_.run(
        phases_, part_count_ > 1 && PhaseLoop::part_count(executor) == part_count_ ? executor : alone,
        [this](std::size_t phase, std::size_t begin, std::size_t end) { run_task(tasks_[phase], begin, end); }, milliseconds);
    phases_.clear();
    tasks_.clear();
}

// Where bodies have moved since the last pass, the inertia of some may have, too.
bool ContactSolver::renews(const Task& task) const noexcept { return !task.settings.gaps_known && turning_.renewed_any(task.substep); }

void ContactSolver::solve(std::span<ContactBundle> some, const Task& task) {
    if (renews(task)) renew_masses(some, rows_, turning_.renewed());
    dynamics::solve(some, rows_, task.settings);
}

void ContactSolver::run_task(const Task& task, std::size_t begin, std::size_t end) {
    const std::span<ContactBundle> all{bundles_};
    const std::span<ContactBundle> overflow = all.subspan(first_overflow_bundle_);  // these may share bodies
    const auto for_some = [&](const auto& work) {
        if (task.first_color == task.end_color) return work(all.subspan(task.first_bundle + begin, end - begin));
        for (std::uint32_t k = task.first_color; k < task.end_color; ++k) {
            const Color& color = colors_[task.backward ? task.first_color + task.end_color - 1 - k : k];
            work(all.subspan(color.first, color.count));
        }
    };
    switch (task.work) {
        case Work::Kick:
            kick(rows_, begin, end, task.warm_start);
            break;
        case Work::Damp:
            rules_.damp(rows_);
            break;
        case Work::Precess:
            slender_.precess(rows_);
            break;
        case Work::Show:
            round_.show(rows_);
            break;
        case Work::Hide:
            round_.hide(rows_);
            break;
        case Work::WarmStart:
            for_some([&](std::span<ContactBundle> some) { dynamics::warm_start(some, rows_); });
            break;
        case Work::Solve:
            for_some([&](std::span<ContactBundle> some) { solve(some, task); });
            break;
        case Work::WarmStartOverflow:
            for (std::size_t i = 0; i < overflow.size(); ++i) dynamics::warm_start(overflow.subspan(i, 1), rows_);
            break;
        case Work::SolveOverflow:
            for (std::size_t i = 0; i < overflow.size(); ++i) solve(overflow.subspan(i, 1), task);
            break;
        case Work::WarmStartRows:
            rolling_.warm_start(rows_);
            rules_.lock(rows_);
            break;
        case Work::SolveRows:
            if (renews(task)) rolling_.renew(rows_, turning_.renewed());
            rolling_.solve(rows_, bundles_);
            rules_.lock(rows_);
            break;
        case Work::Advance:
            turning_.advance(rows_, begin, end, task.substep);
            break;
        case Work::Swing:
            slender_.swing(rows_);
            break;
    }
}

}  // namespace carom::dynamics
