#include "client/render/tile_renderer.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <unordered_map>

#include "client/gl/render_target.h"
#include "client/render/coverage.h"
#include "client/render/effect_pass.h"
#include "client/render/gpu_self_test.h"
#include "client/render/gpu_tiles.h"
#include "client/render/guard_band.h"
#include "client/render/level_blend.h"
#include "client/render/tile_pass.h"
#include "client/render/tile_program.h"

namespace terrane {
namespace {

/// Software GL sorts a frame's triangles into bins before it draws any of them. Told to begin after so many tiles, it
/// draws some while it sorts the next, and needs some tens of megabytes less. (A GPU is not told: one that draws by
/// screen tiles would pay for it.)
constexpr int kTilesPerFlush = 8;
constexpr int kSamplesOnGpu = 4;

/// Of the array that is bound. Returns the number of triangles.
std::size_t drawList(const IndexList& list) {
  if (list.count == 0) return 0;
  list.buffer.bind(gl::BufferTarget::Indices);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(list.count), list.wide ? GL_UNSIGNED_INT : GL_UNSIGNED_SHORT,
                 nullptr);
  return list.count / 3;
}

/// Makes the target anew where it is not as it must be. False if the driver refuses.
bool provide(std::optional<RenderTarget>& target, const Camera& camera, TargetFormat format, int samples) {
  if (target && target->isLike(camera.widthPixels, camera.heightPixels, samples)) return true;
  target.reset();
  auto created = RenderTarget::create(camera.widthPixels, camera.heightPixels, format, samples);
  if (!created) return false;
  target.emplace(std::move(*created));
  return true;
}

/// What the pass that fills the depth buffer draws.
struct Surfaces {
  std::vector<DrawnTile> tiles;
  bool skirts = false;
};

Surfaces surfacesOf(std::span<const DrawnTile> tiles, const DrawSettings& settings) {
  Surfaces surfaces{{tiles.begin(), tiles.end()}, settings.skirts || settings.transition != Transition::Morph};
  if (settings.transition != Transition::Morph)
    for (DrawnTile& tile : surfaces.tiles) tile.morph = {};
  return surfaces;
}

}  // namespace

struct TileRenderer::State {
  gl::Capabilities capabilities;
  SelfTestReport selfTest;
  EffectList effects;
  std::vector<std::unique_ptr<EffectPass>> passes;
  std::map<std::size_t, GpuTiles> tiles;  ///< by body
  double onlyRadiusMeters = 0;            ///< RendererOptions'
  Scheme onlyScheme = Scheme::Cube;
  std::array<std::optional<TileProgram>, std::size_t{2} * kTilePurposeCount * kPlacementCount> programs;
  std::optional<RenderTarget> windowTarget, coverageTarget;
  std::optional<LevelBlend> levelBlend;  ///< once asked for
  std::vector<float> scratch;

  /// Compiled when first asked for. Errors: Unsupported ("shader").
  Result<TileProgram*> program(const TileVariant& variant) {
    const auto placement = static_cast<std::size_t>(variant.placement);
    const auto purpose = static_cast<std::size_t>(variant.purpose);
    auto& slot = programs[(placement * kTilePurposeCount + purpose) * 2 + (variant.morphs ? 1 : 0)];
    if (!slot) {
      auto built = TileProgram::build(variant, effects, capabilities);
      if (!built) return built.error();
      slot.emplace(std::move(*built));
    }
    return &*slot;
  }

  /// As program; a driver that compiled the self-test but not this is reported once and asked for the Cpu placement
  /// instead.
  TileProgram* programOrFallback(TileVariant variant) {
    for (const Placement candidate : {variant.placement, Placement::Cpu}) {
      variant.placement = candidate;
      auto found = program(variant);
      if (found) return *found;
      if (!reported) fmt::print(stderr, "placement {}: {}\n", placementName(candidate), found.error().text());
      reported = true;
    }
    return nullptr;
  }
  bool reported = false;

  /// Uploaded tiles of the list, nearest first: what is in front is drawn first and hides the rest before it is shaded.
  std::vector<TileDraw> nearestTilesFirst(std::size_t body, const Camera& camera, std::span<const DrawnTile> list,
                                          bool skirts) {
    struct Entry {
      double distance;
      TileDraw draw;
    };
    std::vector<Entry> entries;
    entries.reserve(list.size());
    for (const DrawnTile& drawn : list) {
      if (const auto draw = makeTileDraw(tiles[body], drawn, skirts, capabilities.bufferWords)) {
        const Sphere& sphere = draw->tile->metadata.sphere;
        entries.push_back({glm::length(sphere.center - camera.positionBody) - sphere.radiusMeters, *draw});
      }
    }
    std::ranges::stable_sort(entries, {}, &Entry::distance);
    std::vector<TileDraw> ordered;
    ordered.reserve(entries.size());
    for (const Entry& entry : entries) ordered.push_back(entry.draw);
    return ordered;
  }

