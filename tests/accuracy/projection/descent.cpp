#include "tests/accuracy/projection/descent.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "proto/gltf_tile.h"
#include "proto/resident_tile.h"
#include "tests/support/require.h"
#include "tests/support/tile_source.h"

namespace terrane::accuracy {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHeightStep = 3.07;  // 2^1.618
constexpr double kHeading = 0.4;
constexpr double kSteepest = -kPi / 2, kFlattest = -kPi / 12;

std::uint64_t halvesBelow(double coordinate, int level) {
  const double cells = std::ldexp(1.0, level);
  return static_cast<std::uint64_t>(std::clamp(std::floor(0.5 * (coordinate + 1) * cells), 0.0, cells - 1));
}

/// The grid vertices of the triangle that holds a direction, for a cell of a cube tile cut from (0, 0) to (1, 1).
std::array<std::size_t, 3> cubeTriangle(const FacePath& tile, const FacePath& cell, int cells,
                                        const glm::dvec3& direction) {
  const auto i = cell.column() - tile.column() * static_cast<std::uint32_t>(cells);
  const auto j = cell.row() - tile.row() * static_cast<std::uint32_t>(cells);
  const auto side = static_cast<std::size_t>(cells) + 1;
  const std::size_t first = j * side + i, diagonal = first + side + 1;
  const glm::dvec3 from = cubeGridDirection(cell.face(), cell.level(), cell.column(), cell.row());
  const glm::dvec3 to = cubeGridDirection(cell.face(), cell.level(), cell.column() + 1, cell.row() + 1);
  const bool left = glm::dot(glm::cross(to - from, direction - from), from) > 0;
  return {first, diagonal, left ? first + side : first + 1};
}

std::array<std::size_t, 3> icoTriangle(const FacePath& tile, const FacePath& cell, int cells) {
  std::array<std::size_t, 3> vertices{};
  const auto corners = tileCorners(triangleTile(cell));
  for (std::size_t k = 0; k < corners.size(); ++k)
    vertices[k] =
        static_cast<std::size_t>(triangleGridIndex(cells, gridVertexAt(triangleTile(tile), cells, corners[k]).value()));
  return vertices;
}

}  // namespace

std::vector<Place> descentPlaces(std::uint64_t seed, int atRandom) {
  std::vector<Place> places{{"cube: middle of a face", glm::dvec3(1, 0, 0)},
                            {"icosahedron: a vertex", icosahedronVertex(0)},
                            {"cube: a corner", glm::normalize(glm::dvec3(1, 1, 1))},
                            {"cube: middle of an edge", glm::normalize(glm::dvec3(1, 1, 0))}};
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random() >> 11), -53);
  };
  for (int n = 0; n < atRandom; ++n) {
    const double z = between(-1, 1), longitude = between(-kPi, kPi), ring = std::sqrt(1 - z * z);
    places.push_back({"random " + std::to_string(n + 1), {ring * std::cos(longitude), ring * std::sin(longitude), z}});
  }
  return places;
}

std::vector<Camera> descentCameras(const Place& place, const HeightField& moon, double radiusMeters, std::size_t count,
                                   int widthPixels, int heightPixels) {
  const glm::dvec3& d = place.direction;
  SurfaceSamples samples;
  moon.evaluate({&d.x, &d.y, &d.z, 1, 1}, kFinestWavelengthMeters, samples);
  std::vector<Camera> cameras;
  for (std::size_t n = 0; n < count; ++n) {
    const double steps = static_cast<double>(n) * static_cast<double>(kDescentCameras - 1) /
                         static_cast<double>(std::max<std::size_t>(count - 1, 1));
    const double share = steps / (kDescentCameras - 1);
    const double pitch = kFlattest + share * (kSteepest - kFlattest);
    cameras.push_back(
        cameraFromPose({std::atan2(d.y, d.x), std::asin(d.z),
                        samples.heightMeters.front() + kLowestMeters * std::pow(kHeightStep, steps), kHeading, pitch},
                       radiusMeters, 0.9, widthPixels, heightPixels));
  }
  return cameras;
}

