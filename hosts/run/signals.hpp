#pragma once

namespace posefusion {

/// From now on Ctrl-C (SIGINT) and SIGTERM are noted instead of ending the program; a second one ends it as usual. A
/// closed pipe and a file size limit become errors of the write that met them, so that nothing computed is lost.
void handle_signals();

/// Has there been a Ctrl-C or SIGTERM?
[[nodiscard]] bool interrupted();

}  // namespace posefusion
