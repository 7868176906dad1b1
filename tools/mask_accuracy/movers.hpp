#pragma once
#include <filesystem>

namespace posefusion::mask_accuracy {

/// Measures what is found to move, without a run: the motion of the camera and the people are the true ones, so that
/// only the evidence of motion and its cut are judged. Prints a line, and with `every` > 0 one for each so many frames.
/// Throws Error.
void measure_movers(const std::filesystem::path& recording, int max_frames, int every);

}  // namespace posefusion::mask_accuracy
