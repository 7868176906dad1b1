#pragma once

namespace posefusion {

/// From now on a request to end (SIGINT of Ctrl-C, SIGTERM, SIGHUP of a terminal that goes away) is noted instead of
/// ending the program. Requests within a second of each other are one; the second is answered with a line, the third
/// ends the program as usual. Under nohup SIGHUP remains ignored. A closed pipe and a file size limit become errors of
/// the write that met them, so that nothing computed is lost.
void handle_signals();

/// Has there been such a request?
[[nodiscard]] bool interrupted();

}  // namespace posefusion
