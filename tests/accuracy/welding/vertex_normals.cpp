#include "tests/accuracy/welding/vertex_normals.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "server/fields/height_field.h"
#include "tests/support/tile_source.h"

namespace terrane::accuracy {
namespace {

double degreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

}  // namespace

SoupGround lunarGround(const Soup& soup) {
  const Body body = shippedScene("moon-ico").body;
  const auto field = makeHeightField(body, bestSimdPath());
  const double radiusMeters = body.radiusMeters;
  const double cellMeters = nominalTileWidthMeters(radiusMeters, soup.gridLevel, Scheme::Ico);
  const std::size_t size = soup.gridSize();
  std::vector<double> x(size), y(size), z(size);
  SurfaceSamples samples;
  std::vector<glm::dvec3> positions, normals;
  for (const FacePath& tile : soup.tiles) {
    icoGridDirections(kIcoMap, tile, soup.cells, {x, y, z});
    field->evaluate({x.data(), y.data(), z.data(), 1, size, cellMeters}, 2 * cellMeters, samples);
    for (std::size_t v = 0; v < size; ++v) {
      const glm::dvec3 direction(x[v], y[v], z[v]);
      const double height = samples.heightMeters[v];
      const glm::dvec3 gradient(samples.gradientX[v], samples.gradientY[v], samples.gradientZ[v]);
      positions.push_back((radiusMeters + height) * direction);
      normals.push_back(glm::normalize((1 + height / radiusMeters) * direction - gradient));
    }
  }
  return {atCorners(soup, positions), atCorners(soup, normals)};
}

std::vector<glm::dvec3> areaWeightedNormals(std::span<const glm::dvec3> positions, const Weld& weld) {
  std::vector<glm::dvec3> sums(weld.count, glm::dvec3(0.0));
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    // Twice the triangle's area long.
    const glm::dvec3 normal = glm::cross(positions[i + 1] - positions[i], positions[i + 2] - positions[i]);
    for (std::size_t k = 0; k < 3; ++k) sums[weld.vertexOfCorner[i + k]] += normal;
  }
  std::vector<glm::dvec3> normals;
  normals.reserve(positions.size());
  for (const std::uint32_t vertex : weld.vertexOfCorner) normals.push_back(glm::normalize(sums[vertex]));
  return normals;
}

Weld weldWithinTiles(const Soup& soup) {
  return {soup.gridVertices, static_cast<std::uint32_t>(soup.tiles.size() * soup.gridSize())};
}

NormalDifferences compareNormals(std::span<const glm::dvec3> normals, std::span<const glm::dvec3> exact,
                                 const Weld& truth) {
  NormalDifferences differences;
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  // Each corner with all that came before it of the same vertex: six at most.
  std::vector<std::size_t> before(normals.size(), kNone), latest(truth.count, kNone);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    std::size_t& last = latest[truth.vertexOfCorner[i]];
    before[i] = last;
    last = i;
    for (std::size_t other = before[i]; other != kNone; other = before[other])
      if (normals[other] != normals[i])
        differences.mostOfCopies = std::max(differences.mostOfCopies, degreesBetween(normals[other], normals[i]));
    if (normals[i] != exact[i])
      differences.mostOfExact = std::max(differences.mostOfExact, degreesBetween(normals[i], exact[i]));
  }
  return differences;
}

}  // namespace terrane::accuracy
