#include "client/render/detail_pass.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "client/gl/render_target.h"
#include "client/render/clip_rows.h"
#include "client/render/gpu_tiles.h"
#include "common/numerics/octave_coordinates.h"

namespace terrane {

Result<std::unique_ptr<DetailPass>> DetailPass::create(const DetailStrength& strength, const EffectList& effects,
                                                       const gl::Capabilities& capabilities) {
  auto pass = std::unique_ptr<DetailPass>(new DetailPass(strength, capabilities));
  auto program = pass->build(effects, false);
  if (!program) return program.error();
  pass->program_.emplace(std::move(*program));
  return pass;
}

Result<gl::Program> DetailPass::build(const EffectList& effects, bool multisampled) const {
  gl::ProgramSpec spec;
  spec.vertexFile = "screen.vert.glsl";
  spec.fragmentFile = "detail.frag.glsl";
  spec.defines = definesOf(effects);
  spec.defines.push_back(fmt::format("OCTAVE_COUNT {}", kDetailOctaves));
  spec.defines.push_back(fmt::format("DISPLAY_GAMMA {:.4f}", kDisplayGamma));
  if (multisampled) spec.defines.emplace_back("MULTISAMPLED");
  return gl::Program::build(spec, capabilities_);
}

void setGroundPosition(const gl::Program& program, const GroundPicture& picture) {
  const Camera& camera = picture.camera;
  constexpr int kUnit = 0;
  picture.target.bindDepthTexture(kUnit);
  setUniform(program.uniform("groundDepth"), kUnit);
  setUniform(program.uniform("rays"), glm::mat3(screenRays(camera)));
  setUniform(program.uniform("pictureSize"), glm::vec2(camera.widthPixels, camera.heightPixels));
  setUniform(program.uniform("nearMeters"), static_cast<float>(camera.nearMeters));
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

void DetailPass::draw(const GroundPicture& picture) {
  const bool multisampled = picture.target.samples() > 1;
  std::optional<gl::Program>& program = multisampled ? multisampledProgram_ : program_;
  if (!program) {
    auto built = build(picture.effects, multisampled);
    if (!built) {
      if (!std::exchange(reported_, true)) fmt::print(stderr, "effect detail: {}\n", built.error().text());
      return;
    }
    program.emplace(std::move(*built));
  }
  picture.target.bindColorOnly();
  program->use();
  setGroundPosition(*program, picture);
  setDetailOctaves(*program, picture.camera);
  setUniform(program->uniform("cameraBody"), glm::vec3(picture.camera.positionBody));
  setUniform(program->uniform("finestPixels"), strength_.finestPixels);
  setUniform(program->uniform("firstExponent"), kFinestDetailExponent);
  setUniform(program->uniform("octaveSlopes"), strength_.slopes);
  setUniform(program->uniform("octaveMottles"), strength_.mottles);
  for (const auto& effect : picture.effects) effect->setUniforms(*program);
  glEnable(GL_BLEND);
  glBlendFunc(GL_DST_COLOR, GL_SRC_COLOR);  // twice the product
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  noVertices_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  gl::VertexArray::unbind();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glBlendFunc(GL_ONE, GL_ZERO);
  glDisable(GL_BLEND);
  glUseProgram(0);
  picture.target.bind();
}

}  // namespace terrane
