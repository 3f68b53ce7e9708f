// The state that tiles are drawn in leaves no pixel open inside a triangle, however thin that triangle has become.

#include "client/render/tile_pass.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <optional>
#include <random>

#include "client/gl/render_target.h"
#include "client/gl/shader_program.h"
#include "client/render/guard_band.h"
#include "tests/capture/gl_fixture.h"
#include "tests/support/require.h"

namespace terrane {
namespace {

constexpr int kSide = 16, kPixel = 8;  // of the picture; the column and row looked at
constexpr float kNearMeters = 0.1f, kDistanceMeters = 6;
constexpr int kSlivers = 4000;
constexpr unsigned kSeed = 7;

using Corner = std::array<float, 3>;  // 1/256 pixel from the pixel's centre; metres

// What snapping to 1/256 of a pixel made of a triangle of ground that was seen nearly along its plane: five pixels
// long, its height a twentieth of 1/256. The pixel's centre lies in it.
constexpr std::array<Corner, 3> kSliver{{{250, -43}, {-1093, 188}, {-1227, 211}}};
// One that leaves the picture to the left.
constexpr std::array<Corner, 3> kAcrossTheEdge{{{-4000, -600}, {-1600, -500}, {-1600, -400}}};

constexpr const char* kTriangle = R"(
layout(location = 0) in vec3 corner;
uniform float nearMeters, viewportScale;
void main() { gl_Position = vec4(corner.xy * (corner.z / viewportScale), nearMeters, corner.z); })";

enum class Drawn : std::uint8_t { AsTiles, DepthMustBeGreater, ClippedAtTheEdge };

class TilePassTest : public GlTest {
 protected:
  using Triangles = std::array<Corner, 6>;

  /// A sliver that snaps to those points, and the other triangle, so that they are clipped as one batch.
  static Triangles triangles(std::mt19937& random) {
    std::uniform_real_distribution<float> within(-0.49f, 0.49f);
    Triangles corners{};
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const Corner& at = c < 3 ? kSliver[c] : kAcrossTheEdge[c - 3];
      for (std::size_t axis = 0; axis < 2; ++axis)
        corners[c][axis] = ((at[axis] + within(random)) / 256 + kPixel + 0.5f) * (2.0f / kSide) - 1;
      corners[c][2] = kDistanceMeters + 0.1f * within(random);
    }
    return corners;
  }

  /// How many slivers leave the pixel open.
  static int openPixels(Drawn drawn) {
    const gl::Capabilities capabilities = gl::detectCapabilities();
    const auto program =
        require(gl::Program::build({.vertexText = kTriangle, .fragmentFile = "coverage.frag.glsl"}, capabilities));
    const RenderTarget target = require(RenderTarget::create(kSide, kSide, TargetFormat::R8));
    gl::Buffer buffer;
    gl::VertexArray array;
    Camera camera;
    camera.widthPixels = camera.heightPixels = kSide;
    std::mt19937 random(kSeed);
    int open = 0;
    for (int i = 0; i < kSlivers; ++i) {
      const Triangles corners = triangles(random);
      target.bind();
      const TilePass pass(capabilities, false);
      if (drawn == Drawn::DepthMustBeGreater) glDepthFunc(GL_GREATER);
      std::optional<GuardBand> band;
      if (drawn != Drawn::ClippedAtTheEdge) band.emplace(capabilities, camera);
      program.use();
      gl::setUniform(program.uniform("nearMeters"), kNearMeters);
      gl::setUniform(program.uniform("viewportScale"), band ? static_cast<float>(band->scale()) : 1.0f);
      gl::setUniform(program.uniform("mark"), 1.0f);
      buffer.upload(gl::BufferTarget::Vertices, gl::bytesOf(corners), gl::BufferUse::Static);
      const std::array attributes{gl::VertexAttribute{.location = 0, .components = 3}};
      array.attach(buffer, sizeof corners[0], attributes);
      array.bind();
      glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
      open += target.readRed()[std::size_t{kPixel} * kSide + kPixel] == 0 ? 1 : 0;
    }
    return open;
  }
};

TEST_F(TilePassTest, ATriangleThinnerThanItsSnappingLeavesNoPixelOpen) {
  if (!gl::detectCapabilities().clipControl) GTEST_SKIP() << "depth is written per pixel";
  EXPECT_EQ(openPixels(Drawn::AsTiles), 0);
  // The controls: what a driver does there is its own affair, so this is said, not asserted.
  std::printf(
      "seed %u, %d slivers: %d leave a pixel open where depth must be greater than the sky's, %d where they are "
      "clipped with others\n",
      kSeed, kSlivers, openPixels(Drawn::DepthMustBeGreater), openPixels(Drawn::ClippedAtTheEdge));
}

}  // namespace
}  // namespace terrane
