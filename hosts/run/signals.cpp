#include "hosts/run/signals.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <string_view>

namespace posefusion {
namespace {

constexpr std::array kRequests{SIGINT, SIGTERM, SIGHUP};
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::int64_t kOneRequest = kNanosecondsPerSecond;  // signals closer together count as one request
constexpr std::string_view kAskedAgain =
    "\nposefusion: what was computed is being saved; a third Ctrl-C ends at once and loses it\n";

std::atomic<int> requests = 0;
std::atomic<std::int64_t> last_request = 0;  // nanoseconds since the machine was started
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free,
              "may be written by a signal handler");

/// Only async-signal-safe functions may be called here.
void note_request(int signal) {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    const std::int64_t now = time.tv_sec * kNanosecondsPerSecond + time.tv_nsec;
    const bool same = requests > 0 && now - last_request < kOneRequest;
    last_request = now;
    if (same) return;
    if (++requests == 2) {
        [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, kAskedAgain.data(), kAskedAgain.size());
    } else if (requests > 2) {
        std::signal(signal, SIG_DFL);
        ::raise(signal);
    }
}

}  // namespace

void handle_signals() {
    struct sigaction action {};
    action.sa_handler = note_request;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (const int signal : kRequests) sigaddset(&action.sa_mask, signal);
    for (const int signal : kRequests) {
        struct sigaction before {};
        sigaction(signal, nullptr, &before);
        const bool wanted = signal != SIGHUP || before.sa_handler != SIG_IGN;  // nohup: the run outlives its terminal
        if (wanted) sigaction(signal, &action, nullptr);
    }
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() { return requests > 0; }

}  // namespace posefusion
