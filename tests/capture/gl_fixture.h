#pragma once
// What the tests of drawing share: one headless window a process, and real tiles of the scenes that ship.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "client/gl/window.h"
#include "client/render/tile_renderer.h"
#include "tests/support/both_schemes.h"
#include "tests/support/tile_source.h"

namespace terrane {

/// Every test has the window and checks after each that GL raised no error.
class GlTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  static Window& window();
  /// The tiles of the scene moon, or of moon-ico.
  static TileSource& moon(Scheme scheme = Scheme::Cube);
  static std::unique_ptr<TileRenderer> makeRenderer(const std::vector<EffectCall>& effects = {},
                                                    const RendererOptions& options = {});
};

/// A test of both schemes: INSTANTIATE_TEST_SUITE_P(Schemes, Suite, test::bothSchemes(), test::nameOfScheme).
class GlTestOfSchemes : public GlTest, public testing::WithParamInterface<Scheme> {
 protected:
  static TileSource& tiles() { return moon(GetParam()); }
};

constexpr double kDegree = 3.14159265358979323846 / 180;

}  // namespace terrane
