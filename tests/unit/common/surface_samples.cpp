#include "tests/unit/common/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/triangle_tile.h"

namespace terrane::test {

Random::Random(std::uint64_t seed) : engine(seed) { std::cout << "seed " << seed << '\n'; }

namespace {

/// Anywhere, in a corner of its face, or in the middle of one of its edges.
FacePath randomTriangle(Random& random, int level) {
  FacePath path = FacePath::wholeFace(Scheme::Ico, static_cast<int>(random.below(20)));
  const std::uint64_t kind = random.below(4);
  const int corner = static_cast<int>(random.below(3));
  for (int i = 0; i < level; ++i) {
    const int anywhere = static_cast<int>(random.below(4));
    path = path.child(kind == 0 ? corner : kind == 1 ? (i == 0 ? corner : (corner + 1) % 3) : anywhere);
  }
  return path;
}

glm::dvec3 randomDirection(Random& random, const FacePath& path) {
  const auto offset = [&](std::uint64_t most) -> std::uint64_t {
    const std::uint64_t kind = random.below(4);
    return kind == 0 ? 0 : kind == 1 ? most : random.below(most + 1);
  };
  if (path.scheme() == Scheme::Cube) {
    const int grid = 20;
    const std::uint64_t column = (std::uint64_t{path.column()} << grid) + offset(1u << grid);
    const std::uint64_t row = (std::uint64_t{path.row()} << grid) + offset(1u << grid);
    return cubeGridDirection(path.face(), path.level() + grid, column, row);
  }
  const int grid = 12, cells = 1 << grid;
  const int i = static_cast<int>(offset(cells));
  const int j = static_cast<int>(offset(static_cast<std::uint64_t>(cells - i)));
  const FaceWeights weights = gridVertexWeights(triangleTile(path), cells, {i, j});
  return icoGridDirection(kIcoMap, path.face(), path.level() + grid, weights);
}

}  // namespace

Case randomCase(Random& random, int level, Scheme scheme) {
  const double radius = kMinRadiusMeters * std::pow(kMaxRadiusMeters / kMinRadiusMeters, random.unit());
  const std::uint64_t cells = std::uint64_t{1} << level;
  const auto index = [&] {
    const std::uint64_t kind = random.below(6);
    return static_cast<std::uint32_t>(kind == 0   ? 0
                                      : kind == 1 ? cells - 1
                                      : kind == 2 ? cells / 2
                                                  : random.below(cells));
  };
  HeightRange heights;
  switch (random.below(5)) {
    case 0:
      break;
    case 1:
      heights = {-0.006 * radius, 0.006 * radius};
      break;
    case 2:
      heights = {-0.2 * radius, 0.3 * radius};
      break;
    case 3:
      heights = {0.05 * radius, 0.05 * radius + 1.0};
      break;
    default: {
      // As thin as the tile is wide, anywhere.
      const double width = nominalTileWidthMeters(radius, level, scheme);
      heights.minMeters = random.between(-0.1, 0.1) * radius;
      heights.maxMeters = heights.minMeters + 0.1 * width * random.unit();
    }
  }
  if (scheme == Scheme::Ico) return Case{randomTriangle(random, level), radius, heights};
  const int face = static_cast<int>(random.below(6));
  const std::uint32_t column = index();
  return Case{FacePath::cubeTile(face, level, column, index()), radius, heights};
}

glm::dvec3 samplePoint(Random& random, const Case& c) {
  const glm::dvec3 direction = randomDirection(random, c.path);
  const std::uint64_t kind = random.below(3);
  const double height = kind == 0   ? c.heights.minMeters
                        : kind == 1 ? c.heights.maxMeters
                                    : random.between(c.heights.minMeters, c.heights.maxMeters);
  const glm::dvec3 p = direction * (c.radius + height);
  if (random.below(2)) return p;
  const int exponent = stepExponent(c.radius, c.path.level(), c.path.scheme());
  return latticePosition(roundToLattice(p, exponent), exponent);
}

std::vector<Plane> supportingPlanes(const std::array<glm::dvec3, 8>& hull) {
  const Vec origin(hull[0]);
  std::vector<Vec> points;
  for (const glm::dvec3& p : hull) points.push_back(Vec(p) - origin);
  long double size = 0;
  for (const Vec& p : points) size = std::max(size, length(p));
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t j = i + 1; j < 8; ++j) {
      for (std::size_t k = j + 1; k < 8; ++k) {
        Vec normal = cross(points[j] - points[i], points[k] - points[i]);
        const long double norm = length(normal);
        if (norm < 1e-9L * size * size) continue;
        normal = normal * (1 / norm);
        long double low = 0, high = 0;
        for (const Vec& p : points) {
          low = std::min(low, dot(normal, p - points[i]));
          high = std::max(high, dot(normal, p - points[i]));
        }
        // Four corners of a face are in one plane only up to rounding.
        const long double flat = 1e-12L * size + 1e-15L * length(origin);
        if (high <= flat) planes.push_back({normal, dot(normal, points[i]) + high});
        if (low >= -flat) planes.push_back({normal * -1, -dot(normal, points[i]) - low});
      }
    }
  }
  return planes;
}

bool boxContains(const OrientedBox& box, const Vec& p) {
  for (const glm::dvec3& half : box.halfAxes) {
    const Vec h(half);
    if (std::fabs(dot(p - Vec(box.center), h)) > dot(h, h)) return false;
  }
  return true;
}

}  // namespace terrane::test
