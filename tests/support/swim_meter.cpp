#include "tests/support/swim_meter.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <unordered_set>

#include "client/gl/depth_copy.h"
#include "client/gl/render_target.h"
#include "client/render/clip_rows.h"
#include "client/render/detail_pass.h"
#include "client/render/ground_position.h"
#include "client/render/tile_renderer.h"
#include "common/numerics/octave_coordinates.h"
#include "common/view/level_transitions.h"

namespace terrane::test {
namespace {

constexpr std::string_view kShowCoordinate = R"glsl(
#include "ground_position.glsl"
#include "detail_octaves.glsl"
uniform int octave;
uniform ivec3 markedCell;
uniform vec3 markedAt;
uniform vec3 cameraBody;
layout(location = 0) out vec4 fromMarked;  // in wavelengths
void main() {
  vec3 relative = groundRelative(gl_FragCoord.xy, depthAt(gl_FragCoord.xy));
  OctavePlace place = octavePlace(octave, relative);
#ifdef FLOAT32
  vec3 inBody = (cameraBody + relative) * octaves[octave].w;
  place = OctavePlace(ivec3(floor(inBody)), inBody - floor(inBody));
#endif
  fromMarked = vec4(vec3(place.cell - markedCell) + (place.at - markedAt), 1.0);
}
)glsl";

/// Numbers, four a pixel.
class FloatTarget {
 public:
  FloatTarget(int width, int height) {
    GLuint ids[2] = {};
    glGenTextures(1, &ids[0]);
    glBindTexture(GL_TEXTURE_2D, ids[0]);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
    glBindTexture(GL_TEXTURE_2D, 0);
    glGenFramebuffers(1, &ids[1]);
    glBindFramebuffer(GL_FRAMEBUFFER, ids[1]);
    glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, ids[0], 0);
    color_ = gl::Handle<gl::ObjectKind::Texture>(ids[0]);
    framebuffer_ = gl::Handle<gl::ObjectKind::Framebuffer>(ids[1]);
  }
  void bind() const { glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id()); }

 private:
  gl::Handle<gl::ObjectKind::Texture> color_;
  gl::Handle<gl::ObjectKind::Framebuffer> framebuffer_;
};

/// Along a ray from 0; infinity where it misses.
double distanceToTriangle(const glm::dvec3& ray, const std::array<glm::dvec3, 3>& corners) {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  const glm::dvec3 a = corners[1] - corners[0], b = corners[2] - corners[0], p = glm::cross(ray, b);
  const double determinant = glm::dot(a, p);
  if (determinant == 0) return kMiss;
  const glm::dvec3 t = -corners[0], q = glm::cross(t, a);
  const double u = glm::dot(t, p) / determinant, v = glm::dot(ray, q) / determinant;
  constexpr double kSlack = 1e-7;  // corners come in float
  if (u < -kSlack || v < -kSlack || u + v > 1 + kSlack) return kMiss;
  const double distance = glm::dot(b, q) / determinant;
  return distance > 0 ? distance : kMiss;
}

class SwimRun {
 public:
  SwimRun(TileSource& moon, const SwimSettings& settings, RenderTarget target, std::unique_ptr<TileRenderer> renderer,
          gl::Program program)
      : moon_(moon),
        settings_(settings),
        target_(std::move(target)),
        numbers_(settings.widthPixels, settings.heightPixels),
        renderer_(std::move(renderer)),
        program_(std::move(program)) {}

  Swim fly();

 private:
  void advance();
  void draw();
  /// Of the ground that is drawn, relative to the camera; NaN for none.
  glm::dvec3 groundAt(const glm::dvec2& pixelCentre, const glm::dvec3& nearBody);
  glm::dvec3 coordinateAt(const glm::ivec2& pixel);
  void mark();

