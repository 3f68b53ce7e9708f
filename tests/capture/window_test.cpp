// A window without a display of the user's, the virtual display under it, and offscreen targets.

#include "client/gl/window.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "client/gl/virtual_display.h"
#include "tests/capture/gl_fixture.h"

namespace terrane {
namespace {

class WindowTest : public GlTest {};

TEST_F(WindowTest, OpensWithoutADisplayOfTheUsers) {
  EXPECT_NE(window().handle(), nullptr);
  EXPECT_FALSE(window().shouldClose());
}

TEST_F(WindowTest, ARenderTargetLargerThanAnyFramebufferIsRefused) {
  const auto target = RenderTarget::create(1 << 20, 16);
  ASSERT_FALSE(target);
  EXPECT_EQ(target.error().kind, ErrorKind::TooLarge);
  EXPECT_FALSE(RenderTarget::create(0, 16));
}

TEST_F(WindowTest, AFramebufferIsReadTopRowFirst) {
  // The Moon seen from over its north pole with the camera tilted up: ground at the bottom of the picture, sky at its
  // top.
  auto target = RenderTarget::create(64, 64);
  ASSERT_TRUE(target);
  auto renderer = TileRenderer::create({});
  ASSERT_TRUE(renderer);
  TileSource smooth("smooth");
  const Camera camera = cameraFromPose({0, 90 * kDegree, 1e5, 0, -18 * kDegree}, 1737400, 0.5, 64, 64);
  const auto paths = smooth.settledTiles(camera, 2);
  for (const FacePath& path : paths) (*renderer)->upload(smooth.tile(path));
  target->bind();
  (*renderer)->draw(camera, paths, {});
  const Image image = readFramebuffer(64, 64);
  EXPECT_EQ(image.rgb[32 * 3], 0) << "sky";
  EXPECT_GT(image.rgb[(63 * 64 + 32) * 3], 0) << "ground";
}

/// Where the server of a display listens.
std::filesystem::path socketOf(const std::string& display) { return "/tmp/.X11-unix/X" + display.substr(1); }

TEST(VirtualDisplay, EndsWithItsOwner) {
  std::filesystem::path socket;
  {
    const auto display = VirtualDisplay::start(320, 200);
    ASSERT_TRUE(display) << display.error().text();
    ASSERT_EQ(display->name().front(), ':');
    socket = socketOf(display->name());
    EXPECT_TRUE(std::filesystem::exists(socket));
  }
  EXPECT_FALSE(std::filesystem::exists(socket));
}

TEST(VirtualDisplay, EndsWithAProcessThatIsKilled) {
  int names[2];
  ASSERT_EQ(pipe(names), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto display = VirtualDisplay::start(64, 64);
    const std::string name = display ? display->name() : std::string("none");
    [[maybe_unused]] const ssize_t written = write(names[1], name.c_str(), name.size() + 1);
    for (;;) pause();
  }
  char name[32] = {};
  ASSERT_GT(read(names[0], name, sizeof name), 0);
  ASSERT_EQ(name[0], ':') << "the child got no display";
  ASSERT_TRUE(std::filesystem::exists(socketOf(name)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  bool gone = false;
  for (int i = 0; i < 1000 && !gone; ++i) {
    usleep(10'000);
    gone = !std::filesystem::exists(socketOf(name));
  }
  EXPECT_TRUE(gone) << "the server outlived the process it was started for";
  close(names[0]);
  close(names[1]);
}

TEST(VirtualDisplay, SaysWhatIsMissing) {
  const char* before = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe)
  const std::string path = before != nullptr ? before : "";
  setenv("PATH", "/nowhere", 1);  // NOLINT(concurrency-mt-unsafe)
  const auto display = VirtualDisplay::start(64, 64);
  setenv("PATH", path.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  ASSERT_FALSE(display);
  EXPECT_EQ(display.error().kind, ErrorKind::Io);
  EXPECT_EQ(display.error().text(), "display: no DISPLAY and Xvfb is not installed");
}

}  // namespace
}  // namespace terrane
