#include "client/app/window_input.h"

#include <optional>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace terrane {
namespace {

std::optional<ViewCommand> commandOf(int key) {
  switch (key) {
    case GLFW_KEY_F1:
      return ViewCommand::ToggleHud;
    case GLFW_KEY_F2:
      return ViewCommand::ToggleWireframe;
    case GLFW_KEY_F3:
      return ViewCommand::ToggleLevelColors;
    case GLFW_KEY_F4:
      return ViewCommand::ToggleFreeze;
    case GLFW_KEY_F5:
      return ViewCommand::NextTransition;
    case GLFW_KEY_F12:
      return ViewCommand::Screenshot;
    case GLFW_KEY_TAB:
      return ViewCommand::ToggleMode;
    case GLFW_KEY_HOME:
      return ViewCommand::Home;
    case GLFW_KEY_P:
      return ViewCommand::NextPlacement;
    case GLFW_KEY_ESCAPE:
      return ViewCommand::Quit;
    // The same physical key writes + or = on most layouts.
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      return ViewCommand::LessDetail;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      return ViewCommand::MoreDetail;
    default:
      return std::nullopt;
  }
}

}  // namespace

struct WindowInput::Callbacks {
  static WindowInput& of(GLFWwindow* window) { return *static_cast<WindowInput*>(glfwGetWindowUserPointer(window)); }
  static void key(GLFWwindow* window, int key, int, int action, int) {
    const auto command = commandOf(key);
    if (command && action == GLFW_PRESS) of(window).commands_.push_back(*command);
  }
  static void cursor(GLFWwindow* window, double x, double y) { of(window).cursor_ = {x, y}; }
  static void scroll(GLFWwindow* window, double, double y) { of(window).wheel_ += y; }
  static void resize(GLFWwindow* window, int, int) { of(window).damaged_ = true; }
  static void refresh(GLFWwindow* window) { of(window).damaged_ = true; }
};

WindowInput::WindowInput(GLFWwindow* window) : window_(window) {
  glfwGetCursorPos(window, &cursor_.x, &cursor_.y);
  lastCursor_ = cursor_;
  glfwSetWindowUserPointer(window, this);
  glfwSetKeyCallback(window, &Callbacks::key);
  glfwSetCursorPosCallback(window, &Callbacks::cursor);
  glfwSetScrollCallback(window, &Callbacks::scroll);
  glfwSetFramebufferSizeCallback(window, &Callbacks::resize);
  glfwSetWindowRefreshCallback(window, &Callbacks::refresh);
}

WindowInput::~WindowInput() {
  glfwSetKeyCallback(window_, nullptr);
  glfwSetCursorPosCallback(window_, nullptr);
  glfwSetScrollCallback(window_, nullptr);
  glfwSetFramebufferSizeCallback(window_, nullptr);
  glfwSetWindowRefreshCallback(window_, nullptr);
  glfwSetWindowUserPointer(window_, nullptr);
}

ControlInput WindowInput::take(double seconds) {
  int windowWidth = 0, windowHeight = 0, width = 0, height = 0;
  glfwGetWindowSize(window_, &windowWidth, &windowHeight);
  glfwGetFramebufferSize(window_, &width, &height);
  const double scale = windowWidth > 0 ? static_cast<double>(width) / windowWidth : 1;
  const auto down = [&](int key) { return glfwGetKey(window_, key) == GLFW_PRESS; };
  const auto axis = [&](int positive, int negative) {
    return (down(positive) ? 1.0 : 0.0) - (down(negative) ? 1.0 : 0.0);
  };
  ControlInput input;
  input.seconds = seconds;
  input.cursorPixels = cursor_ * scale;
  input.cursorMovePixels = (cursor_ - std::exchange(lastCursor_, cursor_)) * scale;
  input.primaryButton = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
  input.secondaryButton = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
  input.wheelSteps = std::exchange(wheel_, 0.0);
  input.move = {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q), axis(GLFW_KEY_W, GLFW_KEY_S)};
  if (down(GLFW_KEY_LEFT_SHIFT) || down(GLFW_KEY_RIGHT_SHIFT)) input.speedFactor = 4;
  if (down(GLFW_KEY_LEFT_CONTROL) || down(GLFW_KEY_RIGHT_CONTROL)) input.speedFactor = 0.25;
  return input;
}

std::vector<ViewCommand> WindowInput::takeCommands() { return std::exchange(commands_, {}); }
bool WindowInput::takeDamage() { return std::exchange(damaged_, false); }

bool WindowInput::held() const {
  for (const int key : {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E})
    if (glfwGetKey(window_, key) == GLFW_PRESS) return true;
  return false;
}

}  // namespace terrane
