// Depth formats at work: real terrain drawn with each, what a frame takes, and how often a surface shows that lies a
// little behind another.

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <utility>

#include "client/gl/capabilities.h"
#include "client/gl/objects.h"
#include "common/tiling/lattice.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/gl/moon_stage.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/span.h"

namespace terrane::accuracy {
namespace {

constexpr double kNearMeters = 0.01, kFarMeters = 1e10;  // as the experiment "depth" has them

enum class Mapping : std::uint8_t { Ordinary, Reversed, Logarithmic };

struct Format {
  const char* name;
  GLenum storage;
  Mapping mapping;
  bool nearFollowsHeight = false;  ///< a tenth of the height above the ground, not kNearMeters
};
constexpr std::array<Format, 7> kFormats{
    {{"24 bits", GL_DEPTH_COMPONENT24, Mapping::Ordinary},
     {"24 bits, near at height / 10", GL_DEPTH_COMPONENT24, Mapping::Ordinary, true},
     {"24 bits, reversed", GL_DEPTH_COMPONENT24, Mapping::Reversed},
     {"24 bits, logarithmic", GL_DEPTH_COMPONENT24, Mapping::Logarithmic},
     {"float", GL_DEPTH_COMPONENT32F, Mapping::Ordinary},
     {"float, logarithmic", GL_DEPTH_COMPONENT32F, Mapping::Logarithmic},
     {"float, reversed (Terrane)", GL_DEPTH_COMPONENT32F, Mapping::Reversed}}};
constexpr std::size_t kOrdinary24 = 0, kOrdinaryHeight24 = 1, kOrdinaryFloat = 4, kReversedFloat = 6;

constexpr const char* kVersion = "#version 330 core\n";
constexpr const char* kVertexShader = R"(
layout(location = 0) in vec3 relative;  // to the camera, metres
layout(location = 1) in float light;
uniform mat3 clipRows;   // x, y and w of projection * rotation
uniform float push;      // away from the eye, as a factor of the distance
uniform vec2 depthOfW;   // clip z = x * w + y
out float shade;
out float onePlusW;
void main() {
  vec3 xyw = clipRows * (relative * push);
  gl_Position = vec4(xyw.xy, depthOfW.x * xyw.z + depthOfW.y, xyw.z);
  shade = light;
  onePlusW = 1.0 + xyw.z;
}
)";
constexpr const char* kFragmentShader = R"(
uniform vec3 tint;
uniform float logarithmScale;
in float shade;
in float onePlusW;
out vec4 pixel;
void main() {
  pixel = vec4(tint * shade, 1.0);
#ifdef LOGARITHMIC
  gl_FragDepth = log2(onePlusW) * logarithmScale;
#endif
}
)";

using ProgramHandle = gl::Handle<gl::ObjectKind::Program>;

