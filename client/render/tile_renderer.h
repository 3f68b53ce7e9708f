#pragma once
// Draws terrain tiles with one of four placements, and counts the pixels that a watertight surface must cover. GL
// thread only; needs a current GL context of 3.3 core or better.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/render/body_picture.h"
#include "client/render/placement.h"
#include "client/render/transition.h"
#include "common/result.h"
#include "common/scene/effects.h"
#include "common/view/camera.h"
#include "common/view/drawn_tile.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// What the start-up check of this GPU's arithmetic found (client/render/gpu_self_test.h).
struct SelfTestReport {
  bool integerExact = false;          ///< integer add and convert in the vertex shader
  bool twoSumExact = false;           ///< with precise
  bool twoProdExact = false;          ///< Dekker's split, with precise
  bool twoSumWithoutPrecise = false;  ///< for the record: false on drivers that simplify it away
  bool fmaFused = false;
  std::string renderer, version;  ///< GL strings
  Placement chosen = Placement::Integer;
};

struct DrawSettings {
  Placement placement = Placement::Integer;
  bool wireframe = false;
  bool levelColors = false;
  /// Draw every tile's skirts. Not needed where edges towards coarser tiles are morphed and stitched to them; a tile
  /// that cannot be (DrawnTile) is drawn with its skirts anyway.
  bool skirts = false;
  /// Draw what effects draw by themselves over the tiles (detail, dust), where the scene names them.
  bool effectPasses = true;
  /// A pixel, for smooth edges, where draw makes the target: with the window's own framebuffer bound.
  int samples = 1;
  /// Blend and None draw every tile's own surface with its skirts; Blend then mixes in the parents' surfaces.
  Transition transition = Transition::Morph;
};

struct RendererOptions {
  /// Use nothing beyond GL 3.3 core whatever the context has: so that this path is tested on any driver.
  bool forceBaseline = false;
  /// Of the body whose tiles are drawn. Without it nothing is put on the ground: its sizes would not be known.
  double bodyRadiusMeters = 0;
  Scheme bodyScheme = Scheme::Cube;
};

struct DrawStats {
  std::size_t tiles = 0, triangles = 0, drawCalls = 0;
  int samples = 1;  ///< a pixel, of the target that was drawn into: at most what the driver has
};

struct CoverageCount {
  std::uint64_t uncovered = 0;  ///< background pixels whose ray meets a body's lowest sphere
  std::uint64_t skirt = 0;      ///< pixels that show a skirt
};

class TileRenderer {
 public:
  /// effects: those the scene names; only they get a shader variant or a uniform. Errors: Unsupported, Io (shader log).
  static Result<std::unique_ptr<TileRenderer>> create(const std::vector<EffectCall>& effects,
                                                      const RendererOptions& options = {});
  ~TileRenderer();

  const SelfTestReport& selfTest() const noexcept;
  /// What draw really uses when asked for a placement: what this GPU does not compute exactly falls back to Cpu.
  Placement usable(Placement requested) const noexcept;
  /// DrawSettings::samples where nobody asks for any: 4 on a GPU, 1 where software draws, which pays for each.
  int samplesByDefault() const noexcept;

  /// Uploads; returns the bytes taken on the GPU (shared index buffers are counted once a body). body: any number that
  /// tells bodies apart.
  std::size_t upload(const std::shared_ptr<const Tile>& tile, std::size_t body = 0);
  void remove(const FacePath& path, std::size_t body = 0);
  void clear();

  /// Draws into the current framebuffer (colour and depth cleared here). Tiles that were never uploaded are skipped;
  /// one that morphs needs its parent uploaded, or it is drawn as it is. The window's own framebuffer lacks the depth
  /// precision: with that bound, draws into a RenderTarget of the camera's size and copies it over (the camera then has
  /// the window's size).
  DrawStats draw(const Camera& camera, std::span<const DrawnTile> tiles, const DrawSettings& settings);
  /// Several bodies in one picture: one sky, one depth, so that the nearer hides the farther wherever they meet, and
  /// each lit and put on its ground what effects put there. Cameras are one, each in its body's frame; at least one.
  DrawStats draw(std::span<const BodyPicture> bodies, const DrawSettings& settings);
  /// The tiles as they are.
  DrawStats draw(const Camera& camera, std::span<const FacePath> tiles, const DrawSettings& settings);

  /// A pass of tiles only into an own target, read back: no sky, no multisampling, no effects.
  CoverageCount countCoverage(std::span<const BodyPicture> bodies, const DrawSettings& settings);
  CoverageCount countCoverage(const Camera& camera, std::span<const DrawnTile> tiles, const DrawSettings& settings,
                              double lowestRadiusMeters);
  CoverageCount countCoverage(const Camera& camera, std::span<const FacePath> tiles, const DrawSettings& settings,
                              double lowestRadiusMeters);

  /// Clip-space positions (x, y, z, w) of a tile's vertices as the vertex shader computes them, by transform feedback,
  /// a complete grid's in grid order; for the tests of placement against a reference of higher precision.
  std::vector<float> clipPositions(const Camera& camera, const DrawnTile& tile, Placement placement);
  /// In the same way what the shaded vertex shader hands on to be interpolated: colour (r, g, b) and signed light.
  /// Needs the effect sun.
  std::vector<float> colorsAndLight(const Camera& camera, const DrawnTile& tile, Placement placement);

  std::size_t gpuBytes() const noexcept;

 private:
  struct State;
  explicit TileRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace terrane
