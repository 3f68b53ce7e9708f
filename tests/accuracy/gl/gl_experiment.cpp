#include "tests/accuracy/gl/gl_experiment.h"

#include <fmt/format.h>

#include <mutex>

#include "client/gl/capabilities.h"
#include "common/memory/heap_policy.h"
#include "tests/support/shared_window.h"

namespace terrane::accuracy {

Report notRun(const Error& why) {
  Report report;
  report.findings = {"Not run: " + why.text() + "."};
  return report;
}

std::optional<Report> whyNotDrawn() {
  // Before the driver starts its threads.
  static std::once_flag held;
  std::call_once(held, [] { keepFreedMemory(kHeapKeptByViewer); });
  const auto window = sharedWindow();
  if (window) return std::nullopt;
  return notRun(window.error());
}

std::string picturesText(int widthPixels, int heightPixels) {
  return fmt::format("Pictures of {} x {} pixels, drawn by {}.", widthPixels, heightPixels,
                     gl::detectCapabilities().renderer);
}

}  // namespace terrane::accuracy
