#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace posefusion {

/// First-in-first-out queue between two threads that holds at most `capacity` elements: a fast producer waits.
/// One lock and two conditions; at tens of frames a second nothing finer would be measurable.
template <class T>
class BoundedQueue {
public:
    explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

    /// Waits for a free slot. @return false if the consumer is gone: the element was not taken, stop producing
    bool push(T element) {
        std::unique_lock lock(mutex_);
        has_space_.wait(lock, [&] { return elements_.size() < capacity_ || closed_; });
        if (closed_) return false;
        elements_.push_back(std::move(element));
        lock.unlock();
        has_element_.notify_one();
        return true;
    }

    /// Whether push() would return at once. Once true it stays true until the only producer pushes.
    [[nodiscard]] bool has_room() const {
        const std::lock_guard lock(mutex_);
        return elements_.size() < capacity_ || closed_;
    }
    [[nodiscard]] bool closed() const {
        const std::lock_guard lock(mutex_);
        return closed_;
    }

    /// Waits for an element. @return std::nullopt once the queue is closed and empty
    std::optional<T> pop() {
        std::unique_lock lock(mutex_);
        has_element_.wait(lock, [&] { return !elements_.empty() || closed_; });
        if (elements_.empty()) return std::nullopt;
        std::optional<T> element(std::move(elements_.front()));
        elements_.pop_front();
        lock.unlock();
        has_space_.notify_one();
        return element;
    }

    /// Called by the producer: no more elements will come. Queued ones can still be popped.
    void close() {
        shut([] {});
    }

    /// Called by the consumer: no more elements will be taken. Queued ones are dropped, a waiting producer wakes up.
    void abandon() {
        shut([&] { elements_.clear(); });
    }

private:
    template <class Action>
    void shut(Action&& action) {
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
            action();
        }
        has_space_.notify_all();
        has_element_.notify_all();
    }

    const std::size_t capacity_;
    mutable std::mutex mutex_;
    std::condition_variable has_space_, has_element_;
    std::deque<T> elements_;
    bool closed_ = false;
};

}  // namespace posefusion
