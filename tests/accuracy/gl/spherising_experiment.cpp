// A sphere's vertices computed by the vertex shader from one base mesh, as against vertices that are stored: gnomonic
// cube faces, normalised and scaled in double-float by one Newton step of the inverse root.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/numerics/relative_position.h"
#include "common/tiling/lattice.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/placement/sample.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/support/double_float_operands.h"
#include "tests/support/vertex_run.h"

namespace terrane::accuracy {
namespace {

using gl::Component, gl::Conversion, gl::setUniform;
using test::HighPrecision;

constexpr double kRadiusMeters = 1737400.0;
constexpr int kCells = 64;

/// A tile on the face +X: (1, u, v) with u = -1 + 2 (x + i / 64) / 2^level, which 31 bits hold.
struct SphereTile {
  int level;
  double uLow, vLow, cell;
  glm::dvec3 camera;  ///< 2 m above the tile's middle
};

SphereTile tileAt(int level) {
  const double width = std::ldexp(2.0, -level);
  const double x = std::floor(0.31 * std::ldexp(1.0, level)), y = std::floor(0.77 * std::ldexp(1.0, level));
  SphereTile tile{level, -1 + x * width, -1 + y * width, width / kCells, {}};
  const double u = tile.uLow + width / 2, v = tile.vLow + width / 2, norm = std::sqrt(1 + u * u + v * v);
  tile.camera = glm::dvec3(1 / norm, u / norm, v / norm) * (kRadiusMeters + kDistanceMeters);
  return tile;
}

using Relative = std::array<HighPrecision, 3>;

Relative truth(const SphereTile& tile, int i, int j) {
  const HighPrecision u = HighPrecision(tile.uLow) + HighPrecision(tile.cell) * i;
  const HighPrecision v = HighPrecision(tile.vLow) + HighPrecision(tile.cell) * j;
  const HighPrecision scale = kRadiusMeters / sqrt(1 + u * u + v * v);
  return {scale - tile.camera.x, u * scale - tile.camera.y, v * scale - tile.camera.z};
}

struct Way {
  const char* name;
  int bytes;  ///< a tile's vertex
  const char* text;
};

constexpr const char* kInputs = "layout(location = 0) in uvec4 grid;\nout vec3 relative;\n";
constexpr std::array<Way, 4> kWays{{
    {"float32, from a base mesh", 0,
     "uniform vec2 low; uniform float cell, radius; uniform vec3 cameraHigh;\n"
     "void main() {\n"
     "  relative = normalize(vec3(1.0, low + vec2(grid.xy) * cell)) * radius - cameraHigh;\n"
     "  gl_Position = vec4(0.0);\n}\n"},
    {"double-float, from a base mesh", 0,
     "#include \"double_float.glsl\"\n#include \"double_float_scalar.glsl\"\n"
     "uniform vec2 low, lowRest; uniform float cell, radius, radiusRest; uniform vec3 cameraHigh, cameraLow;\n"
     "void main() {\n"
     "  DoubleFloat3 corner = DoubleFloat3(vec3(1.0, low), vec3(0.0, lowRest));\n"
     "  DoubleFloat3 direction = normalizePair(addFloat(corner, vec3(0.0, vec2(grid.xy) * cell)));\n"
     "  DoubleFloat3 position = scalePair(direction, DoubleFloat(radius, radiusRest));\n"
     "  relative = subtractPairToFloat(position, DoubleFloat3(cameraHigh, cameraLow));\n"
     "  gl_Position = vec4(0.0);\n}\n"},
    {"float64, from a base mesh", 0,
     "uniform vec2 low, lowRest; uniform float cell, radius, radiusRest; uniform vec3 cameraHigh, cameraLow;\n"
     "void main() {\n"
     "  dvec2 face = dvec2(low) + dvec2(lowRest) + dvec2(grid.xy) * double(cell);\n"
     "  dvec3 position = normalize(dvec3(1.0, face)) * (double(radius) + double(radiusRest));\n"
     "  relative = vec3(position - dvec3(cameraHigh) - dvec3(cameraLow));\n"
     "  gl_Position = vec4(0.0);\n}\n"},
    {"stored on the lattice (Terrane)", 8,
     "#include \"relative_position.glsl\"\n"
     "uniform ivec3 originMinusCamera; uniform vec3 cameraRest; uniform float stepMeters;\n"
     "void main() {\n"
     "  relative = relativeOnLattice(originMinusCamera, ivec3(grid.xyz), cameraRest, stepMeters);\n"
     "  gl_Position = vec4(0.0);\n}\n"},
}};
constexpr std::size_t kStored = 3;

void setUniforms(const gl::Program& program, const SphereTile& tile, const LatticePoint& origin, int exponent) {
  program.use();
  const DoubleFloat u = fromDouble(tile.uLow), v = fromDouble(tile.vLow), radius = fromDouble(kRadiusMeters);
  const DoubleFloat3 camera = fromDouble(tile.camera);
  setUniform(program.uniform("low"), glm::vec2(u.hi, v.hi));
  setUniform(program.uniform("lowRest"), glm::vec2(u.lo, v.lo));
  setUniform(program.uniform("cell"), static_cast<float>(tile.cell));
  setUniform(program.uniform("radius"), radius.hi);
  setUniform(program.uniform("radiusRest"), radius.lo);
  setUniform(program.uniform("cameraHigh"), camera.hi);
  setUniform(program.uniform("cameraLow"), camera.lo);
  const CameraOnLattice onLattice = cameraOnLattice(tile.camera, stepMeters(exponent));
  if (const auto difference = originMinusCamera(origin, onLattice.steps))
    setUniform(program.uniform("originMinusCamera"), *difference);
  setUniform(program.uniform("cameraRest"), onLattice.rest);
  setUniform(program.uniform("stepMeters"), static_cast<float>(stepMeters(exponent)));
}

using Grid = std::array<std::uint16_t, 4>;

/// What a server stores: positions in double, rounded to the level's lattice.
std::vector<Grid> storedVertices(const SphereTile& tile, int exponent, LatticePoint& origin) {
  std::vector<LatticePoint> points;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const double u = tile.uLow + tile.cell * i, v = tile.vLow + tile.cell * j, norm = std::sqrt(1 + u * u + v * v);
      points.push_back(roundToLattice(glm::dvec3(1 / norm, u / norm, v / norm) * kRadiusMeters, exponent));
    }
  }
  origin = points.front();
  for (const LatticePoint& point : points) origin = glm::min(origin, point);
  std::vector<Grid> stored;
  for (const LatticePoint& point : points) {
    const LatticePoint offset = point - origin;
    stored.push_back({static_cast<std::uint16_t>(offset.x), static_cast<std::uint16_t>(offset.y),
                      static_cast<std::uint16_t>(offset.z), 0});
  }
  return stored;
}

