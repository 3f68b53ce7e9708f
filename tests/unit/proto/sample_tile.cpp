#include "tests/unit/proto/sample_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numeric>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/triangle_tile.h"

namespace terrane::test {
namespace {

std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ seed * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return h ^ (h >> 15);
}

/// Value noise in [-1, 1] at a period of 2^shift grid cells of 1/1024 of the tile.
double valueNoise(std::uint32_t x, std::uint32_t y, std::uint32_t shift, std::uint32_t seed) {
  const auto corner = [&](std::uint32_t i, std::uint32_t j) {
    return hash((x >> shift) + i, (y >> shift) + j, seed + shift) * 0x1p-31 - 1.0;
  };
  const double size = static_cast<double>(1u << shift);
  const double fx = (x & ((1u << shift) - 1)) / size, fy = (y & ((1u << shift) - 1)) / size;
  const double sx = fx * fx * (3 - 2 * fx), sy = fy * fy * (3 - 2 * fy);
  return std::lerp(std::lerp(corner(0, 0), corner(1, 0), sx), std::lerp(corner(0, 1), corner(1, 1), sx), sy);
}

class Sampler {
 public:
  explicit Sampler(const SampleSettings& settings)
      : settings_(settings),
        width_(nominalTileWidthMeters(settings.radiusMeters, settings.path.level(), settings.path.scheme())) {}

  double height(int i, int j) const {
    const auto unit = static_cast<std::uint32_t>(1024 / settings_.cellsPerEdge);
    const auto x = static_cast<std::uint32_t>(i + 4) * unit, y = static_cast<std::uint32_t>(j + 4) * unit;
    double sum = 0, amplitude = 0.5;
    for (std::uint32_t shift = 9; shift >= 3; --shift, amplitude *= 0.5)
      sum += amplitude * valueNoise(x, y, shift, settings_.seed);
    return sum * settings_.roughness * width_;
  }

  /// Grid points beyond the tile's edge too, for normals.
  glm::dvec3 position(int i, int j) const { return direction(i, j) * (settings_.radiusMeters + height(i, j)); }

  /// Of a triangular tile simply upwards: its grid ends at its edges.
  glm::dvec3 normal(int i, int j) const {
    if (settings_.path.scheme() == Scheme::Ico) return direction(i, j);
    return glm::normalize(glm::cross(position(i + 1, j) - position(i - 1, j), position(i, j + 1) - position(i, j - 1)));
  }

 private:
  glm::dvec3 direction(int i, int j) const {
    if (settings_.path.scheme() == Scheme::Ico) {
      const int gridLevel = settings_.path.level() + std::countr_zero(static_cast<unsigned>(settings_.cellsPerEdge));
      return icoGridDirection(kIcoMap, settings_.path.face(), gridLevel,
                              gridVertexWeights(triangleTile(settings_.path), settings_.cellsPerEdge, {i, j}));
    }
    const double cells = settings_.cellsPerEdge * std::exp2(settings_.path.level());
    const double s = 2 * (settings_.path.column() * static_cast<double>(settings_.cellsPerEdge) + i) / cells - 1;
    const double t = 2 * (settings_.path.row() * static_cast<double>(settings_.cellsPerEdge) + j) / cells - 1;
    return cubeDirection(settings_.path.face(), s, t);
  }

  SampleSettings settings_;
  double width_;
};

class MeshBuilder {
 public:
  void add(const glm::dvec3& position, const glm::dvec3& normal, std::uint8_t shade, int stepExponentOfTile) {
    points_.push_back(roundToLattice(position, stepExponentOfTile));
    for (int axis = 0; axis < 3; ++axis) mesh_.normals.push_back(static_cast<float>(normal[axis]));
    mesh_.colors.insert(mesh_.colors.end(),
                        {shade, static_cast<std::uint8_t>(shade * 7 / 8), static_cast<std::uint8_t>(shade / 2)});
    mesh_.gridIndices.push_back(static_cast<std::uint16_t>(mesh_.gridIndices.size()));
  }
  void triangle(int a, int b, int c) {
    for (const int index : {a, b, c}) mesh_.triangles.push_back(static_cast<std::uint32_t>(index));
  }
  void quad(int a, int b, int c, int d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  LatticePoint takeOrigin() {
    LatticePoint origin = points_.front();
    for (const LatticePoint& p : points_)
      for (int axis = 0; axis < 3; ++axis) origin[axis] = std::min(origin[axis], p[axis]);
    for (const LatticePoint& p : points_)
      for (int axis = 0; axis < 3; ++axis) mesh_.offsets.push_back(static_cast<std::uint16_t>(p[axis] - origin[axis]));
    return origin;
  }
  TileMesh take() { return std::move(mesh_); }

 private:
  std::vector<LatticePoint> points_;
  TileMesh mesh_;
};

/// Adds a vertex at grid place (i, j), so far below the ground.
using AddVertex = std::function<void(int i, int j, double dropMeters)>;

void addSquare(MeshBuilder& builder, const AddVertex& add, int cells, double skirtMeters) {
  const int edge = cells + 1;
  for (int j = 0; j < edge; ++j)
    for (int i = 0; i < edge; ++i) add(i, j, 0);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = j * edge + i;
      builder.quad(a, a + 1, a + 1 + edge, a + edge);
    }
  if (skirtMeters == 0) return;
  const std::array starts{glm::ivec2(0, 0), glm::ivec2(cells, 0), glm::ivec2(cells, cells), glm::ivec2(0, cells)};
  const std::array steps{glm::ivec2(1, 0), glm::ivec2(0, 1), glm::ivec2(-1, 0), glm::ivec2(0, -1)};
  for (std::size_t side = 0; side < 4; ++side)
    for (int k = 0; k < edge; ++k) {
      const glm::ivec2 at = starts[side] + k * steps[side];
      add(at.x, at.y, skirtMeters);
      if (k == 0) continue;
      const glm::ivec2 before = at - steps[side];
      const int lower = edge * edge + static_cast<int>(side) * edge + k;
      builder.quad(before.y * edge + before.x, lower - 1, lower, at.y * edge + at.x);
    }
}

void addTriangle(MeshBuilder& builder, const AddVertex& add, int cells, double skirtMeters) {
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i + j <= cells; ++i) add(i, j, 0);
  const auto index = [&](int i, int j) { return triangleGridIndex(cells, {i, j}); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i + j < cells; ++i) {
      builder.triangle(index(i, j), index(i + 1, j), index(i, j + 1));
      if (i + j + 1 < cells) builder.triangle(index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
    }
  if (skirtMeters == 0) return;
  for (int edge = 0; edge < 3; ++edge)
    for (int k = 0; k <= cells; ++k) {
      const GridVertex at = edgeVertex(cells, edge, k);
      add(at.i, at.j, skirtMeters);
      if (k == 0) continue;
      const GridVertex before = edgeVertex(cells, edge, k - 1);
      const int lower = triangleGridSize(cells) + edge * (cells + 1) + k;
      builder.quad(index(before.i, before.j), lower - 1, lower, index(at.i, at.j));
    }
}

}  // namespace