Result<ProgramHandle> buildProgram(bool logarithmic) {
  ProgramHandle program(glCreateProgram());
  for (const auto& [kind, body] :
       {std::pair<GLenum, const char*>{GL_VERTEX_SHADER, kVertexShader}, {GL_FRAGMENT_SHADER, kFragmentShader}}) {
    const gl::Handle<gl::ObjectKind::Shader> shader(glCreateShader(kind));
    const std::array<const char*, 3> text{kVersion, logarithmic ? "#define LOGARITHMIC\n" : "", body};
    glShaderSource(shader.id(), static_cast<GLsizei>(text.size()), text.data(), nullptr);
    glCompileShader(shader.id());
    glAttachShader(program.id(), shader.id());
  }
  glLinkProgram(program.id());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  std::array<char, 1024> log{};
  glGetProgramInfoLog(program.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  return makeError(ErrorKind::Unsupported, "shader", log.data());
}

/// Colour beside a depth buffer of any storage.
class DepthTarget {
 public:
  static Result<DepthTarget> create(GLenum storage, int width, int height) {
    DepthTarget target;
    GLuint framebuffer = 0;
    std::array<GLuint, 2> buffers{};
    glGenFramebuffers(1, &framebuffer);
    glGenRenderbuffers(2, buffers.data());
    target.framebuffer_ = gl::Handle<gl::ObjectKind::Framebuffer>(framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    for (std::size_t i = 0; i < 2; ++i) {
      target.buffers_[i] = gl::Handle<gl::ObjectKind::Renderbuffer>(buffers[i]);
      glBindRenderbuffer(GL_RENDERBUFFER, buffers[i]);
      glRenderbufferStorage(GL_RENDERBUFFER, i == 0 ? GL_RGBA8 : storage, width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, i == 0 ? GL_COLOR_ATTACHMENT0 : GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                buffers[i]);
    }
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return target;
    return makeError(ErrorKind::Unsupported, "framebuffer", "the driver refuses a depth format");
  }
  void bind() const { glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id()); }

 private:
  gl::Handle<gl::ObjectKind::Framebuffer> framebuffer_;
  std::array<gl::Handle<gl::ObjectKind::Renderbuffer>, 2> buffers_;
};

struct Vertex {
  std::array<float, 3> relative;
  float light;
};

struct Mesh {
  gl::Buffer vertices, indices;
  gl::VertexArray array;
  int indexCount = 0;
};

Mesh meshOf(const Camera& camera, const Tile& tile) {
  const double step = stepMeters(tile.metadata.stepExponent);
  const glm::dvec3 origin = latticePosition(tile.metadata.origin, tile.metadata.stepExponent) - camera.positionBody;
  const glm::dvec3 sun = glm::normalize(glm::normalize(camera.positionBody) + camera.right);
  std::vector<Vertex> vertices(tile.mesh.vertexCount());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    double light = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      vertices[i].relative[a] = static_cast<float>(origin[axis] + step * tile.mesh.offsets[3 * i + a]);
      light += sun[axis] * static_cast<double>(tile.mesh.normals[3 * i + a]);
    }
    vertices[i].light = static_cast<float>(0.2 + 0.8 * std::max(light, 0.0));
  }
  const std::vector<std::uint16_t> indices(tile.mesh.triangles.begin(), tile.mesh.triangles.end());
  Mesh mesh;
  mesh.indexCount = static_cast<int>(indices.size());
  mesh.vertices.upload(gl::BufferTarget::Vertices, gl::bytesOf(vertices), gl::BufferUse::Static);
  const std::array<gl::VertexAttribute, 2> attributes{
      {{0, 3, gl::Component::F32, gl::Conversion::Float, 0}, {1, 1, gl::Component::F32, gl::Conversion::Float, 12}}};
  mesh.array.attach(mesh.vertices, sizeof(Vertex), attributes);
  mesh.indices.upload(gl::BufferTarget::Indices, gl::bytesOf(indices), gl::BufferUse::Static);
  mesh.array.attachIndices(mesh.indices);
  gl::VertexArray::unbind();
  return mesh;
}

/// The settled tiles of one view, nearest first, and the programs that draw them with any format.
class Terrain {
 public:
  static Result<Terrain> create(const MoonView& view, int width, int height, double errorPixels) {
    auto plain = buildProgram(false), logarithmic = buildProgram(true);
    if (!plain) return plain.error();
    if (!logarithmic) return logarithmic.error();
    TileSource tiles("moon");
    Terrain terrain(cameraOf(view, tiles, width, height), view.aboveGroundMeters);
    terrain.plain_ = std::move(*plain);
    terrain.logarithmic_ = std::move(*logarithmic);
    std::vector<FacePath> paths = tiles.settledTiles(terrain.camera_, errorPixels);
    std::ranges::stable_sort(paths, {}, [&](const FacePath& path) {
      const Sphere& sphere = tiles.tile(path)->metadata.sphere;
      return glm::length(sphere.center - terrain.camera_.positionBody) - sphere.radiusMeters;
    });
    for (const FacePath& path : paths) terrain.meshes_.push_back(meshOf(terrain.camera_, *tiles.tile(path)));
    return terrain;
  }

