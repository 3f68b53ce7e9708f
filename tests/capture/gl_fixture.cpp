#include "tests/capture/gl_fixture.h"

#include "client/gl/capabilities.h"
#include "tests/support/require.h"
#include "tests/support/shared_window.h"

namespace terrane {
void GlTest::SetUp() {
  const auto window = sharedWindow();
  ASSERT_TRUE(window) << window.error().text();
}

void GlTest::TearDown() { EXPECT_EQ(gl::takeErrors(), ""); }

Window& GlTest::window() { return **sharedWindow(); }

TileSource& GlTest::moon(Scheme scheme) {
  if (scheme == Scheme::Ico) {
    static TileSource triangles(moonScene(Scheme::Ico));
    return triangles;
  }
  static TileSource squares(moonScene(Scheme::Cube));
  return squares;
}

std::unique_ptr<TileRenderer> GlTest::makeRenderer(const std::vector<EffectCall>& effects,
                                                   const RendererOptions& options) {
  return require(TileRenderer::create(effects, options));
}

}  // namespace terrane
