#pragma once
#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// ElasticFusion's log (reference: the format as that project's tools write it): int32 number of frames; per frame
/// int64 stamp in microseconds, int32 bytes of depth, int32 bytes of colour, depth (16 bit, zlib, or raw when it has
/// exactly width x height x 2 bytes), colour (JPEG, or raw R G B when it has exactly width x height x 3 bytes, or
/// absent). All numbers little-endian. All complete frames are used, with a warning if their number differs from the
/// one in the header. A log in which no frame has colour is read as grey, with a warning.
///
/// A log does not describe its camera. It comes from options.camera_file, else NAME.yaml beside NAME.klg, both with
/// millimetres where depth_scale is missing; else ElasticFusion's default is assumed, with a warning.
/// NAME.groundtruth.txt beside it is the ground truth.
[[nodiscard]] std::unique_ptr<FrameSource> open_klg(const std::filesystem::path& file, const SourceOptions& options);

/// Files that belong to a log.
[[nodiscard]] std::filesystem::path klg_camera_file(std::filesystem::path klg);
[[nodiscard]] std::filesystem::path klg_groundtruth_file(std::filesystem::path klg);

}  // namespace posefusion
