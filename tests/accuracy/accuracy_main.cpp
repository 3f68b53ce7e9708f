// terrane-accuracy: what every digit of accuracy costs in time, measured.

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/command_line.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/report_text.h"

namespace terrane::accuracy {
namespace {

/// A bar on a terminal's last line; nothing where nobody watches.
class Bar final : public Progress {
 public:
  Bar(std::string_view name, std::size_t index, std::size_t count)
      : name_(name), index_(index), count_(count), watched_(::isatty(STDERR_FILENO) != 0) {}
  ~Bar() override {
    if (watched_) fmt::print(stderr, "\r\x1b[K");
  }
  void at(double share) override {
    if (!watched_) return;
    constexpr int kWidth = 30;
    const int done = static_cast<int>(share * kWidth);
    fmt::print(stderr, "\r[{}{}] {}/{} {}\x1b[K", std::string(static_cast<std::size_t>(done), '#'),
               std::string(static_cast<std::size_t>(kWidth - done), ' '), index_ + 1, count_, name_);
  }

 private:
  std::string_view name_;
  std::size_t index_, count_;
  bool watched_;
};

Result<void> write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) return makeError(ErrorKind::Io, "--out", "cannot write " + file.string());
  return {};
}

Result<std::vector<Experiment>> chosen(const std::vector<std::string>& only) {
  const auto all = experiments();
  if (only.empty()) return std::vector<Experiment>(all.begin(), all.end());
  std::vector<Experiment> found;
  for (const std::string& name : only) {
    const auto at = std::ranges::find(all, name, &Experiment::name);
    if (at == all.end()) {
      std::string names;
      for (const Experiment& one : all) names += (names.empty() ? "" : ", ") + std::string(one.name);
      return makeError(ErrorKind::InvalidArgument, "--only", quotedForMessage(name) + " is none of: " + names);
    }
    if (std::ranges::find(found, at->name, &Experiment::name) == found.end()) found.push_back(*at);
  }
  return found;
}

Result<void> run(const Settings& settings, const std::string& directory, const std::vector<std::string>& only) {
  const auto list = chosen(only);
  if (!list) return list.error();
  std::error_code failure;
  std::filesystem::create_directories(directory, failure);
  if (failure) return makeError(ErrorKind::Io, "--out", directory + ": " + failure.message());
  const std::filesystem::path out(directory), json = out / "accuracy.json", page = out / "index.html";
  // Before minutes of work, not after.
  for (const auto& file : {json, page})
    if (!std::ofstream(file, std::ios::app)) return makeError(ErrorKind::Io, "--out", "cannot write " + file.string());
  std::vector<Finished> finished;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Experiment& experiment = (*list)[i];
    Report report;
    {
      Bar bar(experiment.name, i, list->size());
      bar.at(0);
      try {
        report = experiment.run(settings, bar);
      } catch (const std::exception& thrown) {
        return makeError(ErrorKind::Internal, std::string(experiment.name), thrown.what());
      }
    }
    finished.push_back({experiment, std::move(report)});
    fmt::print("{}", textOf(finished.back()));
    std::fflush(stdout);
  }
  if (auto written = write(json, jsonOf(settings, finished)); !written) return written;
  if (auto written = write(page, htmlOf(settings, finished)); !written) return written;
  fmt::print("\n{} and {}\n", page.string(), json.string());
  return {};
}

}  // namespace

int runAccuracy(int argc, char** argv) {
  CLI::App app{"Measures what accuracy costs in time: tables, accuracy.json, and a page with plots.",
               "terrane-accuracy"};
  Settings settings;
  std::string directory = "accuracy";
  std::vector<std::string> only;
  app.add_flag("--quick", settings.quick, "Fewer samples: under half a minute in all");
  app.add_option("--out", directory, "Folder for accuracy.json and index.html")->capture_default_str();
  app.add_option("--only", only, "Run these experiments only (may be repeated)")->allow_extra_args(false);
  app.footer(kExitStatusHelp);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "terrane-accuracy: {}\n", error.what());
    return kExitWrongUsage;
  }
  const auto done = run(settings, directory, only);
  if (done) return kExitDone;
  fmt::print(stderr, "terrane-accuracy: {}\n", done.error().text());
  return exitStatus(done.error());
}

}  // namespace terrane::accuracy

int main(int argc, char** argv) { return terrane::accuracy::runAccuracy(argc, argv); }
