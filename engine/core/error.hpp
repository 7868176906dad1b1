#pragma once
#include <stdexcept>
#include <string>

namespace posefusion {

/// A fault that the user can correct. what() is ONE line: what is wrong, where, what to do. Hosts print it and exit
/// non-zero.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace posefusion
