#include "client/gl/virtual_display.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <utility>

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kStartLimit{20};
constexpr std::chrono::milliseconds kStopLimit{3000};

struct Pipe {
  int readEnd = -1, writeEnd = -1;
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    closeRead();
    closeWrite();
  }
  bool open() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return false;
    readEnd = ends[0];
    writeEnd = ends[1];
    return true;
  }
  void closeRead() {
    if (readEnd >= 0) close(std::exchange(readEnd, -1));
  }
  void closeWrite() {
    if (writeEnd >= 0) close(std::exchange(writeEnd, -1));
  }
};

/// Reads until a newline, the end of the pipe, or the deadline.
std::string readLine(int descriptor, Clock::time_point deadline) {
  std::string text;
  while (text.find('\n') == std::string::npos) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) break;
    pollfd wait{descriptor, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(left));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) break;
    char buffer[64];
    const ssize_t count = read(descriptor, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    text.append(buffer, static_cast<std::size_t>(count));
  }
  return text;
}

void stopProcess(pid_t process) {
  kill(process, SIGTERM);
  const auto deadline = Clock::now() + kStopLimit;
  while (waitpid(process, nullptr, WNOHANG) == 0) {
    if (Clock::now() > deadline) {
      kill(process, SIGKILL);
      waitpid(process, nullptr, 0);
      return;
    }
    poll(nullptr, 0, 5);
  }
}

/// In the child, between fork and exec: only functions that are safe after a fork of a process with threads.
[[noreturn]] void becomeServer(pid_t parent, int displayPipe, int failurePipe, char* const* arguments) {
  setpgid(0, 0);  // the terminal's Ctrl-C is for the viewer, which then ends the display in order
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() == parent) {
    fcntl(displayPipe, F_SETFD, 0);  // keep it over exec
    const int silence = open("/dev/null", O_RDWR);
    if (silence >= 0) {
      dup2(silence, STDIN_FILENO);
      dup2(silence, STDOUT_FILENO);
      dup2(silence, STDERR_FILENO);
    }
    execvp(arguments[0], arguments);
  }
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(failurePipe, &reason, sizeof reason);
  _exit(127);
}

std::string systemText(int code) { return std::error_code(code, std::generic_category()).message(); }

Error displayError(std::string message) { return makeError(ErrorKind::Io, "display", std::move(message)); }

}  // namespace

Result<VirtualDisplay> VirtualDisplay::start(int widthPixels, int heightPixels) {
  Pipe display, failure;
  if (!display.open() || !failure.open()) return displayError(fmt::format("no pipe: {}", systemText(errno)));

  std::string program = "Xvfb", displayFlag = "-displayfd", displayValue = std::to_string(display.writeEnd),
              screen = "-screen", number = "0",
              size = fmt::format("{}x{}x24", std::max(widthPixels, 64), std::max(heightPixels, 64)),
              closed = "-nolisten", protocol = "tcp", stay = "-noreset";
  char* const arguments[] = {program.data(), displayFlag.data(), displayValue.data(), screen.data(), number.data(),
                             size.data(),    closed.data(),      protocol.data(),     stay.data(),   nullptr};
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process < 0) return displayError(fmt::format("cannot start Xvfb: {}", systemText(errno)));
  if (process == 0) becomeServer(parent, display.writeEnd, failure.writeEnd, arguments);
  display.closeWrite();
  failure.closeWrite();

  int reason = 0;
  ssize_t count = 0;
  do {
    count = read(failure.readEnd, &reason, sizeof reason);  // closed without a word when exec went well
  } while (count < 0 && errno == EINTR);
  if (count == sizeof reason) {
    waitpid(process, nullptr, 0);
    return displayError(reason == ENOENT ? "no DISPLAY and Xvfb is not installed"
                                         : fmt::format("no DISPLAY and Xvfb does not start: {}", systemText(reason)));
  }
  std::string line = readLine(display.readEnd, Clock::now() + kStartLimit);
  if (line.empty() || line.back() != '\n') {
    stopProcess(process);
    return displayError("no DISPLAY and Xvfb ended or did not answer within 20 s");
  }
  line.pop_back();
  return VirtualDisplay(process, ":" + line);
}

VirtualDisplay::VirtualDisplay(VirtualDisplay&& other) noexcept
    : process_(std::exchange(other.process_, -1)), name_(std::move(other.name_)) {}

VirtualDisplay::~VirtualDisplay() {
  if (process_ > 0) stopProcess(process_);
}

}  // namespace terrane
