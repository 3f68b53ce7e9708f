#pragma once
// What the tests of drawing share: one headless window a process, and real tiles of the scenes that ship.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "client/gl/window.h"
#include "client/render/tile_renderer.h"
#include "tests/support/tile_source.h"

namespace terrane {

/// Every test has the window and checks after each that GL raised no error.
class GlTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  static Window& window();
  static TileSource& moon();
  static std::unique_ptr<TileRenderer> makeRenderer(const std::vector<EffectCall>& effects = {},
                                                    const RendererOptions& options = {});
};

constexpr double kDegree = 3.14159265358979323846 / 180;

}  // namespace terrane
