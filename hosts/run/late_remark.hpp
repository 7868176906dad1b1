#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace posefusion {

/// Calls `say` if this lives longer than `patience` and was not told that there is no need to.
class LateRemark {
public:
    LateRemark(std::chrono::milliseconds patience, std::function<void()> say)
        : thread_([patience, say = std::move(say)](const std::stop_token& needless) {
              std::mutex mutex;
              std::unique_lock lock(mutex);
              std::condition_variable_any never;
              never.wait_for(lock, needless, patience, [] { return false; });
              if (!needless.stop_requested()) say();
          }) {}

    void needless() { thread_.request_stop(); }

private:
    std::jthread thread_;  // ended and waited for by its destructor
};

}  // namespace posefusion