std::vector<Grid> baseMesh() {
  std::vector<Grid> grid;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i)
      grid.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), 0, 0});
  return grid;
}

double worstMeters(const SphereTile& tile, const std::vector<float>& placed) {
  double worst = 0;
  std::size_t k = 0;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i, k += 3) {
      const Relative exact = truth(tile, i, j);
      HighPrecision square = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const HighPrecision error = HighPrecision(placed[k + a]) - exact[a];
        square += error * error;
      }
      worst = std::max(worst, std::sqrt(static_cast<double>(square)));
    }
  }
  return worst;
}

/// A level is drawn where its cells are a few pixels large.
double pixels(const SphereTile& tile, double errorMeters) { return 5 * errorMeters / (kRadiusMeters * tile.cell); }

Result<std::vector<test::VertexRun>> programs() {
  std::vector<test::VertexRun> runs;
  for (const Way& way : kWays) {
    auto run = test::VertexRun::create(
        {.vertexText = std::string(kInputs) + way.text, .varyings = {"relative"}, .floatsPerVertex = 3});
    if (!run) return run.error();
    runs.push_back(std::move(*run));
  }
  return runs;
}

/// A picture's worth of base meshes, so that a run is long against what it costs to start one.
std::vector<double> times(std::vector<test::VertexRun>& runs, const Settings& settings,
                          const std::vector<gl::VertexAttribute>& layout) {
  std::vector<Grid> many;
  for (int tile = 0; tile < (settings.quick ? 2 : 16); ++tile)
    for (const Grid& vertex : baseMesh()) many.push_back(vertex);
  std::vector<Work> ways;
  for (test::VertexRun& run : runs) {
    run.setVertices(gl::bytesOf(many), sizeof(Grid), layout);
    ways.emplace_back([&run](std::size_t) {
      run.run();
      return 0.0;
    });
  }
  return nanosecondsPerItem(ways, many.size(), settings.quick ? 5 : 25);
}