  /// Clears and sets all that a frame with this format needs.
  void begin(const Format& format, const DepthTarget& target) {
    target.bind();
    glViewport(0, 0, camera_.widthPixels, camera_.heightPixels);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    const bool reversed = format.mapping == Mapping::Reversed;
    glDepthFunc(reversed ? GL_GREATER : GL_LESS);
    glClearDepth(reversed ? 0.0 : 1.0);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

    program_ = format.mapping == Mapping::Logarithmic ? logarithmic_.id() : plain_.id();
    glUseProgram(program_);
    const glm::dmat4 projection = reversedInfiniteProjection(camera_);
    std::array<float, 9> rows{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      rows[a] = static_cast<float>(projection[0][0] * camera_.right[axis]);
      rows[3 + a] = static_cast<float>(projection[1][1] * camera_.up[axis]);
      rows[6 + a] = static_cast<float>(-camera_.backward[axis]);
    }
    glUniformMatrix3fv(at("clipRows"), 1, GL_TRUE, rows.data());
    const double near = format.nearFollowsHeight ? heightMeters_ / 10 : kNearMeters, span = kFarMeters - near;
    if (format.mapping == Mapping::Ordinary) {
      glUniform2f(at("depthOfW"), static_cast<float>(kFarMeters / span), static_cast<float>(-kFarMeters * near / span));
    } else {
      glUniform2f(at("depthOfW"), 0, static_cast<float>(near));
    }
    glUniform1f(at("logarithmScale"), static_cast<float>(1 / std::log2(kFarMeters + 1)));
  }

  /// After begin. separation: how far beyond its place, as a share of the distance.
  void draw(double separation, const std::array<float, 3>& tint) const {
    glUniform1f(at("push"), static_cast<float>(1 + separation));
    glUniform3fv(at("tint"), 1, tint.data());
    for (const Mesh& mesh : meshes_) {
      mesh.array.bind();
      glDrawElements(GL_TRIANGLES, mesh.indexCount, GL_UNSIGNED_SHORT, nullptr);
    }
  }

  /// GL's defaults again, for whoever draws next.
  static void end() {
    gl::VertexArray::unbind();
    glUseProgram(0);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDepthFunc(GL_LESS);
    glClearDepth(1.0);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
  }

  Image picture() const { return readFramebuffer(camera_.widthPixels, camera_.heightPixels); }

 private:
  Terrain(const Camera& camera, double heightMeters) : camera_(camera), heightMeters_(heightMeters) {}
  GLint at(const char* uniform) const { return glGetUniformLocation(program_, uniform); }

  Camera camera_;
  double heightMeters_;
  ProgramHandle plain_, logarithmic_;
  GLuint program_ = 0;
  std::vector<Mesh> meshes_;
};

constexpr std::array<float, 3> kWhite{1, 1, 1}, kRed{1, 0, 0};

/// Of the pixels that show ground, how many show the farther surface, in percent. The farther one is drawn first: an
/// order of drawing that suits would hide all that the format cannot tell apart.
double wrongPercent(Terrain& terrain, const Format& format, const DepthTarget& target, double separation) {
  terrain.begin(format, target);
  terrain.draw(separation, kRed);
  terrain.draw(0, kWhite);
  const Image picture = terrain.picture();
  std::int64_t ground = 0, wrong = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
    ground += picture.rgb[i] > 0;
    wrong += picture.rgb[i] > 0 && picture.rgb[i + 1] == 0;
  }
  return 100 * static_cast<double>(wrong) / static_cast<double>(std::max<std::int64_t>(ground, 1));
}

/// One view: by format, and for errors by separation.
struct Outcome {
  std::array<double, kFormats.size()> timeMs{};
  std::array<std::vector<double>, kFormats.size()> wrongPercent;
};

struct Effort {
  int widthPixels, heightPixels, rounds;
  double errorPixels;  ///< of the tiles: how many there are
  std::vector<double> separations;
};

Result<Outcome> measure(const MoonView& view, const Effort& effort) {
  auto terrain = Terrain::create(view, effort.widthPixels, effort.heightPixels, effort.errorPixels);
  if (!terrain) return terrain.error();
  std::vector<DepthTarget> targets;
  for (const Format& format : kFormats) {
    auto target = DepthTarget::create(format.storage, effort.widthPixels, effort.heightPixels);
    if (!target) return target.error();
    targets.push_back(std::move(*target));
  }
  Outcome outcome;
  std::vector<Work> frames;
  for (std::size_t f = 0; f < kFormats.size(); ++f) {
    for (const double separation : effort.separations)
      outcome.wrongPercent[f].push_back(wrongPercent(*terrain, kFormats[f], targets[f], separation));
    frames.emplace_back([&terrain, &targets, f](std::size_t) {
      terrain->begin(kFormats[f], targets[f]);
      terrain->draw(0, kWhite);
      glFinish();
      return 0.0;
    });
  }
  const std::vector<double> times = nanosecondsPerItem(frames, 1, effort.rounds);
  for (std::size_t f = 0; f < kFormats.size(); ++f) outcome.timeMs[f] = times[f] * 1e-6;
  Terrain::end();
  return outcome;
}

