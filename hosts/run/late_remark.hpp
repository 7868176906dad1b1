#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace posefusion {

/// Calls `say` if this object lives longer than `patience` and is not cancelled before.
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
    std::jthread thread_;  // stopped and joined by its destructor
};

}  // namespace posefusion
