#pragma once
// A child process for tests that run the real binaries: started without a shell, its stdout and stderr kept in files of
// an own temporary folder, ended with the object. POSIX; one thread at a time.

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

extern char** environ;

namespace terrane::testing_support {

/// For GLIBC_TUNABLES: the C library then chooses its functions as on a CPU without fused multiply-add. Names of glibc
/// 2.26 to 2.32 end in _Usable; what a version does not know it ignores.
inline constexpr std::string_view kWithoutFma =
    "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-FMA4_Usable,-AVX2,-FMA,-FMA4,-AVX512F";

inline std::string readFile(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

class ChildProcess {
 public:
  explicit ChildProcess(const std::vector<std::string>& command) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, 1, (folder_ / "stdout").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&files, 2, (folder_ / "stderr").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (posix_spawn(&pid_, arguments[0], &files, nullptr, arguments.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&files);
  }
  ~ChildProcess() { kill(); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  bool started() const { return pid_ > 0; }
  std::string output() const { return readFile(folder_ / "stdout"); }
  std::string errors() const { return readFile(folder_ / "stderr"); }

  /// The exit status, 128 + the signal if one ended it; empty if it still runs after the time.
  std::optional<int> wait(std::chrono::milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    while (!status_) {
      int raw = 0;
      if (pid_ <= 0 || waitpid(pid_, &raw, WNOHANG) == pid_) {
        status_ = pid_ <= 0 ? 127 : WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
        break;
      }
      if (std::chrono::steady_clock::now() > end) return std::nullopt;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return status_;
  }

  /// Ends it at once and waits for its end.
  void kill() {
    if (pid_ > 0 && !status_) {
      ::kill(pid_, SIGKILL);
      wait(std::chrono::hours(1));
    }
  }

  /// The text after a prefix on a line of stdout or stderr, once it is there; empty if the process ends or the time is
  /// over first.
  std::string waitForLine(const std::string& contained, std::chrono::milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    for (;;) {
      const bool last = wait(std::chrono::milliseconds(0)).has_value() || std::chrono::steady_clock::now() > end;
      std::istringstream lines(output() + errors());
      for (std::string line; std::getline(lines, line);)
        if (line.find(contained) != std::string::npos && !lines.eof()) return line;
      if (last) return {};
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

 private:
  TemporaryFolder folder_;
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace terrane::testing_support
