#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <string>

namespace posefusion {

inline constexpr std::size_t kEndless = std::numeric_limits<std::size_t>::max();

/// The progress of a run.
struct Progress {
    std::size_t done = 0, total = 0;  ///< frames; total is kEndless for a camera
    double frames_per_second = 0;     ///< 0 = not known yet
    std::string state;                ///< further information
};

/// "frame 120/170   3.4 fps   ETA 0:15   " and the state
[[nodiscard]] std::string progress_text(const Progress& progress);

/// The text after a progress bar if there is room, in fewer than `columns` characters.
[[nodiscard]] std::string progress_bar(const Progress& progress, std::size_t columns);

/// "412 k surfels   2 people"
[[nodiscard]] std::string map_text(std::uint32_t surfels, int people);

/// Frames per second since the end of the first frame, which includes one-time costs.
class FrameRate {
public:
    /// @return 0 while unknown
    double after(std::size_t frames_done);

private:
    std::chrono::steady_clock::time_point first_{};
};

/// The standard error stream during a run: a progress bar on a terminal, otherwise a line now and then, and warnings in
/// between. Thread-safe.
class Console {
public:
    Console();
    ~Console();  ///< ends the bar
    Console(const Console&) = delete;
    Console& operator=(const Console&) = delete;

    void progress(std::size_t frames_done, std::size_t frames_total, const std::string& state = {});
    void warning(const std::string& text);
    void remark(const std::string& text);  ///< a line of information
    void end_progress();

private:
    void line(const std::string& text);
    void clear_bar();  // requires the lock

    std::mutex mutex_;
    bool terminal_;
    FrameRate rate_;
    std::string bar_;  // as currently shown on the terminal
    std::chrono::steady_clock::time_point drawn_{};
};

}  // namespace posefusion
