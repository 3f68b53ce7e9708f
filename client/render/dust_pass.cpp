#include "client/render/dust_pass.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <map>
#include <utility>

#include "client/dust/pebble_shapes.h"
#include "client/gl/depth_copy.h"
#include "client/render/clip_rows.h"
#include "client/render/dust_instances.h"
#include "client/render/ground_position.h"
#include "client/render/tile_program.h"
#include "common/numerics/double_float3.h"

namespace terrane {
namespace {

using gl::Component, gl::Conversion;
constexpr std::array kMeshAttributes{
    gl::VertexAttribute{0, 3, Component::F32, Conversion::Float, offsetof(PebbleVertex, direction)},
    gl::VertexAttribute{1, 4, Component::F32, Conversion::Float, offsetof(PebbleVertex, radii)},
    gl::VertexAttribute{2, 4, Component::F32, Conversion::Float, offsetof(PebbleVertex, coarserRadii)},
};
constexpr std::array kInstanceAttributes{
    gl::VertexAttribute{3, 4, Component::F32, Conversion::Float, offsetof(GrainInstance, rootHigh)},
    gl::VertexAttribute{4, 4, Component::F32, Conversion::Float, offsetof(GrainInstance, rootLow)},
    gl::VertexAttribute{5, 4, Component::I16, Conversion::Normalized, offsetof(GrainInstance, turn)},
    gl::VertexAttribute{6, 3, Component::I16, Conversion::Normalized, offsetof(GrainInstance, normal)},
    gl::VertexAttribute{7, 1, Component::U16, Conversion::Integer, offsetof(GrainInstance, variant)},
    gl::VertexAttribute{8, 4, Component::U8, Conversion::Normalized, offsetof(GrainInstance, color)},
    gl::VertexAttribute{9, 2, Component::U8, Conversion::Normalized, offsetof(GrainInstance, flattening)},
};
constexpr int kBoxStrip = 14, kBoxTriangles = 12;

/// A mesh with the instances of it that are in view.
struct Batch {
  gl::Buffer vertices, indices, instances;
  gl::VertexArray meshArray, boxArray;
  std::size_t indexCount = 0;
  std::vector<GrainInstance> uploaded;

  void make(const PebbleMesh& mesh) {
    vertices.upload(gl::BufferTarget::Vertices, gl::bytesOf(mesh.vertices), gl::BufferUse::Static);
    meshArray.attach(vertices, sizeof(PebbleVertex), kMeshAttributes);
    meshArray.attachInstances(instances, sizeof(GrainInstance), kInstanceAttributes);
    indices.upload(gl::BufferTarget::Indices, gl::bytesOf(mesh.triangles), gl::BufferUse::Static);
    boxArray.attachInstances(instances, sizeof(GrainInstance), kInstanceAttributes);
    gl::VertexArray::unbind();
    indexCount = mesh.triangles.size();
  }

  /// While nothing changes nothing is uploaded.
  void update(const std::vector<GrainInstance>& now) {
    const std::size_t bytes = now.size() * sizeof(GrainInstance);
    if (now.size() == uploaded.size() && (bytes == 0 || std::memcmp(now.data(), uploaded.data(), bytes) == 0)) return;
    uploaded = now;
    instances.upload(gl::BufferTarget::Vertices, gl::bytesOf(uploaded), gl::BufferUse::Stream);
  }
};

/// What both programs are told of the camera.
class GrainProgram {
 public:
  static Result<GrainProgram> build(std::string_view vertexFile, std::string_view fragmentFile,
                                    const PassContext& context) {
    gl::ProgramSpec spec;
    spec.vertexFile = vertexFile;
    spec.fragmentFile = fragmentFile;
    spec.defines = {fmt::format("DISPLAY_GAMMA {:.4f}", kDisplayGamma),
                    fmt::format("PEBBLE_RADIUS {:.4f}", static_cast<double>(kPebbleMeanRadius))};
    std::ranges::move(definesOf(context.effects), std::back_inserter(spec.defines));
    auto program = gl::Program::build(spec, context.capabilities);
    if (!program) return program.error();
    return GrainProgram(std::move(*program));
  }

  void begin(const Camera& camera, const EffectList& effects, bool relative) const {
    program_.use();
    const DoubleFloat3 position = relative ? DoubleFloat3{} : fromDouble(camera.positionBody);
    setUniform(program_.uniform("cameraHigh"), position.hi);
    setUniform(program_.uniform("cameraLow"), position.lo);
    setUniform(program_.uniform("clipRows"), glm::mat3(clipRows(camera)));
    setUniform(program_.uniform("nearMeters"), static_cast<float>(camera.nearMeters));
    setUniform(program_.uniform("pixelsPerRadian"), static_cast<float>(pixelsPerRadian(camera)));
    setUniform(program_.uniform("seenPixels"), glm::vec2(kGrainUnseenPixels, kGrainSeenPixels));
    setUniform(program_.uniform("exposure"), displayExposure());
    for (const auto& effect : effects) effect->setUniforms(program_);
  }

