#include "tests/integration/server_process.h"
#include "tests/support/folders.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <thread>

extern char** environ;

namespace terrane::test {
namespace {

using Clock = std::chrono::steady_clock;

struct Child {
  pid_t pid = -1;
  int output = -1, error = -1;
};

Child spawn(const std::vector<std::string>& command) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) return {};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], 1);
  posix_spawn_file_actions_adddup2(&actions, err[1], 2);
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  Child child{-1, out[0], err[0]};
  if (posix_spawnp(&child.pid, arguments[0], &actions, nullptr, arguments.data(), environ) != 0) child.pid = -1;
  posix_spawn_file_actions_destroy(&actions);
  ::close(out[1]);
  ::close(err[1]);
  return child;
}

/// Reads both pipes to their end.
void drain(const Child& child, FinishedProcess& result) {
  pollfd pipes[2] = {{child.output, POLLIN, 0}, {child.error, POLLIN, 0}};
  std::string* const texts[2] = {&result.standardOutput, &result.standardError};
  const auto end = Clock::now() + std::chrono::seconds(60);
  while ((pipes[0].fd >= 0 || pipes[1].fd >= 0) && Clock::now() < end) {
    if (poll(pipes, 2, 1000) <= 0) continue;
    for (int i = 0; i < 2; ++i) {
      if (pipes[i].fd < 0 || pipes[i].revents == 0) continue;
      char buffer[4096];
      const ssize_t got = ::read(pipes[i].fd, buffer, sizeof buffer);
      if (got <= 0)
        pipes[i].fd = -1;
      else
        texts[i]->append(buffer, static_cast<std::size_t>(got));
    }
  }
}

int waitFor(pid_t pid) {
  int status = 0;
  for (int i = 0; i < 6000; ++i) {
    if (waitpid(pid, &status, WNOHANG) == pid) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(pid, SIGKILL);
  waitpid(pid, &status, 0);
  return -1;
}

FinishedProcess finish(const Child& child) {
  FinishedProcess result;
  drain(child, result);
  result.exitStatus = waitFor(child.pid);
  ::close(child.output);
  ::close(child.error);
  return result;
}

std::string serverProgram() { return test::buildFolder() + "/bin/terrane-server"; }

}  // namespace

FinishedProcess runProgram(const std::vector<std::string>& command) {
  const Child child = spawn(command);
  if (child.pid < 0) return {-1, {}, "cannot start " + command[0]};
  return finish(child);
}

FinishedProcess runServer(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), serverProgram());
  return runProgram(arguments);
}

ServerProcess::ServerProcess(const std::vector<std::string>& arguments, const std::string& shellPrefix) {
  std::vector<std::string> command{serverProgram()};
  if (!shellPrefix.empty()) command = {"/bin/sh", "-c", shellPrefix + "exec \"$0\" \"$@\"", serverProgram()};
  command.insert(command.end(), {"--listen", "127.0.0.1:0"});
  command.insert(command.end(), arguments.begin(), arguments.end());
  const Child child = spawn(command);
  pid_ = child.pid;
  output_ = child.output;
  error_ = child.error;
  pollfd ready{output_, POLLIN, 0};
  char c = 0;
  while (poll(&ready, 1, 30'000) == 1 && ::read(output_, &c, 1) == 1 && c != '\n') readyLine_ += c;
  if (const std::size_t at = readyLine_.find("http://"); at != std::string::npos)
    url_ = readyLine_.substr(at, readyLine_.find(' ', at) - at);
}

ServerProcess::~ServerProcess() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  wait();
}

void ServerProcess::signal(int number) const { kill(pid_, number); }

int ServerProcess::openFiles() const {
  std::error_code failure;
  const std::filesystem::directory_iterator files("/proc/" + std::to_string(pid_) + "/fd", failure);
  return failure ? 0 : static_cast<int>(std::distance(begin(files), end(files)));
}

bool ServerProcess::isRunning() const {
  siginfo_t ended{};
  return waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0;
}

FinishedProcess ServerProcess::wait() {
  const FinishedProcess result = finish({pid_, output_, error_});
  pid_ = -1;
  return result;
}

}  // namespace terrane::test