std::vector<std::string> findings(const Outcome& high, const Outcome& low, const std::vector<double>& separations) {
  constexpr double kTold = 1e-5;
  const auto at = static_cast<std::size_t>(std::ranges::find(separations, kTold) - separations.begin());
  const auto wrong = [&](std::size_t format) {
    return fmt::format("{:.2g} % from 10 km and {:.2g} % from 2 m", high.wrongPercent[format][at],
                       low.wrongPercent[format][at]);
  };
  Span all, logarithmic;
  for (const Outcome* view : {&high, &low}) {
    for (std::size_t f = 0; f < kFormats.size(); ++f) {
      const double ratio = view->timeMs[f] / view->timeMs[kReversedFloat];
      if (f != kReversedFloat) all.include(ratio);
      if (kFormats[f].mapping == Mapping::Logarithmic) logarithmic.include(ratio);
    }
  }
  return {
      fmt::format("Where ground lies {:g} of the distance behind other ground, the one behind shows in so many of the "
                  "pixels: {} with 24 bits of ordinary depth, {} with a float in their place, {} with reversed float.",
                  kTold, wrong(kOrdinary24), wrong(kOrdinaryFloat), wrong(kReversedFloat)),
      fmt::format("A near plane that moves out with the camera, to a tenth of its height, makes that {} for 24 bits "
                  "of ordinary depth; all others keep it at {} m.",
                  wrong(kOrdinaryHeight24), kNearMeters),
      fmt::format("A frame takes {} times as long as with reversed float over all other formats, {} "
                  "times with logarithmic depth, for which the pixel shader must write every depth.",
                  all.text(), logarithmic.text())};
}

Report run(const Settings& settings, Progress& progress) {
  if (auto report = whyNotDrawn()) return *report;
  if (!gl::detectCapabilities().clipControl)
    return notRun(makeError(ErrorKind::Unsupported, "OpenGL", "this driver has no clip control (4.5)"));
  const Effort effort = settings.quick
                            ? Effort{240, 135, 3, 256, {1e-3, 1e-5}}
                            : Effort{960, 540, 7, SelectionSettings{}.errorPixels, {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}};
  std::vector<Outcome> views;
  for (const MoonView& view : {kMoonViews[1], kMoonViews[3]}) {
    auto outcome = measure(view, effort);
    if (!outcome) return notRun(outcome.error());
    views.push_back(std::move(*outcome));
    progress.at(0.5 * static_cast<double>(views.size()));
  }
  const Outcome &high = views[0], &low = views[1];

  Report report;
  report.columns = {{"format", "format"},
                    {"separationShare", "separation / distance"},
                    {"wrongPercentAt10km", "wrong pixels from 10 km, %"},
                    {"wrongPercentAt2m", "wrong pixels from 2 m, %"},
                    {"timeFrameMsAt10km", "time, ms a frame from 10 km"},
                    {"timeFrameMsAt2m", "time, ms a frame from 2 m"},
                    {"timeRatioToReversedFloat", "time / reversed float's, both views"}};
  for (std::size_t f = 0; f < kFormats.size(); ++f) {
    const double ratio = (high.timeMs[f] + low.timeMs[f]) / (high.timeMs[kReversedFloat] + low.timeMs[kReversedFloat]);
    for (std::size_t s = 0; s < effort.separations.size(); ++s)
      report.rows.push_back({std::string(kFormats[f].name), effort.separations[s], high.wrongPercent[f][s],
                             low.wrongPercent[f][s], high.timeMs[f], low.timeMs[f], ratio});
  }
  report.plots = {
      {"Wrong pixels over separation, from 10 km", "separationShare", "wrongPercentAt10km", "format", true, false},
      {"Wrong pixels over separation, from 2 m", "separationShare", "wrongPercentAt2m", "format", true, false}};
  report.findings = findings(high, low, effort.separations);
  report.findings.push_back(picturesText(effort.widthPixels, effort.heightPixels));
  return report;
}

const Registration kRegistered(
    {81, "depth-frame", "Depth formats at work",
     "What does a frame of terrain take with each depth format, and how often does a surface show that is behind?",
     run});

}  // namespace
}  // namespace terrane::accuracy
