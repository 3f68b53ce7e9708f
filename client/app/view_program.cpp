#include "client/app/view_program.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "client/app/flight_plan.h"
#include "client/app/interactive_run.h"
#include "client/app/scripted_run.h"
#include "client/app/view_options.h"
#include "client/gl/window.h"
#include "common/command_line.h"
#include "common/memory/heap_policy.h"

namespace terrane {
namespace {

std::string environmentVariable(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): read before any thread starts
  return value == nullptr ? std::string{} : value;
}

int fail(const Error& error, int status) {
  complain("terrane-view", error.text());
  return status;
}

int view(const ViewOptions& options, std::chrono::steady_clock::time_point start) {
  WindowOptions windowOptions;
  windowOptions.widthPixels = options.widthPixels;
  windowOptions.heightPixels = options.heightPixels;
  windowOptions.headless = options.headless || options.explain;
  auto window = Window::open(windowOptions);
  if (!window) return fail(window.error(), kExitFailed);
  return options.scripted() ? runScripted(options, **window, start) : runInteractive(options, **window, start);
}

}  // namespace

int runViewProgram(int argc, char** argv) {
  const auto start = std::chrono::steady_clock::now();
  try {
    const auto parsed = parseViewOptions({argv + 1, argv + argc}, &environmentVariable);
    if (!parsed) return fail(parsed.error(), kExitWrongUsage);
    if (const auto* text = std::get_if<OptionsText>(&*parsed)) {
      fmt::print("{}", text->text);
      return kExitDone;
    }
    auto options = std::get<ViewOptions>(*parsed);
    if (const auto flight = readFlight(options); !flight) return fail(flight.error(), exitStatus(flight.error()));
    keepFreedMemory(kHeapKeptByViewer);
    return view(options, start);
  } catch (const std::exception& error) {  // the last edge: out of memory, or a bug
    return fail(makeError(ErrorKind::Internal, "", error.what()), kExitFailed);
  }
}

}  // namespace terrane
