#include "server/build/tile_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "common/numerics/strict_math.h"
#include "proto/tile_mesh.h"
#include "server/build/edge_planes.h"

namespace terrane {
namespace {

using Double2 = double __attribute__((vector_size(16)));

/// A power of two times a product is the product with that power times a factor: these are the bits of roundToLattice.
void placeGrid(const std::vector<double>& directions, const VertexInput& tile, double* out) {
  const double stepsPerMeter = stepMeters(-tile.stepExponent), radiusMeters = tile.radiusMeters;
  const double *direction = directions.data(), *height = tile.gridHeights.data();
  const std::size_t count = tile.gridHeights.size();
  for (std::size_t i = 0; i < count; ++i)
    out[i] = roundedHalfUp(direction[i] * ((radiusMeters + height[i]) * stepsPerMeter));
}

/// Vertices worked on together, in memory of their own: what triples are written to might be what is read, for all that
/// a compiler knows.
constexpr std::size_t kBlock = 64;

/// Normal of the surface (R + h) d, whose tangents are those of the sphere lifted by the gradient g at radius R: (1 +
/// h/R) d - g. In float, whose rounding is a ten-thousandth of a step of 8-bit normals.
void writeNormalsOfBlock(const GridDirections& directions, const SurfaceSamples& samples, float perRadius,
                         std::size_t first, std::size_t count, float* out) {
  std::array<float, kBlock> normalX, normalY, normalZ;
  const double* height = &samples.heightMeters[first];
  const double *atX = &directions.x[first], *atY = &directions.y[first], *atZ = &directions.z[first];
  const float *slopeX = &samples.gradientX[first], *slopeY = &samples.gradientY[first],
              *slopeZ = &samples.gradientZ[first];
  for (std::size_t i = 0; i < count; ++i) {
    const float radial = 1.0f + static_cast<float>(height[i]) * perRadius;
    const float x = static_cast<float>(atX[i]) * radial - slopeX[i];
    const float y = static_cast<float>(atY[i]) * radial - slopeY[i];
    const float z = static_cast<float>(atZ[i]) * radial - slopeZ[i];
    const float perLength = 1.0f / std::sqrt((x * x + y * y) + z * z);
    normalX[i] = x * perLength;
    normalY[i] = y * perLength;
    normalZ[i] = z * perLength;
  }
  for (std::size_t i = 0; i < count; ++i) {
    out[3 * i] = normalX[i];
    out[3 * i + 1] = normalY[i];
    out[3 * i + 2] = normalZ[i];
  }
}

template <class T>
void copyToSkirts(const TileTopology& topology, T* values) {
  T* skirt = values + 3 * topology.gridVertexCount();
  for (const std::uint32_t anchor : topology.skirtAnchors)
    skirt = std::copy_n(values + 3 * static_cast<std::size_t>(anchor), 3, skirt);
}

}  // namespace

NumberRange rangeOf(std::span<const double> numbers) noexcept {
  // Compilers do not make these two at once of std::min, which tells +0 from -0 by their order.
  Double2 least{numbers[0], numbers[0]}, greatest = least;
  const double* number = numbers.data();
  for (std::size_t pairs = numbers.size() / 2; pairs > 0; --pairs, number += 2) {
    Double2 pair;
    std::memcpy(&pair, number, sizeof pair);
    least = pair < least ? pair : least;
    greatest = pair > greatest ? pair : greatest;
  }
  const double last = numbers.back();
  return {std::min({least[0], least[1], last}), std::max({greatest[0], greatest[1], last})};
}

void placeVertices(const VertexInput& tile, LatticeCoordinates& out) {
  const GridDirections& at = tile.directions;
  const TileTopology& topology = tile.topology;
  const std::size_t gridCount = tile.gridHeights.size();
  for (auto* coordinates : {&out.x, &out.y, &out.z}) coordinates->resize(gridCount + topology.skirtAnchors.size());
  placeGrid(at.x, tile, out.x.data());
  placeGrid(at.y, tile, out.y.data());
  placeGrid(at.z, tile, out.z.data());

  const EdgeNormals outward(tile.path);
  const double flare = kSkirtFlareSteps * stepMeters(tile.stepExponent), stepsPerMeter = stepMeters(-tile.stepExponent);
  const auto perEdge = static_cast<std::size_t>(topology.cellsPerEdge) + 1;
  for (std::size_t k = 0; k < topology.skirtAnchors.size(); ++k) {
    const std::size_t anchor = topology.skirtAnchors[k], vertex = gridCount + k;
    const double radius = tile.radiusMeters + tile.skirtHeights[k];
    const glm::dvec3 below{at.x[anchor] * radius, at.y[anchor] * radius, at.z[anchor] * radius};
    const glm::dvec3 place = below + outward.lean(k / perEdge, k % perEdge, perEdge - 1) * flare;
    out.x[vertex] = roundedHalfUp(place.x * stepsPerMeter);
    out.y[vertex] = roundedHalfUp(place.y * stepsPerMeter);
    out.z[vertex] = roundedHalfUp(place.z * stepsPerMeter);
  }
}

bool offsetsFromOrigin(const LatticeCoordinates& lattice, LatticePoint& origin, std::vector<std::uint16_t>& offsets) {
  const std::array ranges{rangeOf(lattice.x), rangeOf(lattice.y), rangeOf(lattice.z)};
  for (const NumberRange& range : ranges)
    if (range.greatest - range.least > kTileOffsetMax) return false;
  const double leastX = ranges[0].least, leastY = ranges[1].least, leastZ = ranges[2].least;
  origin = LatticePoint(static_cast<std::int64_t>(leastX), static_cast<std::int64_t>(leastY),
                        static_cast<std::int64_t>(leastZ));
  const std::size_t count = lattice.x.size();
  offsets.resize(3 * count);
  const double *x = lattice.x.data(), *y = lattice.y.data(), *z = lattice.z.data();
  std::uint16_t* out = offsets.data();
  const auto offset = [](double steps) { return static_cast<std::uint16_t>(static_cast<std::int32_t>(steps)); };
  for (std::size_t i = 0; i < count; ++i) {
    out[3 * i] = offset(x[i] - leastX);
    out[3 * i + 1] = offset(y[i] - leastY);
    out[3 * i + 2] = offset(z[i] - leastZ);
  }
  return true;
}

void writeNormals(const GridDirections& directions, const SurfaceSamples& samples, double radiusMeters,
                  const TileTopology& topology, std::vector<float>& out) {
  out.resize(3 * topology.gridIndices.size());
  const std::size_t count = samples.heightMeters.size();
  const auto perRadius = static_cast<float>(1.0 / radiusMeters);
  for (std::size_t first = 0; first < count; first += kBlock)
    writeNormalsOfBlock(directions, samples, perRadius, first, std::min(kBlock, count - first), &out[3 * first]);
  copyToSkirts(topology, out.data());
}

void writeColors(const std::vector<float>& reflectance, const TileTopology& topology, std::vector<std::uint8_t>& out) {
  out.resize(3 * topology.gridIndices.size());
  std::array<std::uint8_t, kBlock> greys;
  const std::size_t count = reflectance.size();
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = std::min(kBlock, count - first);
    const float* from = &reflectance[first];
    std::uint8_t* color = &out[3 * first];
    for (std::size_t i = 0; i < size; ++i) {
      // Cut after the clamp, not before: std::floor is a call on the oldest x86-64.
      const float scaled = from[i] * (255.0f / kColorScale) + 0.5f;
      const float clamped = std::min(std::max(scaled, 0.0f), 255.0f);
      greys[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(clamped));
    }
    for (std::size_t i = 0; i < size; ++i) color[3 * i] = color[3 * i + 1] = color[3 * i + 2] = greys[i];
  }
  copyToSkirts(topology, out.data());
}

}  // namespace terrane
