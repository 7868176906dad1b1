#pragma once
#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace posefusion::synth {

/// Calls work(i) for i in [0, count) on several threads. work must not throw, and what it writes must depend on i only.
template <class Work>
void parallel_for(int count, int threads, const Work& work) {
    if (threads <= 0) threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    threads = std::min(threads, count);
    std::atomic<int> next{0};
    const auto drain = [&] {
        for (int i = next.fetch_add(1); i < count; i = next.fetch_add(1)) work(i);
    };
    std::vector<std::jthread> pool;
    for (int i = 1; i < threads; ++i) pool.emplace_back(drain);
    drain();
}

}  // namespace posefusion::synth
