#pragma once
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

namespace posefusion::test {

/// A display that nobody sees (Xvfb), for as long as this lives.
class VirtualDisplay {
public:
    explicit VirtualDisplay(const char* xvfb) {
        int ends[2];
        if (pipe(ends) != 0) return;
        pid_ = fork();
        if (pid_ == 0) {
            prctl(PR_SET_PDEATHSIG, SIGTERM);  // a killed test leaves nothing behind
            close(ends[0]);
            const std::string descriptor = std::to_string(ends[1]);
            execl(xvfb, xvfb, "-displayfd", descriptor.c_str(), "-screen", "0", "1400x900x24", "-nolisten", "tcp",
                  "-noreset", static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        // it writes its number when it is ready
        for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number_ += c;
        close(ends[0]);
    }
    ~VirtualDisplay() {
        if (pid_ <= 0) return;
        kill(pid_, SIGTERM);
        waitpid(pid_, nullptr, 0);
    }
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    /// For DISPLAY; empty if Xvfb could not be started.
    [[nodiscard]] std::string name() const { return number_.empty() ? "" : ":" + number_; }

private:
    pid_t pid_ = -1;
    std::string number_;
};

}  // namespace posefusion::test