  /// Calls drawTile(program, draw) with everything set, tile by tile.
  template <class DrawTile>
  void forEachTile(const Camera& camera, std::span<const TileDraw> list, Placement placement, TilePurpose purpose,
                   const DrawTile& drawTile) {
    std::optional<GuardBand> band;
    if (purpose == TilePurpose::Shaded || purpose == TilePurpose::Coverage) band.emplace(capabilities, camera);
    std::array<TileProgram*, 2> begun{};  // for tiles as they are, for those that morph
    const TileProgram* current = nullptr;
    std::vector<TileDraw> unreachable;
    int drawn = 0;
    for (const TileDraw& draw : list) {
      const bool morphs = draw.parent != nullptr;
      TileProgram*& program = begun[morphs ? 1 : 0];
      if (program == nullptr) {
        program = programOrFallback({placement, purpose, morphs});
        if (program == nullptr) return;
        program->begin(camera, effects, band ? band->scale() : 1);
      } else if (program != current) {
        program->resume();
      }
      current = program;
      if (band) band->cullFor(draw.tile->metadata.sphere);
      if (program->place(draw, scratch)) {
        drawTile(*program, draw);
        if (capabilities.rendersOnCpu && ++drawn % kTilesPerFlush == 0) glFlush();
      } else {
        unreachable.push_back(draw);
      }
    }
    if (!unreachable.empty()) forEachTile(camera, unreachable, Placement::Cpu, purpose, drawTile);
  }

