#pragma once
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace posefusion::test {

/// What a program is started with.
struct Program {
    std::vector<std::string> arguments;                              ///< the first is the program itself
    std::vector<std::pair<std::string, std::string>> environment{};  ///< in addition to ours
    std::filesystem::path standard_output{};                         ///< empty = a file that output() reads
    std::optional<rlim_t> max_file_bytes{};
    std::optional<rlim_t> max_address_bytes{};
};

/// A started program whose output goes to two files in `folder`. Killed after `patience`.
class Subprocess {
public:
    Subprocess(const Program& program, const std::filesystem::path& folder,
               std::chrono::seconds patience = std::chrono::seconds(300))
        : out_(folder / "stdout.txt"),
          err_(folder / "stderr.txt"),
          give_up_(std::chrono::steady_clock::now() + patience) {
        std::vector<char*> argv;
        for (const std::string& argument : program.arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        for (const std::filesystem::path& left_by_an_earlier_one : {out_, err_})
            std::filesystem::remove(left_by_an_earlier_one);
        pid_ = fork();
        if (pid_ == 0) start(program, argv.data());
    }
    ~Subprocess() {
        if (!status_) {
            kill(pid_, SIGKILL);
            waitpid(pid_, nullptr, 0);
        }
    }
    Subprocess(const Subprocess&) = delete;
    Subprocess& operator=(const Subprocess&) = delete;

    void send(int signal) const { kill(pid_, signal); }

    /// Waits until the text appears on the standard error stream. @return false if the program ends before
    bool wait_for(const std::string& text) {
        while (error_output().find(text) == std::string::npos) {
            if (ended()) return error_output().find(text) != std::string::npos;
        }
        return true;
    }

    /// Waits for the end. @return the exit code; 1000 + the number of the signal that ended it; -1 after `patience`
    int exit_code() {
        while (!ended()) {
        }
        return *status_;
    }

    [[nodiscard]] std::string output() const { return content(out_); }
    [[nodiscard]] std::string error_output() const { return content(err_); }

private:
    [[noreturn]] void start(const Program& program, char** argv) const {
        // Between fork and exec of a program with one thread.
        const auto redirect = [](const std::filesystem::path& file, int descriptor) {
            dup2(open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644), descriptor);
        };
        redirect(program.standard_output.empty() ? out_ : program.standard_output, STDOUT_FILENO);
        redirect(err_, STDERR_FILENO);
        for (const auto& [name, value] : program.environment) setenv(name.c_str(), value.c_str(), 1);
        const auto limit = [](auto resource, const std::optional<rlim_t>& bytes) {
            if (!bytes) return;
            const rlimit both{*bytes, *bytes};
            setrlimit(resource, &both);
        };
        limit(RLIMIT_FSIZE, program.max_file_bytes);
        limit(RLIMIT_AS, program.max_address_bytes);
        execv(argv[0], argv);
        _exit(127);
    }

    /// Has it ended? Looks for a moment.
    bool ended() {
        if (status_) return true;
        int status = 0;
        if (waitpid(pid_, &status, WNOHANG) == pid_) {
            status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
        } else if (std::chrono::steady_clock::now() > give_up_) {
            kill(pid_, SIGKILL);
            waitpid(pid_, nullptr, 0);
            status_ = -1;
        } else {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return status_.has_value();
    }

    static std::string content(const std::filesystem::path& file) {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    std::filesystem::path out_, err_;
    std::chrono::steady_clock::time_point give_up_;
    pid_t pid_ = -1;
    std::optional<int> status_;
};

}  // namespace posefusion::test
