#include "tests/support/shared_window.h"

#include <memory>

namespace terrane {

Result<Window*> sharedWindow() {
  static const Result<std::unique_ptr<Window>> window =
      Window::open({.widthPixels = 320, .heightPixels = 240, .title = "Terrane tests", .headless = true});
  if (!window) return window.error();
  return window->get();
}

}  // namespace terrane
