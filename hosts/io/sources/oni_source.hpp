#pragma once
#include "hosts/io/frame_source.hpp"
#include "hosts/io/input_file.hpp"

namespace posefusion {

/// An .oni file, as OpenNI2 records it (container NI10): depth raw or in OpenNI's own coding (16zP, 16zT), colour raw R
/// G B or JPEG, both registered to each other and of the same size, paired within 20 ms. Read without OpenNI2: its own
/// player trusts every number in a file, and the one of Debian 12 crashes on files of its own recorder. The camera
/// comes from options.camera_file, else from the fields of view in the file, with a warning.
[[nodiscard]] std::unique_ptr<FrameSource> open_oni(const std::filesystem::path& file, const SourceOptions& options);

/// OpenNI's coding of depth images as differences. 16zP: the first value in 16 bit, then bytes:
///   0xAB (A, B < 13)  two values, 6 - A and 6 - B more than the one before each
///   0xAD              one value like that
///   0xAF              one value like that, then a full value
///   0xEn              2 n values like the one before
///   0xFF              one full value
/// A full value is a byte c >= 128 for 192 - c more than the one before, else two bytes, high byte first.
/// 16zT: 16-bit length of a table, the table, and indices into it, coded as above.
/// @param pixels  expected number of pixels. Throws Error.
void decode_oni_depth(ByteView packed, bool with_table, std::span<std::uint16_t> pixels, const std::string& name);

}  // namespace posefusion