  TileSource& moon_;
  const SwimSettings& settings_;
  RenderTarget target_;
  FloatTarget numbers_;
  std::unique_ptr<TileRenderer> renderer_;
  gl::Program program_;
  gl::VertexArray noVertices_;
  gl::DepthCopy depth_;
  LevelTransitions transitions_;
  std::unordered_set<FacePath> there_;
  std::vector<DrawnTile> drawn_;
  Camera camera_;
  glm::dvec3 marked_{0.0};
  int octave_ = 0;
  OctaveCoordinates markedPlace_;
};

void SwimRun::advance() {
  const TileSelection selection = moon_.settle(camera_, {.errorPixels = settings_.errorPixels});
  const auto load = [&](const FacePath& path) {
    if (there_.insert(path).second) renderer_->upload(moon_.tile(path));
  };
  for (const FacePath& path : selection.draw)
    for (int level = 0; level <= path.level(); ++level) load(path.ancestor(level));
  drawn_ = transitions_.advance(
      selection.draw, 1.0 / 30,
      [&](const FacePath& path) { return path.level() > 0 && there_.contains(path) && there_.contains(path.parent()); },
      [](const FacePath&) { return true; });
}

void SwimRun::draw() {
  target_.bind();
  renderer_->draw(camera_, drawn_, {});
  depth_.take(settings_.widthPixels, settings_.heightPixels);
  numbers_.bind();
  glViewport(0, 0, settings_.widthPixels, settings_.heightPixels);
  program_.use();
  depth_.bind();
  setGroundPosition(program_, camera_);
  setDetailOctaves(program_, camera_);
  setUniform(program_.uniform("octave"), octave_);
  setUniform(program_.uniform("markedCell"), markedPlace_.cell);
  setUniform(program_.uniform("markedAt"), markedPlace_.rest);
  setUniform(program_.uniform("cameraBody"), glm::vec3(camera_.positionBody));
  noVertices_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  gl::VertexArray::unbind();
  glUseProgram(0);
}

glm::dvec3 SwimRun::groundAt(const glm::dvec2& pixelCentre, const glm::dvec3& nearBody) {
  const glm::dmat3 rays = screenRays(camera_);
  const glm::dvec2 size(settings_.widthPixels, settings_.heightPixels);
  const glm::dvec3 ray = rays * glm::dvec3(pixelCentre * 2.0 / size - 1.0, 1.0);
  double nearest = std::numeric_limits<double>::infinity();
  for (const DrawnTile& drawn : drawn_) {
    const TileMetadata& tile = moon_.tile(drawn.path)->metadata;
    if (glm::distance(tile.sphere.center, nearBody) > 1.1 * tile.sphere.radiusMeters) continue;
    const std::vector<float> clip = renderer_->clipPositions(camera_, drawn, Placement::Integer);
    const TileGrid grid{tile.path.scheme(), tile.cellsPerEdge};
    const auto corner = [&](const GridVertex& vertex) {
      const float* at = clip.data() + 4 * static_cast<std::size_t>(grid.index(vertex));
      return rays * glm::dvec3(at[0], at[1], at[3]);
    };
    const auto meet = [&](const GridVertex& a, const GridVertex& b, const GridVertex& c) {
      nearest = std::min(nearest, distanceToTriangle(ray, {corner(a), corner(b), corner(c)}));
    };
    for (int j = 0; j < grid.cells; ++j)
      for (int i = 0; i < grid.rowEnd(j); ++i) grid.eachTriangle(i, j, meet);
  }
  return std::isfinite(nearest) ? ray * nearest : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
}

glm::dvec3 SwimRun::coordinateAt(const glm::ivec2& pixel) {
  std::array<float, 4> numbers{};
  numbers_.bind();
  glReadPixels(pixel.x, pixel.y, 1, 1, GL_RGBA, GL_FLOAT, numbers.data());
  return glm::dvec3(numbers[0], numbers[1], numbers[2]) * std::ldexp(1.0, kFinestDetailExponent + octave_);
}

