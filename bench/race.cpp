#include <carom/bench/race.hpp>

#include <algorithm>
#include <ctime>

namespace carom::bench {
namespace {

double cpu_now_ns() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

}  // namespace

std::vector<double> race(std::span<const Turn> contenders, const RaceLength& length) {
    std::vector<std::vector<double>> passes(contenders.size());
    for (int pass = 0; pass <= length.passes; ++pass) {
        std::vector<double> spent(contenders.size(), 0.0);
        for (std::size_t first = 0; first < length.items; first += length.turn) {
            for (std::size_t k = 0; k < contenders.size(); ++k) {
                const double start = cpu_now_ns();
                contenders[k](first);
                spent[k] += cpu_now_ns() - start;
            }
        }
        if (pass == 0) continue;  // warm-up
        for (std::size_t k = 0; k < contenders.size(); ++k) passes[k].push_back(spent[k] / static_cast<double>(length.items));
    }
    std::vector<double> medians;
    for (std::vector<double>& times : passes) {
        std::ranges::sort(times);
        medians.push_back(times[times.size() / 2]);
    }
    return medians;
}

}  // namespace carom::bench
