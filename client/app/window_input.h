#pragma once
// What a person does to the window, gathered between two frames from GLFW's callbacks: hands for CameraControls, and
// commands. GL thread only; one a window (it takes the window's user pointer).

#include <glm/vec2.hpp>
#include <vector>

#include "client/controls/camera_controls.h"

struct GLFWwindow;

namespace terrane {

enum class ViewCommand {
  ToggleHud,
  ToggleWireframe,
  ToggleLevelColors,
  ToggleFreeze,
  MoreDetail,
  LessDetail,
  Screenshot,
  ToggleMode,
  Home,
  NextPlacement,
  NextTransition,
  Quit,
};

class WindowInput {
 public:
  explicit WindowInput(GLFWwindow* window);
  ~WindowInput();
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  /// Motion since the last call, in framebuffer pixels; keys and buttons as they are now.
  ControlInput take(double seconds);
  std::vector<ViewCommand> takeCommands();
  /// True once after the window was resized, uncovered or restored: its picture must be drawn again.
  bool takeDamage();
  /// A key or button is held that moves the camera.
  bool held() const;

 private:
  struct Callbacks;
  GLFWwindow* window_;
  glm::dvec2 cursor_{0.0}, lastCursor_{0.0};
  double wheel_ = 0;
  bool damaged_ = true;
  std::vector<ViewCommand> commands_;
};

}  // namespace terrane
