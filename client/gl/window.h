#pragma once
// A GLFW window with a GL core context (4.5 where there is one, at least 3.3), visible or headless. One a process; GL
// thread only. Headless needs nothing of the user: where there is no display, a virtual one (Xvfb) is started as a
// child and ended with the window.

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/result.h"

struct GLFWwindow;

namespace terrane {

struct WindowOptions {
  int widthPixels = 1280, heightPixels = 720;
  std::string title = "Terrane";
  bool headless = false;
};

class Window {
 public:
  /// Errors: Io ("display"), Unsupported ("OpenGL": what was found).
  static Result<std::unique_ptr<Window>> open(const WindowOptions& options);
  ~Window();

  GLFWwindow* handle() const noexcept;
  std::array<int, 2> framebufferSize() const;
  bool shouldClose() const;
  void swap();
  void poll();
  /// Sleeps until an event, wake(), or the time is over.
  void wait(double seconds);
  /// From any thread.
  static void wake();

 private:
  struct State;
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace terrane
