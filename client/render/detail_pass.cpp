#include "client/render/detail_pass.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <cmath>

#include "client/gl/depth_copy.h"
#include "client/gl/objects.h"
#include "client/render/ground_position.h"
#include "common/numerics/octave_coordinates.h"

namespace terrane {
namespace {

class DetailPass final : public EffectPass {
 public:
  DetailPass(const DetailStrength& strength, const EffectList& effects, gl::Program program)
      : strength_(strength), effects_(effects), program_(std::move(program)) {}

  PassStats draw(const Camera& camera, std::span<const TileDraw> /*tiles*/, const PassBody& body) override {
    if (!depth_.take(camera.widthPixels, camera.heightPixels)) return {};
    program_.use();
    depth_.bind();
    setGroundPosition(program_, camera);
    setDetailOctaves(program_, camera);
    setUniform(program_.uniform("cameraBody"), glm::vec3(camera.positionBody));
    setUniform(program_.uniform("reachMeters"), static_cast<float>(body.reachMeters));
    setUniform(program_.uniform("finestPixels"), strength_.finestPixels);
    setUniform(program_.uniform("firstExponent"), kFinestDetailExponent);
    setUniform(program_.uniform("octaveSlopes"), strength_.slopes);
    setUniform(program_.uniform("octaveMottles"), strength_.mottles);
    for (const auto& effect : effects_) effect->setUniforms(program_);
    multiplyPicture();
    return {.triangles = 1, .drawCalls = 1};
  }

  std::size_t gpuBytes() const noexcept override { return depth_.bytes(); }

 private:
  void multiplyPicture() const {
    glEnable(GL_BLEND);
    glBlendFunc(GL_DST_COLOR, GL_SRC_COLOR);  // twice the product
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    noVertices_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
  }

  DetailStrength strength_;
  const EffectList& effects_;
  gl::Program program_;
  gl::VertexArray noVertices_;
  gl::DepthCopy depth_;
};

}  // namespace

Result<std::unique_ptr<EffectPass>> makeDetailPass(const DetailStrength& strength, const PassContext& context) {
  gl::ProgramSpec spec;
  spec.vertexFile = "whole_picture.vert.glsl";
  spec.fragmentFile = "detail.frag.glsl";
  spec.defines = definesOf(context.effects);
  spec.defines.push_back(fmt::format("OCTAVE_COUNT {}", kDetailOctaves));
  spec.defines.push_back(fmt::format("DISPLAY_GAMMA {:.4f}", kDisplayGamma));
  auto program = gl::Program::build(spec, context.capabilities);
  if (!program) return program.error();
  return std::unique_ptr<EffectPass>(std::make_unique<DetailPass>(strength, context.effects, std::move(*program)));
}

void setDetailOctaves(const gl::Program& program, const Camera& camera) {
  std::array<glm::vec4, kDetailOctaves> octaves;
  std::array<glm::ivec3, kDetailOctaves> cells;
  for (int octave = 0; octave < kDetailOctaves; ++octave) {
    const int exponent = kFinestDetailExponent + octave;
    const OctaveCoordinates place = octaveCoordinates(camera.positionBody, exponent);
    octaves[static_cast<std::size_t>(octave)] = glm::vec4(place.rest, std::ldexp(1.0f, -exponent));
    cells[static_cast<std::size_t>(octave)] = place.cell;
  }
  setUniform(program.uniform("octaves"), octaves);
  setUniform(program.uniform("octaveCells"), cells);
}

}  // namespace terrane
