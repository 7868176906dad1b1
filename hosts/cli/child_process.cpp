#include "hosts/cli/child_process.hpp"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <thread>

#include "engine/core/error.hpp"
#include "hosts/run/exit_code.hpp"
#include "hosts/run/run_session.hpp"

namespace posefusion {
namespace {

constexpr std::chrono::milliseconds kLook{20};  // interval for checking the child

[[noreturn]] void be_child(const std::function<int()>& work) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // not to outlive this process
    int exit_code = kExitError;
    try {
        exit_code = work();
    } catch (...) {
        std::fputs(("posefusion: " + error_text(std::current_exception()) + "\n").c_str(), stderr);
    }
    if (std::fflush(stdout) != 0) exit_code = kExitError;
    _exit(exit_code);  // without running the parent's clean-up
}

}  // namespace

int run_in_child(const std::function<int()>& work, const std::function<bool()>& stop) {
    std::fflush(nullptr);  // otherwise both would write buffered output
    const pid_t child = fork();
    if (child < 0) throw Error(std::string("no process can be started: ") + std::strerror(errno));
    if (child == 0) be_child(work);
    bool stopped = false;
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (!stopped && stop()) {
            stopped = true;
            kill(child, SIGKILL);
        }
        std::this_thread::sleep_for(kLook);
    }
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    if (stopped) return kExitInterrupted;
    throw Error(fmt::format("the reconstruction was ended by the system (signal {}); is there enough memory?",
                            WTERMSIG(status)));
}

}  // namespace posefusion
