#include "tests/accuracy/gl/shader_scheme.h"

#include <algorithm>
#include <bit>

#include "common/numerics/relative_position.h"

namespace terrane::accuracy {
namespace {

using gl::Component, gl::Conversion, gl::setUniform;

constexpr gl::VertexAttribute floats(unsigned location, std::size_t offset) {
  return {location, 3, Component::F32, Conversion::Float, offset};
}
constexpr gl::VertexAttribute integers(unsigned location, int components, Component type, std::size_t offset) {
  return {location, components, type, Conversion::Integer, offset};
}

void setCameraPair(const gl::Program& program, const Sample& sample) { setPair(program, "camera", sample.camera); }

constexpr const char* kPairInputs =
    "#include \"double_float.glsl\"\n"
    "layout(location = 0) in vec3 high;\nlayout(location = 1) in vec3 low;\n"
    "uniform vec3 cameraHigh, cameraLow;\n";

ShaderScheme pairScheme(std::string_view name, std::string expression) {
  return {name,
          24,
          0,
          kPairInputs,
          std::move(expression),
          24,
          {floats(0, 0), floats(1, 12)},
          eachVertex([](const FinePoint& vertex, const Sample&) { return pairsOf(vertex); }),
          setCameraPair};
}

ShaderScheme tileScheme(std::string_view name, std::string function) {
  return {name,
          24,
          0,
          "#include \"relative_position.glsl\"\n"
          "layout(location = 0) in ivec3 tile;\nlayout(location = 1) in vec3 offset;\n"
          "uniform ivec3 cameraTile;\nuniform vec3 cameraOffset;\n",
          function + "(tile, offset, cameraTile, cameraOffset, 2048.0)",
          24,
          {integers(0, 3, Component::I32, 0), floats(1, 12)},
          eachVertex([](const FinePoint& vertex, const Sample&) { return tiledOf(vertex); }),
          [](const gl::Program& program, const Sample& sample) {
            const TiledPosition camera = tiledOf(sample.camera);
            setUniform(program.uniform("cameraTile"), camera.tile);
            setUniform(program.uniform("cameraOffset"), camera.offsetMeters);
          }};
}

std::vector<std::byte> latticeVertices(const Sample& sample) {
  const OnLattice lattice = latticeOf(sample);
  const auto bytes = gl::bytesOf(lattice.offsets);
  return {bytes.begin(), bytes.end()};
}

ShaderScheme latticeScheme() {
  return {kLattice,
          8,
          0,
          "#include \"relative_position.glsl\"\n"
          "layout(location = 0) in uvec4 offset;\nuniform ivec3 originMinusCamera;\nuniform vec3 cameraRest;\n"
          "uniform float stepMeters;\n",
          "relativeOnLattice(originMinusCamera, ivec3(offset.xyz), cameraRest, stepMeters)",
          8,
          {integers(0, 4, Component::U16, 0)},
          latticeVertices,
          [](const gl::Program& program, const Sample& sample) {
            const OnLattice lattice = latticeOf(sample);
            setUniform(program.uniform("originMinusCamera"), lattice.originMinusCamera);
            setUniform(program.uniform("cameraRest"), lattice.cameraRest);
            setUniform(program.uniform("stepMeters"), static_cast<float>(kLatticeMeters));
          }};
}

ShaderScheme latticePairScheme() {
  return {kLatticePairs,
          8,
          0,
          "#include \"double_float.glsl\"\nlayout(location = 0) in uvec4 offset;\n"
          "uniform vec3 originHigh, originLow, cameraHigh, cameraLow;\nuniform float stepMeters;\n",
          "subtractPairToFloat(addFloat(DoubleFloat3(originHigh, originLow), vec3(offset.xyz) * stepMeters), "
          "DoubleFloat3(cameraHigh, cameraLow))",
          8,
          {integers(0, 4, Component::U16, 0)},
          latticeVertices,
          [](const gl::Program& program, const Sample& sample) {
            UnitPoint origin = latticeOf(sample).origin;
            for (Units& coordinate : origin) coordinate *= kLatticeUnits;
            setPair(program, "origin", {origin, glm::dvec3(0.0)});
            setCameraPair(program, sample);
            setUniform(program.uniform("stepMeters"), static_cast<float>(kLatticeMeters));
          }};
}

/// Doubles travel as the pairs of integers that they are made of, on the camera's side too.
ShaderScheme doubleScheme() {
  return {kFloat64,
          24,
          0,
          "layout(location = 0) in uvec2 x;\nlayout(location = 1) in uvec2 y;\nlayout(location = 2) in uvec2 z;\n"
          "uniform ivec3 cameraFirst, cameraSecond;\n"
          "dvec3 camera() {\n"
          "  return dvec3(packDouble2x32(uvec2(cameraFirst.x, cameraSecond.x)),\n"
          "               packDouble2x32(uvec2(cameraFirst.y, cameraSecond.y)),\n"
          "               packDouble2x32(uvec2(cameraFirst.z, cameraSecond.z)));\n}\n",
          "vec3(dvec3(packDouble2x32(x), packDouble2x32(y), packDouble2x32(z)) - camera())",
          24,
          {integers(0, 2, Component::I32, 0), integers(1, 2, Component::I32, 8), integers(2, 2, Component::I32, 16)},
          eachVertex([](const FinePoint& vertex, const Sample&) { return doublesOf(vertex); }),
          [](const gl::Program& program, const Sample& sample) {
            const glm::dvec3 camera = doublesOf(sample.camera);
            glm::ivec3 first, second;
            for (int axis = 0; axis < 3; ++axis) {
              const auto bits = std::bit_cast<std::uint64_t>(camera[axis]);
              first[axis] = static_cast<std::int32_t>(bits);
              second[axis] = static_cast<std::int32_t>(bits >> 32);
            }
            setUniform(program.uniform("cameraFirst"), first);
            setUniform(program.uniform("cameraSecond"), second);
          }};
}

ShaderScheme floatScheme(std::string_view name, int uploaded, std::string expression, bool relative) {
  return {name,
          uploaded > 0 ? 24 : 12,
          uploaded,
          "layout(location = 0) in vec3 position;\nuniform vec3 camera;\n",
          std::move(expression),
          12,
          {floats(0, 0)},
          eachVertex([relative](const FinePoint& vertex, const Sample& sample) {
            return relative ? cameraRelative(doublesOf(vertex), doublesOf(sample.camera)) : floatsOf(vertex);
          }),
          [](const gl::Program& program, const Sample& sample) {
            setUniform(program.uniform("camera"), floatsOf(sample.camera));
          }};
}

}  // namespace

void setPair(const gl::Program& program, const std::string& name, const FinePoint& point) {
  const DoubleFloat3 pair = pairsOf(point);
  setUniform(program.uniform((name + "High").c_str()), pair.hi);
  setUniform(program.uniform((name + "Low").c_str()), pair.lo);
}

const std::vector<ShaderScheme>& shaderSchemes() {
  static const std::vector<ShaderScheme> all{
      floatScheme(kPassedThrough, 0, "position", true),
      floatScheme(kCameraRelative, 12, "position", true),
      floatScheme(kFloat32, 0, "position - camera", false),
      tileScheme(kTiles, "relativeByTilesAndOffsets"),
      tileScheme(kTilesByHalves, "relativeByHalves"),
      {kSplit,
       24,
       0,
       kPairInputs,
       "subtractWordsToFloat(DoubleFloat3(high, low), DoubleFloat3(cameraHigh, cameraLow))",
       24,
       {floats(0, 0), floats(1, 12)},
       eachVertex([](const FinePoint& vertex, const Sample&) { return splitOf(vertex); }),
       [](const gl::Program& program, const Sample& sample) {
         const DoubleFloat3 split = splitOf(sample.camera);
         setUniform(program.uniform("cameraHigh"), split.hi);
         setUniform(program.uniform("cameraLow"), split.lo);
       }},
      pairScheme(kWords, "subtractWordsToFloat(DoubleFloat3(high, low), DoubleFloat3(cameraHigh, cameraLow))"),
      pairScheme(kDemoted, "subtractPairToFloat(DoubleFloat3(high, low), DoubleFloat3(cameraHigh, cameraLow))"),
      pairScheme(kPairs, "addPair(DoubleFloat3(high, low), DoubleFloat3(-cameraHigh, -cameraLow)).hi"),
      latticeScheme(),
      latticePairScheme(),
      doubleScheme(),
  };
  return all;
}

Result<test::VertexRun> prepare(const ShaderScheme& scheme, const Sample& sample) {
  const std::string text = scheme.declarations +
                           "out vec3 relative;\nvoid main() {\n  relative = " + scheme.expression +
                           ";\n  gl_Position = vec4(0.0);\n}\n";
  auto run = test::VertexRun::create({.vertexText = text, .varyings = {"relative"}, .floatsPerVertex = 3});
  if (!run) return run;
  run->setVertices(scheme.vertices(sample), scheme.stride, scheme.attributes);
  run->program().use();
  scheme.setUniforms(run->program(), sample);
  return run;
}

Result<std::vector<Prepared>> prepareAll(const std::vector<ShaderScheme>& schemes, const Sample& sample) {
  std::vector<Prepared> all;
  for (const ShaderScheme& scheme : schemes) {
    auto run = prepare(scheme, sample);
    if (!run) return run.error();
    all.push_back({&scheme, std::move(*run)});
  }
  return all;
}

void load(Prepared& prepared, const Sample& sample) {
  const ShaderScheme& scheme = *prepared.scheme;
  prepared.run.setVertices(scheme.vertices(sample), scheme.stride, scheme.attributes);
  prepared.run.program().use();
  scheme.setUniforms(prepared.run.program(), sample);
}

std::vector<double> nanosecondsPerVertex(std::vector<Prepared>& all, const Sample& sample, int rounds) {
  std::vector<glm::dvec3> positions;
  for (const UnitPoint& vertex : sample.vertices) positions.push_back(doublesOf({vertex, glm::dvec3(0.0)}));
  std::vector<glm::vec3> relative(positions.size());
  const glm::dvec3 camera = doublesOf(sample.camera);
  std::vector<Work> ways;
  for (Prepared& one : all) {
    ways.emplace_back([&](std::size_t) {
      if (one.scheme->uploadedBytesPerVertex > 0) {
        for (std::size_t i = 0; i < positions.size(); ++i) relative[i] = cameraRelative(positions[i], camera);
        one.run.replaceVertices(gl::bytesOf(relative));
      }
      one.run.run();
      return 0.0;
    });
  }
  return nanosecondsPerItem(ways, sample.vertices.size(), rounds);
}

double worstMeters(const Sample& sample, const test::VertexRun& run) {
  const std::vector<float> placed = run.results();
  double worst = 0;
  for (std::size_t i = 0; i < sample.vertices.size(); ++i)
    worst = std::max(
        worst, errorMeters({placed[3 * i], placed[3 * i + 1], placed[3 * i + 2]}, sample.vertices[i], sample.camera));
  return worst;
}

}  // namespace terrane::accuracy
