#pragma once

namespace posefusion {

/// From now on a request to stop (SIGINT by Ctrl-C, SIGTERM, SIGHUP when the terminal closes) is recorded instead of
/// ending the program. Requests within one second count once; the second request prints a line, the third ends the
/// program as usual. Under nohup SIGHUP stays ignored. A closed pipe and the file size limit become errors of the write
/// that hits them, so that no results are lost.
void handle_signals();

/// Whether there has been such a request.
[[nodiscard]] bool interrupted();

}  // namespace posefusion
