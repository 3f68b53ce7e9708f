#pragma once
// terrane-server and terrane-view as their users run them, for tests.

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/folders.h"

namespace terrane::testing_support {

inline std::string programFile(const std::string& name) { return test::buildFolder() + "/bin/" + name; }

/// A server on a port of the system's choosing. url is empty if it did not come up.
struct RunningServer {
  explicit RunningServer(const std::string& scene, const std::vector<std::string>& more = {}) {
    std::vector<std::string> command{
        programFile("terrane-server"), "--scene", scene, "--listen", "127.0.0.1:0", "--threads", "2"};
    command.insert(command.end(), more.begin(), more.end());
    process = std::make_unique<ChildProcess>(command);
    const std::string line = process->waitForLine("http://", std::chrono::seconds(30));
    std::smatch match;
    if (std::regex_search(line, match, std::regex("http://[0-9.]+:[0-9]+"))) url = match.str();
  }
  std::unique_ptr<ChildProcess> process;
  std::string url;
};

struct ViewOutcome {
  int status = -1;  ///< -1: it did not end in time
  std::string output, errors;
};

inline ViewOutcome runView(const std::vector<std::string>& arguments,
                           std::chrono::seconds limit = std::chrono::seconds(240)) {
  std::vector<std::string> command{programFile("terrane-view")};
  command.insert(command.end(), arguments.begin(), arguments.end());
  ChildProcess process(command);
  const auto status = process.wait(limit);
  if (!status) process.kill();
  return {status.value_or(-1), process.output(), process.errors()};
}

/// The number after "key": in a flat part of a JSON text; fails the test if there is none.
inline double jsonNumber(const std::string& json, const std::string& key) {
  std::smatch match;
  if (!std::regex_search(json, match, std::regex("\"" + key + "\": (-?[0-9][0-9.eE+-]*)"))) {
    ADD_FAILURE() << "no number \"" << key << "\" in " << json;
    return -1;
  }
  return std::strtod(match[1].str().c_str(), nullptr);
}

inline std::size_t lineCount(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace terrane::testing_support
