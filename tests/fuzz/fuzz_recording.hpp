#pragma once
#include "hosts/io/frame_source.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace posefusion::fuzz {

using OpenSource = std::unique_ptr<FrameSource> (*)(const std::filesystem::path&, const SourceOptions&);

/// What a target for a format of recordings does: opening, every frame.
inline int read_recording(const std::uint8_t* data, std::size_t size, OpenSource open,
                          const std::filesystem::path& camera = {}) {
    const MemoryFile file(data, size);
    SourceOptions options;
    options.camera_file = camera;
    expect_no_more_than_an_error([&] {
        const auto source = open(file.path(), options);
        for (std::size_t i = 0; i < source->size(); ++i) expect_no_more_than_an_error([&] { (void)source->read(i); });
    });
    return 0;
}

}  // namespace posefusion::fuzz
