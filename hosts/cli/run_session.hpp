#pragma once
#include <filesystem>
#include <functional>
#include <memory>

#include "engine/slam/slam.hpp"
#include "hosts/cli/console.hpp"
#include "hosts/cli/run_record.hpp"
#include "hosts/config/run_config.hpp"
#include "hosts/io/sequence.hpp"
#include "hosts/pipeline/people_finder.hpp"

namespace posefusion {

/// Everything that a run needs, made in an order in which cheap faults show first.
class RunSession {
public:
    /// Throws Error: sequence, model, masks or device cannot be used.
    RunSession(const std::filesystem::path& sequence, const RunConfig& config);

    /// Processes the frames, shows progress, stops at Ctrl-C. Errors are in the record.
    /// @param on_frame  called for every frame when it is done
    [[nodiscard]] RunRecord run(Console& console, const std::function<void(const TrackedFrame&)>& on_frame);

    [[nodiscard]] const Sequence& sequence() const { return sequence_; }
    [[nodiscard]] const Slam& slam() const { return *slam_; }

private:
    [[nodiscard]] std::size_t frames_to_do() const;

    const RunConfig& config_;
    Sequence sequence_;
    std::unique_ptr<PeopleFinder> people_;
    std::unique_ptr<Slam> slam_;
};

/// The line to print for an exception of any kind.
[[nodiscard]] std::string error_text(const std::exception_ptr& error);

}  // namespace posefusion