Tile sampleTile(const SampleSettings& settings) {
  const Sampler sampler(settings);
  const int cells = settings.cellsPerEdge;
  const Scheme scheme = settings.path.scheme();
  const double width = nominalTileWidthMeters(settings.radiusMeters, settings.path.level(), scheme);
  Tile tile;
  TileMetadata& m = tile.metadata;
  m.path = settings.path;
  m.stepExponent = stepExponent(settings.radiusMeters, settings.path.level(), scheme);
  m.cellsPerEdge = cells;
  m.skirtMeters = settings.skirts ? static_cast<float>(0.01 * width) : 0.0f;
  m.heights = {-settings.roughness * width, settings.roughness * width};
  m.subtreeHeights = {1.25 * m.heights.minMeters, 1.25 * m.heights.maxMeters};
  m.geometricErrorMeters = width / 3000;
  m.sphere = {sampler.position(cells / 2, cells / 2), width};
  m.horizonPoint = 1.01 * m.sphere.center;

  MeshBuilder builder;
  const auto add = [&](int i, int j, double drop) {
    const glm::dvec3 top = sampler.position(i, j);
    const double lift = sampler.height(i, j) / (settings.roughness * width);
    const auto shade = static_cast<std::uint8_t>(std::clamp(128 + 100 * lift, 0.0, 255.0));
    builder.add(top - drop * glm::normalize(top), sampler.normal(i, j), shade, m.stepExponent);
  };
  (scheme == Scheme::Cube ? addSquare : addTriangle)(builder, add, cells, m.skirtMeters);
  m.origin = builder.takeOrigin();
  tile.mesh = builder.take();
  if (!settings.colors) tile.mesh.colors.clear();
  return tile;
}

namespace {

using Triangle = std::array<std::uint16_t, 3>;

/// Triangles as grid indices, each begun at its lowest, sorted.
std::vector<Triangle> canonicalTriangles(const TileMesh& mesh) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    Triangle t{mesh.gridIndices[mesh.triangles[i]], mesh.gridIndices[mesh.triangles[i + 1]],
               mesh.gridIndices[mesh.triangles[i + 2]]};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    triangles.push_back(t);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<std::size_t> orderByGridIndex(const TileMesh& mesh) {
  std::vector<std::size_t> order(mesh.vertexCount());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return mesh.gridIndices[a] < mesh.gridIndices[b]; });
  return order;
}

/// Equal bits, or both not a number.
bool same(double a, double b) { return (std::isnan(a) && std::isnan(b)) || (a == b); }
bool same(const glm::dvec3& a, const glm::dvec3& b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

}  // namespace

bool sameMesh(const TileMesh& expected, const TileMesh& actual, double normalTolerance) {
  if (expected.vertexCount() != actual.vertexCount() || expected.colors.size() != actual.colors.size()) return false;
  const auto order = orderByGridIndex(expected), found = orderByGridIndex(actual);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t a = order[k], b = found[k];
    if (expected.gridIndices[a] != actual.gridIndices[b]) return false;
    double difference = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      if (expected.offsets[3 * a + c] != actual.offsets[3 * b + c]) return false;
      if (!expected.colors.empty() && expected.colors[3 * a + c] != actual.colors[3 * b + c]) return false;
      const double d =
          static_cast<double>(expected.normals[3 * a + c]) - static_cast<double>(actual.normals[3 * b + c]);
      difference += d * d;
    }
    if (!(difference <= normalTolerance * normalTolerance)) return false;
  }
  return canonicalTriangles(expected) == canonicalTriangles(actual);
}

bool sameMetadata(const TileMetadata& a, const TileMetadata& b) {
  return a.path == b.path && a.stepExponent == b.stepExponent && a.origin == b.origin &&
         same(a.heights.minMeters, b.heights.minMeters) && same(a.heights.maxMeters, b.heights.maxMeters) &&
         same(a.subtreeHeights.minMeters, b.subtreeHeights.minMeters) &&
         same(a.subtreeHeights.maxMeters, b.subtreeHeights.maxMeters) &&
         same(a.geometricErrorMeters, b.geometricErrorMeters) && same(a.sphere.center, b.sphere.center) &&
         same(a.sphere.radiusMeters, b.sphere.radiusMeters) && same(a.horizonPoint, b.horizonPoint) &&
         a.cellsPerEdge == b.cellsPerEdge && a.skirtMeters == b.skirtMeters;
}

}  // namespace terrane::test