  /// What the vertex shader gives for each of a tile's vertices: four floats.
  std::vector<float> captured(const Camera& camera, const DrawnTile& tile, Placement placement, TilePurpose purpose) {
    const auto draw = makeTileDraw(tiles[0], tile, false, capabilities.bufferWords);
    if (!draw) return {};
    std::vector<float> values(4 * draw->tile->vertexCount);
    gl::Buffer feedback;
    feedback.allocate(gl::BufferTarget::Feedback, values.size() * sizeof(float), gl::BufferUse::ReadBack);
    feedback.bindForFeedback();
    glEnable(GL_RASTERIZER_DISCARD);
    forEachTile(camera, std::array{*draw}, placement, purpose, [](const TileProgram&, const TileDraw& placed) {
      glBeginTransformFeedback(GL_POINTS);
      glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(placed.tile->vertexCount));
      glEndTransformFeedback();
    });
    glDisable(GL_RASTERIZER_DISCARD);
    gl::VertexArray::unbind();
    feedback.read(0, std::as_writable_bytes(std::span(values)));
    return values;
  }

  /// One tile of a shaded pass.
  static void drawShaded(const TileProgram& program, const TileDraw& draw, const DrawSettings& settings,
                         DrawStats& stats) {
    if (settings.levelColors) program.setTint(levelTint(draw.tile->metadata.path.level()));
    TileIndices& indices = *draw.tile->layout->indices;
    stats.triangles += drawList(indices.surface(draw.coarserEdges));
    if (draw.skirts) stats.triangles += drawList(indices.skirts());
    stats.drawCalls += draw.skirts ? 2 : 1;
  }

  DrawStats drawTiles(std::span<const BodyPicture> bodies, const DrawSettings& settings, Placement placement) {
    DrawStats stats;
    stats.samples = gl::boundSamples();
    std::vector<std::vector<TileDraw>> ordered;
    {
      const TilePass pass(capabilities, settings.wireframe);
      for (const BodyPicture& body : bodies) {
        const Surfaces surfaces = surfacesOf(body.tiles, settings);
        ordered.push_back(nearestTilesFirst(body.body, body.camera, surfaces.tiles, surfaces.skirts));
        forEachTile(body.camera, ordered.back(), placement, TilePurpose::Shaded,
                    [&](const TileProgram& program, const TileDraw& draw) {
                      drawShaded(program, draw, settings, stats);
                      ++stats.tiles;
                    });
      }
    }
    if (settings.transition == Transition::Blend) blendParents(bodies, settings, placement, stats);
    if (settings.effectPasses && !settings.wireframe)
      for (std::size_t k = 0; k < bodies.size(); ++k)
        if (!ordered[k].empty() || bodies.size() == 1)
          drawPasses(bodies[k], bodies.size() == 1, ordered[k], settings, stats);
    return stats;
  }

  void drawCoverage(const BodyPicture& body, const DrawSettings& settings, Placement placement) {
    const Surfaces surfaces = surfacesOf(body.tiles, settings);
    forEachTile(body.camera, nearestTilesFirst(body.body, body.camera, surfaces.tiles, surfaces.skirts), placement,
                TilePurpose::Coverage, [](const TileProgram& program, const TileDraw& draw) {
                  TileIndices& indices = *draw.tile->layout->indices;
                  program.setMark(1.0f);
                  drawList(indices.surface(draw.coarserEdges));
                  if (!draw.skirts) return;
                  program.setMark(0.5f);
                  drawList(indices.skirts());
                });
  }

  void drawPasses(const BodyPicture& body, bool alone, std::span<const TileDraw> ordered, const DrawSettings& settings,
                  DrawStats& stats) {
    if (passes.empty()) return;
    const TilePass state(capabilities, settings.wireframe, TilePass::Start::Kept);
    if (!alone) {  // what a pass does for every pixel, it need not do for another body's
      const PixelRectangle disc = spherePixels(body.camera, body.highestRadiusMeters);
      glScissor(disc.left, disc.bottom, disc.width, disc.height);
      glEnable(GL_SCISSOR_TEST);
    }
    for (const auto& pass : passes) {
      const PassStats drawn = pass->draw(body.camera, ordered, passBodyOf(body, alone));
      stats.triangles += drawn.triangles;
      stats.drawCalls += drawn.drawCalls;
    }
    glDisable(GL_SCISSOR_TEST);
  }

  /// Mixes the parents' surfaces over the tiles' own, which were just drawn; nothing to do where no tile is in between.
  void blendParents(std::span<const BodyPicture> bodies, const DrawSettings& settings, Placement placement,
                    DrawStats& stats) {
    const auto between = [](const DrawnTile& tile) { return tile.morph.own > 0; };
    if (std::ranges::none_of(bodies, [&](const auto& body) { return std::ranges::any_of(body.tiles, between); }))
      return;
    if (!levelBlend) {
      auto created = LevelBlend::create(capabilities);
      if (!created) return;
      levelBlend.emplace(std::move(*created));
    }
    if (!levelBlend->bind(bodies.front().camera.widthPixels, bodies.front().camera.heightPixels)) return;
    {
      const TilePass pass(capabilities, settings.wireframe);
      LevelBlend::beginTiles();
      for (const BodyPicture& body : bodies) {
        std::unordered_map<FacePath, float> shares;
        for (const DrawnTile& tile : body.tiles)
          if (between(tile)) shares.emplace(tile.path, tile.morph.own);
        forEachTile(body.camera, nearestTilesFirst(body.body, body.camera, asTheirParents(body.tiles), true), placement,
                    TilePurpose::Shaded, [&](const TileProgram& program, const TileDraw& draw) {
                      const auto share = shares.find(draw.tile->metadata.path);
                      LevelBlend::setShare(share == shares.end() ? 0.0f : share->second);
                      drawShaded(program, draw, settings, stats);
                    });
      }
      LevelBlend::endTiles();
    }
    levelBlend->mix();
  }
};

Result<std::unique_ptr<TileRenderer>> TileRenderer::create(const std::vector<EffectCall>& effects,
                                                           const RendererOptions& options) {
  auto state = std::make_unique<State>();
  state->capabilities = gl::detectCapabilities(options.forceBaseline);
  auto report = runGpuSelfTest(state->capabilities);
  if (!report) return report.error();
  state->selfTest = *report;
  state->effects = makeEffects(effects);
  state->onlyRadiusMeters = options.bodyRadiusMeters;
  state->onlyScheme = options.bodyScheme;
  if (auto program = state->program({state->selfTest.chosen, TilePurpose::Shaded, false}); !program)
    return program.error();
  for (const auto& effect : state->effects) {
    auto pass = effect->makePass({state->capabilities, state->selfTest, state->effects, options.bodyRadiusMeters});
    if (!pass) return pass.error();
    if (*pass) state->passes.push_back(std::move(*pass));
  }
  return std::unique_ptr<TileRenderer>(new TileRenderer(std::move(state)));
}

TileRenderer::TileRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
TileRenderer::~TileRenderer() = default;

const SelfTestReport& TileRenderer::selfTest() const noexcept { return state_->selfTest; }

