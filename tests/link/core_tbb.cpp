// carom::core_tbb linked alone.
#include <carom/core/tbb/tbb_executor.hpp>

#include <atomic>

int main() {
    std::atomic<std::size_t> covered{0};
    carom::TbbExecutor executor(2);
    executor.parallel_for(1000, 10, [&](std::size_t begin, std::size_t end) { covered += end - begin; });
    return covered == 1000 ? 0 : 1;
}
