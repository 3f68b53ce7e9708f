// Offscreen targets: depth that shaders can read, several samples a pixel, colour without depth. One triangle over the
// whole picture, or over a part of it, at a given distance.

#include "client/gl/render_target.h"
#include "client/gl/depth_copy.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "client/gl/image.h"
#include "client/gl/shader_program.h"
#include "tests/capture/gl_fixture.h"
#include "tests/support/require.h"
#include "tests/support/vertex_run.h"

namespace terrane {
namespace {

constexpr int kSide = 64;
constexpr float kNearMeters = 0.125f;

// w, the distance, differs from corner to corner.
constexpr const char* kTriangle = R"(
layout(location = 0) in vec3 corner;
uniform float nearMeters;
void main() {
#ifdef CLIP_CONTROL
  gl_Position = vec4(corner.xy * corner.z, nearMeters, corner.z);
#else
  gl_Position = vec4(corner.xy * corner.z, corner.z - 2.0 * nearMeters, corner.z);
#endif
})";

/// x and y in the picture, -1..1, and the distance in metres.
using Corners = std::array<std::array<float, 3>, 3>;
Corners wholePicture(float first, float second, float third) {
  return {{{-1, -1, first}, {3, -1, second}, {-1, 3, third}}};
}

class RenderTargetTest : public GlTest {
 protected:
  /// Draws over what is there, as the renderer's passes do. Greater depth, which is nearer, wins.
  static void draw(const Corners& corners, float red, const gl::Capabilities& capabilities) {
    const auto program =
        require(gl::Program::build({.vertexText = kTriangle, .fragmentFile = "coverage.frag.glsl"}, capabilities));
    gl::Buffer buffer;
    gl::VertexArray array;
    buffer.upload(gl::BufferTarget::Vertices, gl::bytesOf(corners), gl::BufferUse::Static);
    const std::array attributes{gl::VertexAttribute{.location = 0, .components = 3}};
    array.attach(buffer, sizeof corners[0], attributes);
    program.use();
    gl::setUniform(program.uniform("nearMeters"), kNearMeters);
    gl::setUniform(program.uniform("mark"), red);
    if (capabilities.clipControl) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    if (capabilities.clipControl) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  }
  static void clear() {
    glClearColor(0, 0, 0, 1);
    glClearDepth(0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glClearDepth(1);
  }
  /// Depth of every pixel, bottom row first, as a shader fetches it from a copy: one sample's.
  static std::vector<float> depthOf(const RenderTarget& target) {
    auto run = require(test::VertexRun::create({.vertexText = R"(
layout(location = 0) in ivec2 pixel;
uniform sampler2D depth;
out float fetched;
void main() { fetched = texelFetch(depth, pixel, 0).r; })",
                                                .varyings = {"fetched"},
                                                .floatsPerVertex = 1}));
    std::vector<std::array<std::int32_t, 2>> pixels;
    for (int row = 0; row < kSide; ++row)
      for (int column = 0; column < kSide; ++column) pixels.push_back({column, row});
    const std::array attributes{gl::VertexAttribute{
        .location = 0, .components = 2, .type = gl::Component::I32, .conversion = gl::Conversion::Integer}};
    run.setVertices(gl::bytesOf(pixels), sizeof pixels[0], attributes);
    gl::DepthCopy copy;
    target.bind();
    EXPECT_TRUE(copy.take(kSide, kSide));
    copy.bind();
    run.run();
    return run.results();
  }
  static std::size_t intermediate(const std::vector<std::uint8_t>& reds) {
    return static_cast<std::size_t>(std::ranges::count_if(reds, [](int red) { return red > 8 && red < 247; }));
  }
};

TEST_F(RenderTargetTest, AShaderReadsTheDepthThatWasDrawn) {
  for (const bool baseline : {false, true}) {
    for (const int samples : {1, 4}) {
      const gl::Capabilities capabilities = gl::detectCapabilities(baseline);
      const auto target = require(RenderTarget::create(kSide, kSide, TargetFormat::Rgba8, samples));
      target.bind();
      clear();
      EXPECT_EQ(depthOf(target), std::vector<float>(kSide * kSide, 0.0f)) << "infinitely far";
      target.bind();
      constexpr float kMeters = 7.25f;
      draw(wholePicture(kMeters, kMeters, kMeters), 1, capabilities);
      // The baseline multiplies by 1/w as the rasterizer interpolates it: two roundings and one of interpolation.
      for (const float depth : depthOf(target)) ASSERT_NEAR(depth, kNearMeters / kMeters, 4 * 0x1p-24 * depth);
      // A plane that leans away: near / w is linear in the picture. Through the first corner 1/8, to 1/64 at the right.
      target.bind();
      clear();
      draw(wholePicture(8, 64, 8), 1, capabilities);
      const std::vector<float> depths = depthOf(target);
      for (int column = 0; column < kSide; ++column) {
        // A sample lies anywhere in its pixel; one sample lies in its middle.
        const double slack = samples > 1 ? 0.5 : 1e-3;
        const auto expected = [&](double x) {
          return kNearMeters * (1 / 8.0 + (1 / 64.0 - 1 / 8.0) * x / (2 * kSide));
        };
        const auto depth = static_cast<double>(depths[static_cast<std::size_t>(kSide / 2 * kSide + column)]);
        ASSERT_LE(depth, expected(column + 0.5 - slack)) << column;
        ASSERT_GE(depth, expected(column + 0.5 + slack)) << column;
      }
    }
  }
}

TEST_F(RenderTargetTest, SeveralSamplesSmoothAnEdgeAndOneDoesNot) {
  const Corners slanted{{{-0.9f, -0.8f, 5}, {0.9f, -0.5f, 5}, {-0.3f, 0.9f, 5}}};
  const auto edge = [&](int samples, TargetFormat format) {
    const auto target = require(RenderTarget::create(kSide, kSide, format, samples));
    target.bind();
    clear();
    draw(slanted, 1, gl::detectCapabilities());
    const std::vector<std::uint8_t> reds = target.readRed();
    EXPECT_GT(std::ranges::count(reds, 255), 500) << "inside";
    target.bindForReading();
    const Image image = readFramebuffer(kSide, kSide);
    for (std::size_t column = 0; column < kSide; ++column)
      EXPECT_EQ(image.rgb[3 * column], reds[(kSide - 1) * kSide + column]) << "both ways of reading";
    return intermediate(reds);
  };
  ASSERT_GE(gl::detectCapabilities().maxSamples, 4) << "GL 3.3 asks for 4 of every driver";
  for (const TargetFormat format : {TargetFormat::Rgba8, TargetFormat::R8}) {
    EXPECT_EQ(edge(1, format), 0u);
    EXPECT_GT(edge(4, format), 40u) << "of some 150 pixels on the edges";
  }
}

TEST_F(RenderTargetTest, MoreSamplesThanTheDriverHasAreTheMostItHas) {
  const int most = gl::detectCapabilities().maxSamples;
  EXPECT_EQ(gl::detectCapabilities(true).maxSamples, most) << "the baseline has samples too";
  EXPECT_EQ(require(RenderTarget::create(kSide, kSide, TargetFormat::Rgba8, 1 << 20)).samples(), most);
  for (const int none : {-1, 0, 1})
    EXPECT_EQ(require(RenderTarget::create(kSide, kSide, TargetFormat::Rgba8, none)).samples(), 1);
}

}  // namespace
}  // namespace terrane
