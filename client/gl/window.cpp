#include "client/gl/window.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <cstdlib>
#include <optional>

#include "client/gl/virtual_display.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace terrane {
namespace {

std::string lastGlfwError() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

bool hasEnvironment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): the window opens before any thread starts
  return value != nullptr && *value != '\0';
}

#ifndef NDEBUG
void onDebugMessage(GLenum, GLenum, GLuint, GLenum severity, GLsizei length, const GLchar* text, const void*) {
  if (severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
  fmt::print(stderr, "OpenGL: {}\n", std::string_view(text, static_cast<std::size_t>(length)));
}
#endif

GLFWwindow* createWindow(const WindowOptions& options, int major, int minor) {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_VISIBLE, options.headless ? GLFW_FALSE : GLFW_TRUE);
  // Terrain is drawn offscreen with its own depth buffer: the window needs colour only.
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
#ifndef NDEBUG
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
#endif
  return glfwCreateWindow(options.widthPixels, options.heightPixels, options.title.c_str(), nullptr, nullptr);
}

}  // namespace

struct Window::State {
  std::optional<VirtualDisplay> display;  // outlives the window: destroyed last
  bool initialized = false;
  GLFWwindow* handle = nullptr;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (handle != nullptr) glfwDestroyWindow(handle);
    if (initialized) glfwTerminate();
    // What was set for this process only must not lead a later window to a display that is gone.
    if (display) unsetenv("DISPLAY");  // NOLINT(concurrency-mt-unsafe)
  }

  Result<bool> startVirtualDisplay(const WindowOptions& options) {
    auto started = VirtualDisplay::start(options.widthPixels, options.heightPixels);
    if (!started) return started.error();
    display.emplace(std::move(*started));
    setenv("DISPLAY", display->name().c_str(), 1);  // NOLINT(concurrency-mt-unsafe): before any thread starts
    return true;
  }
};

Result<std::unique_ptr<Window>> Window::open(const WindowOptions& options) {
  auto state = std::make_unique<State>();
  if (!hasEnvironment("DISPLAY") && !hasEnvironment("WAYLAND_DISPLAY")) {
    if (!options.headless) {
      return makeError(ErrorKind::Io, "display", "no DISPLAY to open a window on (--headless draws without one)");
    }
    if (auto started = state->startVirtualDisplay(options); !started) return started.error();
  }
  bool initialized = glfwInit() == GLFW_TRUE;
  if (!initialized && options.headless && !state->display) {  // a DISPLAY that nobody serves
    if (auto started = state->startVirtualDisplay(options); !started) return started.error();
    initialized = glfwInit() == GLFW_TRUE;
  }
  if (!initialized) return makeError(ErrorKind::Io, "display", lastGlfwError());
  state->initialized = true;

  state->handle = createWindow(options, 4, 5);
  if (state->handle == nullptr) state->handle = createWindow(options, 3, 3);
  if (state->handle == nullptr) {
    return makeError(ErrorKind::Unsupported, "OpenGL", "no core context of 3.3 or later: " + lastGlfwError());
  }
  glfwMakeContextCurrent(state->handle);
  if (!options.headless) glfwSwapInterval(1);
#ifndef NDEBUG
  if (epoxy_gl_version() >= 43 || epoxy_has_gl_extension("GL_KHR_debug")) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(onDebugMessage, nullptr);
  }
#endif
  return std::unique_ptr<Window>(new Window(std::move(state)));
}

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::~Window() = default;

GLFWwindow* Window::handle() const noexcept { return state_->handle; }

std::array<int, 2> Window::framebufferSize() const {
  std::array<int, 2> size{};
  glfwGetFramebufferSize(state_->handle, &size[0], &size[1]);
  return size;
}

bool Window::shouldClose() const { return glfwWindowShouldClose(state_->handle) == GLFW_TRUE; }
void Window::swap() { glfwSwapBuffers(state_->handle); }
void Window::poll() { glfwPollEvents(); }
void Window::wait(double seconds) {
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
}
void Window::wake() { glfwPostEmptyEvent(); }

}  // namespace terrane
