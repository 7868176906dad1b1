#pragma once
#include <array>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "hosts/pipeline/bounded_queue.hpp"

/// Three stages that work on successive items at the same time, each on its own thread, joined by bounded queues.
/// Independent of frames: each stage is given as a function.
namespace posefusion {

/// Slots of each queue. Three as in a triple buffer: one being written, one ready, one being read.
inline constexpr std::size_t kQueueSlots = 3;

/// The queue after the source, for a source that drops frames when the queue is full.
struct Entrance {
    std::function<bool()> has_room = [] { return true; };
    std::function<bool()> closed = [] { return false; };  ///< the consumer has stopped
};

template <class Item>
struct Stages {
    std::function<std::optional<Item>()> source;  ///< the next item; std::nullopt at the end, and when cancelled
    std::function<void(Item&)> middle;
    std::function<void(Item&)> sink;
    /// Called once, before the first `source`; its argument is valid until the run ends.
    std::function<void(const Entrance&)> entrance = [](const Entrance&) {};
    /// Called when `sink` will produce no more results, so that a `middle` waiting for them wakes up.
    std::function<void()> sink_ended = [] {};
    /// Checked before every step of every stage; true drops queued items and ends the run.
    std::function<bool()> cancelled = [] { return false; };
};

struct PipelineOutcome {
    std::exception_ptr error;  ///< that of the earliest item, as in a sequential run; null = none
    bool cancelled = false;
};

enum class Schedule {
    Pipelined,   ///< source and middle on threads of their own, sink on the calling thread
    Sequential,  ///< one item after the other on the calling thread; same results
};

namespace pipeline_detail {

template <class Item>
PipelineOutcome run_sequential(const Stages<Item>& stages) {
    PipelineOutcome outcome;
    try {
        stages.entrance({});
        while (!(outcome.cancelled = stages.cancelled())) {
            std::optional<Item> item = stages.source();
            if (!item) {
                outcome.cancelled = stages.cancelled();
                break;
            }
            stages.middle(*item);
            stages.sink(*item);
        }
    } catch (...) {
        outcome.error = std::current_exception();
    }
    stages.sink_ended();
    return outcome;
}

template <class Item>
PipelineOutcome run_pipelined(const Stages<Item>& stages) {
    BoundedQueue<Item> read(kQueueSlots), prepared(kQueueSlots);
    stages.entrance({[&] { return read.has_room(); }, [&] { return read.closed(); }});
    // Per stage, in the order of the flow. Each is written by one thread and read after the join.
    std::array<std::exception_ptr, 3> errors;
    std::array<bool, 3> cancelled{};

    // A stage runs until its input ends, its output is no longer wanted, it fails or the run is cancelled. In any case,
    // `finish` tells both neighbours: downstream finishes the items already passed on, upstream stops.
    const auto run_stage = [&](std::size_t stage, auto&& step, auto&& finish) {
        try {
            while (!(cancelled[stage] = stages.cancelled())) {
                if (!step()) break;
            }
        } catch (...) {
            errors[stage] = std::current_exception();
        }
        finish();
    };

    {
        std::jthread reader([&] {
            run_stage(
                0,
                [&] {
                    std::optional<Item> item = stages.source();
                    if (!item) cancelled[0] = stages.cancelled();
                    return item && read.push(std::move(*item));
                },
                [&] { read.close(); });
        });
        std::jthread preparer([&] {
            run_stage(
                1,
                [&] {
                    std::optional<Item> item = read.pop();
                    if (!item) return false;
                    stages.middle(*item);
                    return prepared.push(std::move(*item));
                },
                [&] {
                    read.abandon();
                    prepared.close();
                });
        });
        run_stage(
            2,
            [&] {
                std::optional<Item> item = prepared.pop();
                if (!item) return false;
                stages.sink(*item);
                return true;
            },
            [&] {
                prepared.abandon();
                stages.sink_ended();
            });
    }  // joins

    PipelineOutcome outcome;
    outcome.cancelled = cancelled[0] || cancelled[1] || cancelled[2];
    // A stage only sees items that passed the previous one, so an error further downstream concerns an earlier item.
    for (const std::exception_ptr& error : errors) {
        if (error) outcome.error = error;
    }
    return outcome;
}

}  // namespace pipeline_detail

/// Runs until the source ends, a stage throws or `cancelled` says so. An error in one stage stops those before it while
/// those after it finish the items already passed on, so everything before the faulty item is complete. Never throws.
template <class Item>
[[nodiscard]] PipelineOutcome run_pipeline(const Stages<Item>& stages, Schedule schedule) {
    return schedule == Schedule::Sequential ? pipeline_detail::run_sequential(stages)
                                            : pipeline_detail::run_pipelined(stages);
}

}  // namespace posefusion
