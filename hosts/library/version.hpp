#pragma once

namespace posefusion {

/// "0.1.0"
[[nodiscard]] const char* version();

}  // namespace posefusion
