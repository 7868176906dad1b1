#include "hosts/pipeline/bounded_queue.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>

namespace posefusion {
namespace {

TEST(BoundedQueue, KeepsOrderAndEndsWhenClosedAndEmpty) {
    BoundedQueue<int> queue(3);
    ASSERT_TRUE(queue.push(1));
    ASSERT_TRUE(queue.push(2));
    queue.close();
    EXPECT_EQ(queue.pop(), 1);
    EXPECT_EQ(queue.pop(), 2);
    EXPECT_EQ(queue.pop(), std::nullopt);
    EXPECT_FALSE(queue.push(3));
}

TEST(BoundedQueue, AFastProducerWaitsForASlot) {
    BoundedQueue<int> queue(3);
    std::atomic<int> pushed = 0;
    std::jthread producer([&] {
        for (int i = 0; i < 100; ++i) {
            queue.push(i);
            ++pushed;
        }
        queue.close();
    });
    int popped = 0;
    while (const std::optional<int> element = queue.pop()) {
        EXPECT_EQ(*element, popped++);
        // Three in the queue and one that was just put back into the freed slot.
        EXPECT_LE(pushed, popped + 4);
    }
    EXPECT_EQ(popped, 100);
}

TEST(BoundedQueue, AbandonWakesAWaitingProducerAndDropsTheElements) {
    BoundedQueue<std::shared_ptr<int>> queue(1);
    auto element = std::make_shared<int>(7);
    const std::weak_ptr<int> watch = element;
    ASSERT_TRUE(queue.push(std::move(element)));
    std::jthread producer([&] { EXPECT_FALSE(queue.push(std::make_shared<int>(8))); });
    queue.abandon();
    producer.join();
    EXPECT_TRUE(watch.expired());
    EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(BoundedQueue, CloseWakesAWaitingConsumer) {
    BoundedQueue<int> queue(1);
    std::jthread consumer([&] { EXPECT_EQ(queue.pop(), std::nullopt); });
    queue.close();
}

TEST(BoundedQueue, TakesElementsThatCanOnlyBeMoved) {
    BoundedQueue<std::unique_ptr<int>> queue(1);
    queue.push(std::make_unique<int>(5));
    EXPECT_EQ(**queue.pop(), 5);
}

}  // namespace
}  // namespace posefusion