Placement TileRenderer::usable(Placement requested) const noexcept {
  if (requested == Placement::Integer && !state_->selfTest.integerExact) return Placement::Cpu;
  if (requested == Placement::DoubleFloat && !state_->selfTest.twoSumExact) return Placement::Cpu;
  return requested;
}

int TileRenderer::samplesByDefault() const noexcept { return state_->capabilities.rendersOnCpu ? 1 : kSamplesOnGpu; }

std::size_t TileRenderer::upload(const std::shared_ptr<const Tile>& tile, std::size_t body) {
  return state_->tiles[body].upload(*tile);
}
void TileRenderer::remove(const FacePath& path, std::size_t body) { state_->tiles[body].remove(path); }
void TileRenderer::clear() {
  for (auto& [body, tiles] : state_->tiles) tiles.clear();
}
std::size_t TileRenderer::gpuBytes() const noexcept {
  std::size_t sum = 0;
  for (const auto& [body, tiles] : state_->tiles) sum += tiles.bytes();
  for (const auto& pass : state_->passes) sum += pass->gpuBytes();
  return sum;
}

DrawStats TileRenderer::draw(const Camera& camera, std::span<const FacePath> tiles, const DrawSettings& settings) {
  return draw(camera, asTheyAre(tiles), settings);
}

DrawStats TileRenderer::draw(const Camera& camera, std::span<const DrawnTile> tiles, const DrawSettings& settings) {
  return draw(
      std::array{BodyPicture{
          .camera = camera, .tiles = tiles, .radiusMeters = state_->onlyRadiusMeters, .scheme = state_->onlyScheme}},
      settings);
}

DrawStats TileRenderer::draw(std::span<const BodyPicture> bodies, const DrawSettings& settings) {
  const Placement placement = usable(settings.placement);
  const Camera& camera = bodies.front().camera;
  const std::vector<BodyPicture> ordered = nearestFirst(bodies);
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  if (framebuffer != 0) {
    glViewport(0, 0, camera.widthPixels, camera.heightPixels);
    return state_->drawTiles(ordered, settings, placement);
  }
  std::optional<RenderTarget>& target = state_->windowTarget;
  if (!provide(target, camera, TargetFormat::Rgba8, settings.samples)) return {};
  target->bind();
  const DrawStats stats = state_->drawTiles(ordered, settings, placement);
  target->blitToWindow(camera.widthPixels, camera.heightPixels);
  return stats;
}

CoverageCount TileRenderer::countCoverage(const Camera& camera, std::span<const FacePath> tiles,
                                          const DrawSettings& settings, double lowestRadiusMeters) {
  return countCoverage(camera, asTheyAre(tiles), settings, lowestRadiusMeters);
}

CoverageCount TileRenderer::countCoverage(const Camera& camera, std::span<const DrawnTile> tiles,
                                          const DrawSettings& settings, double lowestRadiusMeters) {
  return countCoverage(
      std::array{BodyPicture{.body = 0, .camera = camera, .tiles = tiles, .lowestRadiusMeters = lowestRadiusMeters}},
      settings);
}

CoverageCount TileRenderer::countCoverage(std::span<const BodyPicture> bodies, const DrawSettings& settings) {
  GLint framebuffer = 0;
  std::array<GLint, 4> viewport{};
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  glGetIntegerv(GL_VIEWPORT, viewport.data());
  std::optional<RenderTarget>& target = state_->coverageTarget;
  if (!provide(target, bodies.front().camera, TargetFormat::R8, 1)) return {};
  target->bind();
  {
    const TilePass pass(state_->capabilities, false);
    for (const BodyPicture& body : nearestFirst(bodies))
      state_->drawCoverage(body, settings, usable(settings.placement));
  }
  const std::vector<std::uint8_t> pixels = target->readRed();
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(framebuffer));
  glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
  std::vector<LowestSphere> spheres;
  for (const BodyPicture& body : bodies) spheres.push_back({body.camera, body.lowestRadiusMeters});
  return countCoveragePixels(spheres, pixels);
}

std::vector<float> TileRenderer::clipPositions(const Camera& camera, const DrawnTile& tile, Placement placement) {
  return state_->captured(camera, tile, usable(placement), TilePurpose::Positions);
}

std::vector<float> TileRenderer::colorsAndLight(const Camera& camera, const DrawnTile& tile, Placement placement) {
  return state_->captured(camera, tile, usable(placement), TilePurpose::Shading);
}

}  // namespace terrane
