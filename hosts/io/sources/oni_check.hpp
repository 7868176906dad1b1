#pragma once
#include <cstddef>

#include "hosts/io/input_file.hpp"

namespace posefusion {

/// Walks over the records of an .oni file (OpenNI2's format NI10) and throws Error where their chain does not hold:
/// another format, a record that reaches beyond the file, images of absurd size. OpenNI2 itself believes what it reads.
/// @return number of frames of all streams together
std::size_t check_oni(const InputFile& file);

}  // namespace posefusion