Report run(const Settings& settings, Progress& progress) {
  if (auto nothing = whyNotDrawn()) return *nothing;
  auto runs = programs();
  if (!runs) return notRun(runs.error());
  const std::vector<gl::VertexAttribute> layout{{0, 4, Component::U16, Conversion::Integer, 0}};
  const std::vector<double> taken = times(*runs, settings, layout);
  Report report;
  report.columns = {{"level", "level"},
                    {"cellMeters", "cell, m"},
                    {"way", "vertices are"},
                    {"errorMeters", "worst error, m"},
                    {"errorPixels", "worst error, pixels where a cell is 5"},
                    {"bytes", "bytes a vertex of a tile"},
                    {"timeNsPerVertex", "time, ns a vertex"},
                    {"timeRatioToFloat32", "time / float32's"}};
  std::array<double, kWays.size()> worst{};
  constexpr int kFinest = 22;
  for (int level = 2; level <= kFinest; level += 4) {
    const SphereTile tile = tileAt(level);
    const int exponent = stepExponent(kRadiusMeters, level);
    LatticePoint origin(0);
    const std::vector<Grid> stored = storedVertices(tile, exponent, origin), base = baseMesh();
    for (std::size_t w = 0; w < kWays.size(); ++w) {
      test::VertexRun& one = (*runs)[w];
      one.setVertices(gl::bytesOf(w == kStored ? stored : base), sizeof(Grid), layout);
      setUniforms(one.program(), tile, origin, exponent);
      one.run();
      const double error = worstMeters(tile, one.results());
      if (level == kFinest) worst[w] = error;
      report.rows.push_back({std::int64_t{level}, kRadiusMeters * tile.cell, std::string(kWays[w].name), error,
                             pixels(tile, error), std::int64_t{kWays[w].bytes}, taken[w], taken[w] / taken[0]});
    }
    progress.at(static_cast<double>(level + 2) / (kFinest + 2));
  }
  report.plots = {{"Worst error over the size of a cell", "cellMeters", "errorMeters", "way"}};
  report.findings = {
      fmt::format(
          "At level {}, where a cell is {:.2g} m, float32 spherises to within {:.2g} m: no surface at all. "
          "Double-float with one Newton step is within {:.1g} m ({:.2g} pixels where a cell is 5) in {:.1f} times "
          "float32's time and no bytes at all.",
          kFinest, kRadiusMeters * tileAt(kFinest).cell, worst[0], worst[1], pixels(tileAt(kFinest), worst[1]),
          taken[1] / taken[0]),
      fmt::format("float64 in the shader is as exact, in {:.2f} times float32's time here, where the shader runs on a "
                  "CPU; on many GPUs float64 is a small fraction as fast.",
                  taken[2] / taken[0]),
      fmt::format(
          "A vertex that is stored on the level's lattice is off by up to half a step on each axis, {:.1g} m in "
          "all at that level, costs {:.2f} times float32's time, and may have any height: the sphere itself is "
          "all that a base mesh can give without the height of each vertex.",
          worst[kStored], taken[kStored] / taken[0])};
  return report;
}

const Registration kRegistered({18, "spherising", "Spherising in the vertex shader",
                                "One base mesh for all tiles, normalised by the shader: how round is the sphere?",
                                run});

}  // namespace
}  // namespace terrane::accuracy
