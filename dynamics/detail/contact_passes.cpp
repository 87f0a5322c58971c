// The passes of a step's substeps: what is done in which order, and by whom.
#include <carom/dynamics/detail/body_kernels.hpp>
#include <carom/dynamics/detail/contact_kernels.hpp>
#include <carom/dynamics/detail/contact_solver.hpp>

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
    const std::uint32_t* starts = color_parts_.data();
    for (std::uint32_t c = 0; c < colors_.size(); ++c, starts += part_count_ + 1) {
        Task some = task;
        some.first_color = some.end_color = c;
        while (some.end_color < colors_.size() && colors_[some.end_color].count == 1) ++some.end_color;
        if (some.end_color > c) {  // there is nothing to share
            list(1, stage, some);
            starts += (some.end_color - 1 - c) * (part_count_ + 1);
            c = some.end_color - 1;
            continue;
        }
        some.first_bundle = colors_[c].first;
        list(colors_[c].count, stage, some, starts);
    }
    Task rest = task;
    rest.work = task.work == Work::WarmStart ? Work::WarmStartRest : Work::SolveRest;
    if (first_overflow_bundle_ < bundles_.size() || !rolling_.is_empty() || rules_.lock_any()) list(1, stage, rest);
}

void ContactSolver::list_warm_start() { list_contacts(Stage::WarmStart, {.work = Work::WarmStart}); }

void ContactSolver::list_pass(bool bias) {
    const SolveSettings settings{.inverse_h = static_cast<float>(1.0 / settings_.substep()), .bias = bias, .gaps_known = gaps_known_};
    list_contacts(bias ? Stage::Solve : Stage::Relax, {.work = Work::Solve, .settings = settings, .substep = moves_listed_});
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
        for (std::uint32_t c = task.first_color; c < task.end_color; ++c) work(all.subspan(colors_[c].first, colors_[c].count));
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
        case Work::WarmStartRest:
            for (std::size_t i = 0; i < overflow.size(); ++i) dynamics::warm_start(overflow.subspan(i, 1), rows_);
            rolling_.warm_start(rows_);
            rules_.lock(rows_);
            break;
        case Work::SolveRest:
            for (std::size_t i = 0; i < overflow.size(); ++i) solve(overflow.subspan(i, 1), task);
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
