#include "client/render/tile_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "client/render/clip_rows.h"
#include "common/numerics/double_float3.h"

namespace terrane {
namespace {

/// Light on the display per unit of reflected light: highland soil (reflectance 0.16) under a high sun shows at 0.8 of
/// the display's scale, and little is ever cut off above.
constexpr float kExposure = 4.0f;

const char* placementDefine(Placement placement) {
  switch (placement) {
    case Placement::Integer:
      return "PLACEMENT_INTEGER";
    case Placement::DoubleFloat:
      return "PLACEMENT_DOUBLE_FLOAT";
    case Placement::Cpu:
      return "PLACEMENT_CPU";
    case Placement::Float32:
      return "PLACEMENT_FLOAT32";
  }
  return "PLACEMENT_CPU";
}

}  // namespace

glm::vec3 levelTint(int level) noexcept {
  const float hue = std::fmod(static_cast<float>(level) * 0.618034f, 1.0f) * 6.0f;
  const auto channel = [hue](float offset) {
    const float k = std::fmod(offset + hue, 6.0f);
    return 1.0f - 0.65f * std::clamp(std::min(k, 4.0f - k), 0.0f, 1.0f);
  };
  return {channel(5.0f), channel(3.0f), channel(1.0f)};
}

float displayExposure() noexcept { return std::pow(kExposure * kColorScale, static_cast<float>(1 / kDisplayGamma)); }

Result<TileProgram> TileProgram::build(const TileVariant& variant, const EffectList& effects,
                                       const gl::Capabilities& capabilities) {
  gl::ProgramSpec spec;
  spec.defines.emplace_back(placementDefine(variant.placement));
  if (variant.morphs) spec.defines.emplace_back("MORPH");
  switch (variant.purpose) {
    case TilePurpose::Shaded:
    case TilePurpose::Shading:
      spec.vertexFile = "tile.vert.glsl";
      if (variant.purpose == TilePurpose::Shaded) {
        spec.fragmentFile = "tile.frag.glsl";
      } else {
        spec.feedbackVaryings = {"color", "signedLight"};
      }
      spec.defines.push_back(fmt::format("DISPLAY_GAMMA {:.4f}", kDisplayGamma));
      std::ranges::move(definesOf(effects), std::back_inserter(spec.defines));
      break;
    case TilePurpose::Coverage:
      spec.vertexFile = "position.vert.glsl";
      spec.fragmentFile = "coverage.frag.glsl";
      break;
    case TilePurpose::Positions:
      spec.vertexFile = "position.vert.glsl";
      spec.feedbackVaryings = {"gl_Position"};
      break;
  }
  auto program = gl::Program::build(spec, capabilities);
  if (!program) return program.error();
  return TileProgram(std::move(*program), variant);
}

TileProgram::TileProgram(gl::Program program, const TileVariant& variant)
    : program_(std::move(program)), variant_(variant) {
  clipRows_ = program_.uniform("clipRows");
  nearMeters_ = program_.uniform("nearMeters");
  exposure_ = program_.uniform("exposure");
  tint_ = program_.uniform("tint");
  mark_ = program_.uniform("mark");
  stepMeters_ = program_.uniform("stepMeters");
  originMinusCamera_ = program_.uniform("originMinusCamera");
  cameraRest_ = program_.uniform("cameraRest");
  originHigh_ = program_.uniform("originHigh");
  originLow_ = program_.uniform("originLow");
  cameraHigh_ = program_.uniform("cameraHigh");
  cameraLow_ = program_.uniform("cameraLow");
  morphGrid_ = program_.uniform("morphGrid");
  firstInHalfCells_ = program_.uniform("firstInHalfCells");
  morphByBorders_ = program_.uniform("morphByBorders");
  parentMinusOwn_ = program_.uniform("parentMinusOwn");
  cameraOdd_ = program_.uniform("cameraOdd");
  parentCameraRest_ = program_.uniform("parentCameraRest");
  parentOriginHigh_ = program_.uniform("parentOriginHigh");
  parentOriginLow_ = program_.uniform("parentOriginLow");
}

void TileProgram::begin(const Camera& camera, const EffectList& effects, double viewportScale) {
  program_.use();
  cameraBody_ = camera.positionBody;
  stepExponent_.reset();
  const glm::dmat3 toPicture(glm::dvec3(1 / viewportScale, 0, 0), glm::dvec3(0, 1 / viewportScale, 0),
                             glm::dvec3(0, 0, 1));
  setUniform(clipRows_, glm::mat3(toPicture * clipRows(camera)));
  setUniform(nearMeters_, static_cast<float>(camera.nearMeters));
  const DoubleFloat3 position = fromDouble(camera.positionBody);
  setUniform(cameraHigh_, position.hi);
  setUniform(cameraLow_, position.lo);
  if (variant_.purpose == TilePurpose::Shaded || variant_.purpose == TilePurpose::Shading) {
    setUniform(exposure_, displayExposure() / 255);
    setTint(glm::vec3(1.0f));
    for (const auto& effect : effects) effect->setUniforms(program_);
  }
}

/// The camera on the lattice of this step and, for tiles that morph, on their parents'.
void TileProgram::placeCamera(int stepExponent) {
  if (stepExponent_ == stepExponent) return;
  stepExponent_ = stepExponent;
  camera_ = cameraOnLattice(cameraBody_, stepMeters(stepExponent));
  setUniform(stepMeters_, static_cast<float>(stepMeters(stepExponent)));
  setUniform(cameraRest_, camera_.rest);
  if (!variant_.morphs) return;
  const CameraOnLattice onParents = cameraOnLattice(cameraBody_, stepMeters(stepExponent + 1));
  setUniform(cameraOdd_, cameraOdd(camera_, onParents));
  setUniform(parentCameraRest_, onParents.rest);
}

void TileProgram::setMorph(const TileDraw& draw) const {
  const TileGrid& grid = draw.grid.grid;
  setUniform(morphGrid_, glm::ivec3{grid.cells + 1, grid.isSquare() ? 0 : 1, draw.grid.direction()});
  setUniform(firstInHalfCells_, draw.grid.firstInHalfCells());
  setUniform(morphByBorders_, draw.byBorders);
  setUniform(parentMinusOwn_, draw.grid.parentMinusOwn);
  const TileMetadata& parent = draw.parent->metadata;
  const DoubleFloat3 origin = fromDouble(latticePosition(parent.origin, parent.stepExponent));
  setUniform(parentOriginHigh_, origin.hi);
  setUniform(parentOriginLow_, origin.lo);
  draw.parent->words().bind();
}

bool TileProgram::place(const TileDraw& draw, std::vector<float>& scratch) {
  if (variant_.morphs) setMorph(draw);
  const TileMetadata& tile = draw.tile->metadata;
  placeCamera(tile.stepExponent);
  if (variant_.placement == Placement::Cpu) {
    placeOnCpu(draw, cameraBody_, scratch);
    return true;
  }
  if (variant_.placement == Placement::Integer) {
    const auto difference = originMinusCamera(tile.origin, camera_.steps);
    if (!difference) return false;
    setUniform(originMinusCamera_, *difference);
  } else {
    const DoubleFloat3 origin = fromDouble(latticePosition(tile.origin, tile.stepExponent));
    setUniform(originHigh_, origin.hi);
    setUniform(originLow_, origin.lo);
  }
  draw.tile->array.bind();
  return true;
}

void TileProgram::setTint(const glm::vec3& displayColor) const { setUniform(tint_, displayColor); }
void TileProgram::setMark(float value) const { setUniform(mark_, value); }

}  // namespace terrane
