#include "hosts/run/console.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace posefusion {
namespace {

constexpr std::size_t kLineEvery = 20;  ///< frames between two lines where there is no terminal
constexpr std::size_t kBarWidth = 24;   ///< characters
constexpr std::size_t kColumns = 80;    ///< of a terminal of unknown width
constexpr std::chrono::milliseconds kRedraw{100};

std::string time_left(double seconds) {
    const long rounded = std::lround(seconds);
    return rounded < 3600 ? fmt::format("{}:{:02}", rounded / 60, rounded % 60)
                          : fmt::format("{}:{:02}:{:02}", rounded / 3600, rounded / 60 % 60, rounded % 60);
}

std::string count_text(std::uint32_t count) {
    if (count < 10'000) return fmt::format("{}", count);
    return count < 10'000'000 ? fmt::format("{} k", count / 1000) : fmt::format("{:.1f} M", count / 1e6);
}

/// A closed terminal is no reason to stop: errors are ignored.
void write(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

std::size_t terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kColumns;
}

}  // namespace

std::string progress_text(const Progress& p) {
    const bool endless = p.total == kEndless;
    std::string text = endless ? fmt::format("frame {}", p.done) : fmt::format("frame {}/{}", p.done, p.total);
    if (p.frames_per_second > 0 && endless) {
        text += fmt::format("   {:.1f} fps", p.frames_per_second);
    } else if (p.frames_per_second > 0) {
        const double left = static_cast<double>(p.total - p.done) / p.frames_per_second;
        text += fmt::format("   {:.1f} fps   ETA {}", p.frames_per_second, time_left(left));
    }
    return p.state.empty() ? text : text + "   " + p.state;
}

std::string progress_bar(const Progress& progress, std::size_t columns) {
    std::string text = progress_text(progress);
    if (text.size() + kBarWidth + 3 < columns) {
        const bool known = progress.total > 0 && progress.total != kEndless;
        const std::size_t filled = known ? kBarWidth * progress.done / progress.total : 0;
        text = fmt::format("[{:<{}}] {}", std::string(filled, '#'), kBarWidth, text);
    }
    return text.substr(0, columns - std::min<std::size_t>(columns, 1));
}

std::string map_text(std::uint32_t surfels, int people) {
    return fmt::format("{} surfels   {} {}", count_text(surfels), people, people == 1 ? "person" : "people");
}

double FrameRate::after(std::size_t frames_done) {
    const auto now = std::chrono::steady_clock::now();
    if (frames_done <= 1) {
        first_ = now;
        return 0;
    }
    return static_cast<double>(frames_done - 1) / std::chrono::duration<double>(now - first_).count();
}

Console::Console() : terminal_(isatty(STDERR_FILENO) == 1) {}

Console::~Console() { end_progress(); }

void Console::progress(std::size_t frames_done, std::size_t frames_total, const std::string& state) {
    const std::lock_guard lock(mutex_);
    const Progress progress{frames_done, frames_total, rate_.after(frames_done), state};
    const bool last = frames_done == frames_total;
    if (!terminal_) {
        if (frames_done % kLineEvery == 0 || last) write(progress_text(progress) + "\n");
        return;
    }
    const auto now = std::chrono::steady_clock::now();
    if (!last && now - drawn_ < kRedraw) return;
    drawn_ = now;
    clear_bar();
    bar_ = progress_bar(progress, terminal_columns());
    write(bar_);
}

void Console::warning(const std::string& text) { line("warning: " + text); }

void Console::remark(const std::string& text) { line(text); }

void Console::line(const std::string& text) {
    const std::lock_guard lock(mutex_);
    clear_bar();
    write("posefusion: " + text + "\n" + bar_);
}

void Console::end_progress() {
    const std::lock_guard lock(mutex_);
    if (!bar_.empty()) write("\n");
    bar_.clear();
}

void Console::clear_bar() {
    if (!bar_.empty()) write("\r\033[K");
}

}  // namespace posefusion
