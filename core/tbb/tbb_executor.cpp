#include <carom/core/tbb/tbb_executor.hpp>

#include <carom/core/check.hpp>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <optional>

namespace carom {
namespace {

int checked(int threads) {
    CAROM_REQUIRE(threads >= 1, ErrorCode::InvalidArgument, "an executor needs at least one thread", 1);
    return threads;
}

}  // namespace

struct TbbExecutor::Arena {
    explicit Arena(int threads) : arena(threads) {
        if (threads > oneapi::tbb::info::default_concurrency()) {
            limit.emplace(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
        }
    }
    std::optional<oneapi::tbb::global_control> limit;  // only to be wider than the machine; never lowers others' limit
    oneapi::tbb::task_arena arena;
};

TbbExecutor::TbbExecutor(int threads) : arena_(std::make_unique<Arena>(checked(threads))) {}
TbbExecutor::~TbbExecutor() = default;

int TbbExecutor::thread_count() const noexcept { return arena_->arena.max_concurrency(); }

void TbbExecutor::parallel_for(std::size_t count, std::size_t grain, Body body) {
    if (count == 0) return;
    grain = std::max<std::size_t>(grain, 1);
    if (count <= grain || thread_count() == 1) {
        body(0, count);
        return;
    }
    arena_->arena.execute([&] {
        // A range is halved while it is longer than what stands here, and no half may be shorter than the grain.
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, count, 2 * grain - 1),
                                  [&](const auto& range) { body(range.begin(), range.end()); });
    });
}

}  // namespace carom
