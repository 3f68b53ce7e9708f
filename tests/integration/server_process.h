#pragma once
// The real terrane-server as a child process of a test.

#include <sys/types.h>

#include <string>
#include <vector>

namespace terrane::test {

struct FinishedProcess {
  int exitStatus = -1;  ///< 128 + signal if one ended it
  std::string standardOutput, standardError;
};

/// Runs a program to its end, at most a minute. The program is found on PATH unless it has a slash.
FinishedProcess runProgram(const std::vector<std::string>& command);
/// terrane-server with these arguments.
FinishedProcess runServer(std::vector<std::string> arguments);

/// A server that was started and is ready.
class ServerProcess {
 public:
  /// "--listen 127.0.0.1:0" is added. shellPrefix: what a shell does before it becomes the server ("ulimit -n 24; ").
  explicit ServerProcess(const std::vector<std::string>& arguments, const std::string& shellPrefix = {});
  /// Ends it if it still runs.
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  const std::string& readyLine() const { return readyLine_; }
  const std::string& url() const { return url_; }  ///< the first listener's
  void signal(int number) const;
  /// File descriptors that it has open.
  int openFiles() const;
  bool isRunning() const;  ///< false too once it ended and was not waited for
  /// Waits for its end, at most a minute.
  FinishedProcess wait();

 private:
  pid_t pid_ = -1;
  int output_ = -1, error_ = -1;
  std::string readyLine_, url_;
};

}  // namespace terrane::test