Amounts& Amounts::operator+=(const Amounts& other) {
  tiles += other.tiles;
  vertices += other.vertices;
  triangles += other.triangles;
  bytes += other.bytes;
  dracoBytes += other.dracoBytes;
  return *this;
}

FacePath tileAt(Scheme scheme, const glm::dvec3& direction, int level) {
  if (scheme == Scheme::Ico) return icoTileAt(kIcoMap, direction, level);
  const FaceCoordinates at = cubeFaceCoordinates(direction);
  return FacePath::cubeTile(at.face, level, static_cast<std::uint32_t>(halvesBelow(at.s, level)),
                            static_cast<std::uint32_t>(halvesBelow(at.t, level)));
}

double meshRadiusMeters(const FacePath& path, const MeshedTile& tile, int cellsPerEdge, const glm::dvec3& direction) {
  const int cellLevel = path.level() + std::countr_zero(static_cast<unsigned>(cellsPerEdge));
  if (cellLevel > FacePath::kMaxLevel) throw std::runtime_error(path.text() + " has cells too fine to be looked for");
  const FacePath cell = tileAt(path.scheme(), direction, cellLevel);
  const auto vertices = path.scheme() == Scheme::Cube ? cubeTriangle(path, cell, cellsPerEdge, direction)
                                                      : icoTriangle(path, cell, cellsPerEdge);
  const auto inSteps = [&](std::size_t k) {
    const std::uint16_t* offset = &tile.offsets[3 * vertices[k]];
    return glm::dvec3(tile.origin + LatticePoint(offset[0], offset[1], offset[2]));
  };
  const glm::dvec3 a = inSteps(0), normal = glm::cross(inSteps(1) - a, inSteps(2) - a);
  return glm::dot(normal, a) / glm::dot(normal, direction) * stepMeters(tile.stepExponent);
}

DescentTiles::DescentTiles(const std::string& sceneName)
    : builder_(shippedScene(sceneName).body, WireSettings{}, bestSimdPath()),
      draco_(require(DracoTemplate::learn(require(builder_.buildMesh(FacePath::wholeFace(scheme(), 0))).mesh,
                                          WireSettings{}.draco))) {}

const MeshedTile& DescentTiles::tile(const FacePath& path) {
  const auto [found, isNew] = tiles_.try_emplace(path);
  MeshedTile& kept = found->second;
  if (!isNew) return kept;
  Tile tile = require(builder_.buildMesh(path));
  const DracoBuffer draco = require(draco_->encode(tile.mesh));
  kept.stepExponent = tile.metadata.stepExponent;
  kept.origin = tile.metadata.origin;
  kept.resident = residentTile(tile, builder_.body().radiusMeters);
  kept.amounts = {1, static_cast<std::int64_t>(draco.vertexCount), static_cast<std::int64_t>(draco.triangleCount),
                  static_cast<std::int64_t>(require(writeTileGlb(tile.metadata, tile.mesh, draco)).size()),
                  static_cast<std::int64_t>(draco.bytes.size())};
  kept.offsets = std::move(tile.mesh.offsets);
  return kept;
}

TileSelection DescentTiles::settle(const Camera& camera, double errorPixels) {
  const ResidentLookup lookup = [this](const FacePath& path) -> const ResidentTile* {
    const auto found = tiles_.find(path);
    return found == tiles_.end() ? nullptr : &found->second.resident;
  };
  for (;;) {
    TileSelection selected = selectTiles(camera, builder_.info().selection, lookup, {.errorPixels = errorPixels});
    if (selected.complete) return selected;
    const std::size_t before = tiles_.size();
    for (const WantedTile& wanted : selected.wanted) tile(wanted.path);
    if (tiles_.size() == before) throw std::runtime_error("selection wants nothing more and is not complete");
  }
}

}  // namespace terrane::accuracy