/// The texel in the middle of the picture, in an octave of four pixels or more.
void SwimRun::mark() {
  const glm::dvec2 middle = 0.5 * glm::dvec2(settings_.widthPixels, settings_.heightPixels);
  // Nearly there, from the ground below, for the tiles to be asked; then from what is drawn.
  const double ahead = settings_.heightMeters / std::sin(-settings_.pitchDegrees * std::numbers::pi / 180);
  const glm::dvec3 relative = groundAt(middle, camera_.positionBody - camera_.backward * ahead);
  marked_ = camera_.positionBody + relative;
  const double pixelMeters = glm::length(relative) / pixelsPerRadian(camera_);
  const int exponent = static_cast<int>(std::ceil(std::log2(4 * pixelMeters)));
  octave_ = std::clamp(exponent - kFinestDetailExponent, 0, kDetailOctaves - 1);
  markedPlace_ = octaveCoordinates(marked_, kFinestDetailExponent + octave_);
}

Swim SwimRun::fly() {
  constexpr double kDegree = std::numbers::pi / 180;
  const ViewPose pose{-16.4018 * kDegree, 21.6039 * kDegree, settings_.heightMeters, 0.4,
                      settings_.pitchDegrees * kDegree};
  const Camera first = moon_.cameraAboveGround(pose, settings_.widthPixels, settings_.heightPixels);
  camera_ = first;
  advance();
  mark();
  const double pixelMeters = glm::distance(marked_, camera_.positionBody) / pixelsPerRadian(camera_);
  Swim swim{.wavelengthMeters = std::ldexp(1.0, kFinestDetailExponent + octave_)};
  std::vector<double> pixels;
  for (int frame = 0; frame < settings_.frames; ++frame) {
    const double aside = (frame - 0.5 * settings_.frames) * settings_.pixelsPerFrame * pixelMeters;
    camera_.positionBody = first.positionBody + first.right * aside;
    camera_.altitudeMeters =
        first.altitudeMeters + (glm::length(camera_.positionBody) - glm::length(first.positionBody));
    advance();
    draw();
    const glm::dvec3 clip = clipRows(camera_) * (marked_ - camera_.positionBody);
    const glm::dvec2 size(settings_.widthPixels, settings_.heightPixels);
    const glm::ivec2 pixel(glm::floor((glm::dvec2(clip) / clip.z + 1.0) * 0.5 * size));
    if (clip.z <= 0 || pixel.x < 0 || pixel.y < 0 || pixel.x >= settings_.widthPixels ||
        pixel.y >= settings_.heightPixels)
      continue;
    const glm::dvec3 relative = groundAt(glm::dvec2(pixel) + 0.5, marked_);
    const glm::dvec3 truth = (camera_.positionBody - marked_) + relative;
    const double offMeters = glm::distance(coordinateAt(pixel), truth);
    if (!std::isfinite(offMeters)) continue;
    pixels.push_back(offMeters * pixelsPerRadian(camera_) / glm::length(relative));
  }
  RenderTarget::bindWindow();
  swim.frames = static_cast<int>(pixels.size());
  swim.levelChanges = static_cast<int>(transitions_.counts().splits + transitions_.counts().merges);
  std::ranges::sort(pixels);
  if (!pixels.empty()) {
    swim.worstPixels = pixels.back();
    swim.medianPixels = pixels[pixels.size() / 2];
  }
  return swim;
}

}  // namespace

Result<Swim> measureSwim(TileSource& moon, const SwimSettings& settings) {
  auto target = RenderTarget::create(settings.widthPixels, settings.heightPixels);
  if (!target) return target.error();
  auto renderer = TileRenderer::create({});
  if (!renderer) return renderer.error();
  gl::ProgramSpec spec;
  spec.vertexFile = "whole_picture.vert.glsl";
  spec.fragmentText = kShowCoordinate;
  spec.defines.push_back(fmt::format("OCTAVE_COUNT {}", kDetailOctaves));
  if (settings.coordinates == TextureCoordinates::Float32) spec.defines.emplace_back("FLOAT32");
  auto program = gl::Program::build(spec, gl::detectCapabilities());
  if (!program) return program.error();
  return SwimRun(moon, settings, std::move(*target), std::move(*renderer), std::move(*program)).fly();
}

}  // namespace terrane::test
