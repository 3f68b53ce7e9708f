// The shaders' forms of placing a vertex give the CPU's bits: they are one source, and the CPU's tests of their bounds
// hold for this GPU. Lengths and directions may differ by what roots may.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <random>

#include "common/numerics/double_float3.h"
#include "common/numerics/relative_position.h"
#include "tests/capture/gl_fixture.h"
#include "tests/support/vertex_run.h"

namespace terrane {
namespace {

constexpr const char* kShader = R"(#include "relative_position.glsl"
#include "double_float.glsl"
#include "double_float_scalar.glsl"

layout(location = 0) in ivec3 tile;
layout(location = 1) in ivec3 cameraTile;
layout(location = 2) in vec3 offset;
layout(location = 3) in vec3 cameraOffset;
layout(location = 4) in vec3 pairHi;
layout(location = 5) in vec3 pairLo;
out vec3 onLattice, morphed, onParent, byTilesAndOffsets, byHalves, directionHi, directionLo, lengthBoth;

void main() {
  onLattice = relativeOnLattice(tile, cameraTile, abs(cameraOffset) / 1048576.0, STEP_METERS);
  vec3 rest = abs(cameraOffset) / 1048576.0;
  ivec3 odd = (tile + cameraTile) & 1;
  morphed = relativeMorphed(tile, cameraTile, rest.x, true, rest, STEP_METERS, odd, 0.5 * (vec3(odd) + rest));
  onParent = relativeMorphed(tile, cameraTile, 1.0, true, rest, STEP_METERS, odd, 0.5 * (vec3(odd) + rest));
  byTilesAndOffsets = relativeByTilesAndOffsets(tile, offset, cameraTile, cameraOffset, 2097152.0);
  byHalves = relativeByHalves(tile, offset, cameraTile, cameraOffset, 2097152.0);
  DoubleFloat3 v = DoubleFloat3(pairHi, pairLo);
  DoubleFloat3 direction = normalizePair(v);
  DoubleFloat norm = lengthPair(v);
  directionHi = direction.hi;
  directionLo = direction.lo;
  lengthBoth = vec3(norm.hi, norm.lo, 0.0);
  gl_Position = vec4(0.0);
}
)";

struct Vertex {
  glm::ivec3 tile, cameraTile;
  glm::vec3 offset, cameraOffset, pairHi, pairLo;
};

std::vector<Vertex> makeVertices(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::printf("seed %u\n", seed);
  const auto integer = [&](int bits) { return static_cast<int>(random() >> (32 - bits)) - (1 << (bits - 1)); };
  std::uniform_real_distribution<float> offset(-1048576.0f, 1048576.0f);
  std::uniform_real_distribution<double> metres(-2e6, 2e6);
  std::vector<Vertex> vertices(20000);
  for (Vertex& v : vertices) {
    v.tile = {integer(24), integer(20), integer(3)};
    v.cameraTile = {v.tile.x + integer(2), integer(16), integer(3)};
    v.offset = {offset(random), offset(random), offset(random)};
    v.cameraOffset = {offset(random), offset(random), offset(random)};
    const DoubleFloat3 pair = fromDouble(glm::dvec3(metres(random), metres(random), metres(random)));
    v.pairHi = pair.hi;
    v.pairLo = pair.lo;
  }
  return vertices;
}

std::size_t differing(const glm::vec3& a, const float* b) {
  std::size_t count = 0;
  for (int axis = 0; axis < 3; ++axis)
    count += std::bit_cast<std::uint32_t>(a[axis]) == std::bit_cast<std::uint32_t>(b[axis]) ? 0u : 1u;
  return count;
}

class RelativePositionShader : public GlTest {};

TEST_F(RelativePositionShader, GivesTheCpusBits) {
  constexpr float kStep = 0.0078125f;
  auto run = test::VertexRun::create({.vertexText = kShader,
                                      .defines = {"STEP_METERS 0.0078125"},
                                      .varyings = {"onLattice", "morphed", "onParent", "byTilesAndOffsets", "byHalves",
                                                   "directionHi", "directionLo", "lengthBoth"},
                                      .floatsPerVertex = 24});
  ASSERT_TRUE(run) << run.error().text();
  const std::vector<Vertex> vertices = makeVertices(421);
  using gl::Component, gl::Conversion;
  const std::array attributes{
      gl::VertexAttribute{0, 3, Component::I32, Conversion::Integer, offsetof(Vertex, tile)},
      gl::VertexAttribute{1, 3, Component::I32, Conversion::Integer, offsetof(Vertex, cameraTile)},
      gl::VertexAttribute{2, 3, Component::F32, Conversion::Float, offsetof(Vertex, offset)},
      gl::VertexAttribute{3, 3, Component::F32, Conversion::Float, offsetof(Vertex, cameraOffset)},
      gl::VertexAttribute{4, 3, Component::F32, Conversion::Float, offsetof(Vertex, pairHi)},
      gl::VertexAttribute{5, 3, Component::F32, Conversion::Float, offsetof(Vertex, pairLo)}};
  run->setVertices(gl::bytesOf(vertices), sizeof(Vertex), attributes);
  run->run();
  const std::vector<float> out = run->results();
  std::size_t lattice = 0, morphed = 0, tiles = 0, halves = 0, directions = 0, lengths = 0;
  double worstDirection = 0, worstLength = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vertex& v = vertices[i];
    const float* result = &out[24 * i];
    const glm::vec3 rest = glm::abs(v.cameraOffset) / 1048576.0f;
    const glm::ivec3 odd = (v.tile + v.cameraTile) & 1;
    const glm::vec3 parentRest = 0.5f * (glm::vec3(odd) + rest);
    lattice += differing(relativeOnLattice(v.tile, v.cameraTile, rest, kStep), result);
    morphed += differing(relativeMorphed(v.tile, v.cameraTile, rest.x, true, rest, kStep, odd, parentRest), result + 3);
    morphed += differing(relativeMorphed(v.tile, v.cameraTile, 1, true, rest, kStep, odd, parentRest), result + 6);
    tiles += differing(relativeByTilesAndOffsets(v.tile, v.offset, v.cameraTile, v.cameraOffset, 0x1p21f), result + 9);
    halves += differing(relativeByHalves(v.tile, v.offset, v.cameraTile, v.cameraOffset, 0x1p21f), result + 12);
    const DoubleFloat3 pair{v.pairHi, v.pairLo}, direction = normalize(pair);
    const DoubleFloat norm = length(pair);
    directions += differing(direction.hi, result + 15) + differing(direction.lo, result + 18);
    lengths += differing({norm.hi, norm.lo, 0}, result + 21);
    worstLength =
        std::max(worstLength,
                 std::fabs((static_cast<double>(result[21]) + static_cast<double>(result[22])) / toDouble(norm) - 1));
    for (int axis = 0; axis < 3; ++axis)
      worstDirection =
          std::max(worstDirection, std::fabs(toDouble(direction)[axis] - static_cast<double>(result[15 + axis]) -
                                             static_cast<double>(result[18 + axis])));
  }
  std::printf("of %zu vertices differ: directions %zu (by at most %.2g u^2), lengths %zu\n", vertices.size(),
              directions, worstDirection / kFloatUnitSquared, lengths);
  EXPECT_EQ(lattice, 0u);
  EXPECT_EQ(morphed, 0u);
  EXPECT_EQ(tiles, 0u);
  EXPECT_EQ(halves, 0u);
  EXPECT_LE(worstLength, (kLengthBound + 5.5 + 110) * kFloatUnitSquared) << "the root's bound in a shader";
  // Roots are only promised to 2 units in the last place: the last bits of a pair may differ.
  EXPECT_LE(worstDirection, (kNormalizeBound + kNormalizeShaderBound) * kFloatUnitSquared);
}

}  // namespace
}  // namespace terrane