  void setGround(const Camera& camera) const { setGroundPosition(program_, camera); }

 private:
  explicit GrainProgram(gl::Program program) : program_(std::move(program)) {}
  gl::Program program_;
};

class DustPass final : public EffectPass {
 public:
  DustPass(const DustSettings& settings, const PassContext& context, GrainProgram grains, GrainProgram shadows)
      : effects_(context.effects),
        relative_(!context.selfTest.twoSumExact),
        settings_(settings),
        grains_(std::move(grains)),
        shadows_(std::move(shadows)) {
    for (int mesh = 0; mesh < kGrainMeshes; ++mesh) batches_[static_cast<std::size_t>(mesh)].make(pebbleMesh(mesh));
  }

  PassStats draw(const Camera& camera, std::span<const TileDraw> tiles, const PassBody& body) override {
    DustInstances& gathered =
        gathered_.try_emplace(body.body, settings_, body.radiusMeters, body.scheme, relative_).first->second;
    gathered.gather(camera, tiles);
    // Grains are seen from so near that hardly ever two bodies have any: the batches stay with the one that had some.
    if (gathered.isEmpty() && body.body != batchesOf_) return {};
    batchesOf_ = body.body;
    PassStats stats;
    for (int mesh = 0; mesh < kGrainMeshes; ++mesh) {
      Batch& batch = batches_[static_cast<std::size_t>(mesh)];
      batch.update(gathered.ofMesh(mesh));
      if (batch.uploaded.empty()) continue;
      stats.triangles += (batch.indexCount / 3 + kBoxTriangles) * batch.uploaded.size();
      stats.drawCalls += 2;
    }
    if (stats.drawCalls == 0) return stats;
    drawGrains(camera);
    if (depth_.take(camera.widthPixels, camera.heightPixels)) drawShadows(camera);
    return stats;
  }

  std::size_t gpuBytes() const noexcept override {
    std::size_t sum = depth_.bytes();
    for (const Batch& batch : batches_) sum += batch.vertices.bytes() + batch.indices.bytes() + batch.instances.bytes();
    return sum;
  }

 private:
  void drawGrains(const Camera& camera) {
    grains_.begin(camera, effects_, relative_);
    for (const Batch& batch : batches_) {
      if (batch.uploaded.empty()) continue;
      batch.meshArray.bind();
      glDrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(batch.indexCount), GL_UNSIGNED_SHORT, nullptr,
                              static_cast<GLsizei>(batch.uploaded.size()));
    }
  }

  /// Boxes by their far sides, which are there when the camera is inside, too; depth is read, not tested.
  void drawShadows(const Camera& camera) {
    shadows_.begin(camera, effects_, relative_);
    shadows_.setGround(camera);
    depth_.bind();
    glEnable(GL_BLEND);
    glBlendFunc(GL_DST_COLOR, GL_ZERO);
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glCullFace(GL_FRONT);
    for (const Batch& batch : batches_) {
      if (batch.uploaded.empty()) continue;
      batch.boxArray.bind();
      glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, kBoxStrip, static_cast<GLsizei>(batch.uploaded.size()));
    }
    glCullFace(GL_BACK);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
  }

  const EffectList& effects_;
  bool relative_;
  DustSettings settings_;
  std::map<std::size_t, DustInstances> gathered_;  ///< by body
  std::size_t batchesOf_ = 0;
  GrainProgram grains_, shadows_;
  std::array<Batch, kGrainMeshes> batches_;
  gl::DepthCopy depth_;
};

}  // namespace

Result<std::unique_ptr<EffectPass>> makeDustPass(const DustSettings& settings, const PassContext& context) {
  if (!(context.bodyRadiusMeters > 0)) return std::unique_ptr<EffectPass>();
  auto grains = GrainProgram::build("grain.vert.glsl", "grain.frag.glsl", context);
  if (!grains) return grains.error();
  auto shadows = GrainProgram::build("grain_shadow.vert.glsl", "grain_shadow.frag.glsl", context);
  if (!shadows) return shadows.error();
  return std::unique_ptr<EffectPass>(
      std::make_unique<DustPass>(settings, context, std::move(*grains), std::move(*shadows)));
}

}  // namespace terrane
