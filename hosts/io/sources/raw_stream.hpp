#pragma once
#include <memory>

#include "hosts/io/frame_source.hpp"

/// Frames that another program writes into a pipe, as a camera whose library is not linked: docs/raw_stream.md.
namespace posefusion {

/// `raw:-`: standard input. Throws Error: a terminal, not such a stream, camera unknown or not understood.
///
/// Memory is bounded by the size of the images that the camera says. Images that cannot be decoded are Errors of their
/// frame; a stream that ends within a frame, is out of step or gives nothing for too long is lost, and
/// SourceOptions::cancelled ends the waiting.
[[nodiscard]] std::unique_ptr<FrameSource> open_raw_stream(const SourceOptions& options);

/// The same from an open file or pipe, which is not closed. @param location  for messages
[[nodiscard]] std::unique_ptr<FrameSource> open_raw_stream(int descriptor, const std::string& location,
                                                           const SourceOptions& options);

}  // namespace posefusion
