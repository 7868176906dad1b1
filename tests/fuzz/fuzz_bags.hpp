#pragma once
#include <memory>

#include "hosts/io/sources/bags/bag_source.hpp"
#include "tests/fuzz/fuzz_recording.hpp"

namespace posefusion::fuzz {

/// The frames of a file that is taken to be of a certain kind of bags.
template <class Bag>
std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& file, const SourceOptions& options) {
    return frames_of_bag(std::make_unique<Bag>(file), "bag", options);
}

}  // namespace posefusion::fuzz
