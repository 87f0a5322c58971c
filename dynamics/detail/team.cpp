#include <carom/dynamics/detail/team.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <exception>
#include <thread>

namespace carom::dynamics {
namespace {

constexpr int kSpins = 8000;  // some 400 µs

/// A part of a loop: the loop's number, the end of its blocks and the next one of them, in one word, so that who takes a block knows that it is of that loop.
constexpr std::uint64_t ticket(std::uint32_t loop, std::size_t next, std::size_t end) noexcept {
    return std::uint64_t{loop} << 32 | end << 16 | next;
}
constexpr std::size_t next_of(std::uint64_t ticket) noexcept { return ticket & 0xffff; }
constexpr std::size_t end_of(std::uint64_t ticket) noexcept { return ticket >> 16 & 0xffff; }

}  // namespace

void pause_or_yield(int count) noexcept {
    if (count < kSpins) {
        hwy::Pause();
    } else {
        std::this_thread::yield();  // whoever is waited for may be without a processor
    }
}

void Team::run(Executor& executor, FunctionRef<void()> work) {
    std::exception_ptr thrown;
    has_leader_.store(false, std::memory_order_relaxed);
    is_over_.store(false, std::memory_order_relaxed);
    helpers_.store(0, std::memory_order_relaxed);
    threads_ = executor.thread_count();
    const auto lead = [&] {
        try {
            work();
        } catch (...) {
            thrown = std::current_exception();  // the executor need not know how to pass it on
        }
        is_over_.store(true, std::memory_order_release);
        loop_.fetch_add(1, std::memory_order_release);
        loop_.notify_all();
    };
    const struct Leave {  // an executor may throw itself
        int& threads;
        ~Leave() { threads = 0; }
    } leave{threads_};
    executor.parallel_for(static_cast<std::size_t>(threads_), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!has_leader_.exchange(true, std::memory_order_relaxed)) {
                lead();
            } else {
                help(helpers_.fetch_add(1, std::memory_order_relaxed) + 1);
            }
        }
    });
    if (thrown) std::rethrow_exception(thrown);
}

void Team::help(std::uint32_t thread) noexcept {
    std::uint32_t last = loop_.load(std::memory_order_acquire);
    take_blocks(thread, last);  // it may be open
    for (int spins = 0; !is_over_.load(std::memory_order_acquire);) {
        const std::uint32_t loop = loop_.load(std::memory_order_acquire);
        if (loop != last) {
            take_blocks(thread, loop);
            last = loop;
            spins = 0;
        } else if (++spins < kSpins) {
            hwy::Pause();
        } else {
            loop_.wait(loop, std::memory_order_acquire);
        }
    }
}

void Team::take_blocks(std::uint32_t thread, std::uint32_t loop) noexcept {
    const std::size_t parts = parts_.load(std::memory_order_relaxed);
    std::size_t mine = 0;
    for (std::size_t k = 0; k < parts; ++k) {
        std::atomic<std::uint64_t>& part = parts_left_[(thread + k) % parts].ticket;
        std::uint64_t taken = part.load(std::memory_order_relaxed);
        while (taken >> 32 == loop && next_of(taken) < end_of(taken)) {
            if (!part.compare_exchange_weak(taken, taken + 1, std::memory_order_acq_rel, std::memory_order_relaxed)) continue;
            // The loop is not over before this block is done: all of this is its own.
            const std::size_t count = count_.load(std::memory_order_relaxed), blocks = blocks_.load(std::memory_order_relaxed);
            const std::size_t block = next_of(taken);
            (*body_.load(std::memory_order_relaxed))(block * count / blocks, (block + 1) * count / blocks);
            ++mine;
            taken = part.load(std::memory_order_relaxed);
        }
    }
    if (mine > 0) done_.fetch_add(mine, std::memory_order_acq_rel);
}

void Team::parallel_for(std::size_t count, std::size_t grain, Body body) {
    if (count == 0) return;
    const std::size_t parts = std::min(static_cast<std::size_t>(thread_count()), kMostParts);
    const std::size_t blocks = std::min(count / std::max<std::size_t>(grain, 1), parts * kBlocksOfAPart);
    if (parts == 1 || blocks <= 1 || in_loop_.load(std::memory_order_relaxed)) {
        body(0, count);
        return;
    }
    const std::uint32_t loop = loop_.load(std::memory_order_relaxed) + 1;
    body_.store(&body, std::memory_order_relaxed);
    count_.store(count, std::memory_order_relaxed);
    blocks_.store(blocks, std::memory_order_relaxed);
    parts_.store(parts, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    in_loop_.store(true, std::memory_order_relaxed);
    for (std::size_t part = 0; part < parts; ++part) {
        parts_left_[part].ticket.store(ticket(loop, part * blocks / parts, (part + 1) * blocks / parts), std::memory_order_release);
    }
    loop_.store(loop, std::memory_order_release);
    loop_.notify_all();  // a comparison where nobody sleeps
    take_blocks(0, loop);
    for (int spins = 0; done_.load(std::memory_order_acquire) < blocks; ++spins) pause_or_yield(spins);
    in_loop_.store(false, std::memory_order_relaxed);
}

}  // namespace carom::dynamics
