#include "tests/unit/common/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"

namespace terrane::test {

Random::Random(std::uint64_t seed) : engine(seed) { std::cout << "seed " << seed << '\n'; }

Case randomCase(Random& random, int level) {
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
      const double width = nominalTileWidthMeters(radius, level);
      heights.minMeters = random.between(-0.1, 0.1) * radius;
      heights.maxMeters = heights.minMeters + 0.1 * width * random.unit();
    }
  }
  const int face = static_cast<int>(random.below(6));
  const std::uint32_t column = index();
  return Case{FacePath::cubeTile(face, level, column, index()), radius, heights};
}

glm::dvec3 samplePoint(Random& random, const Case& c) {
  const int grid = 20;
  const auto offset = [&]() -> std::uint64_t {
    const std::uint64_t kind = random.below(4);
    return kind == 0 ? 0 : kind == 1 ? (1u << grid) : random.below((1u << grid) + 1);
  };
  const std::uint64_t column = (std::uint64_t{c.path.column()} << grid) + offset();
  const std::uint64_t row = (std::uint64_t{c.path.row()} << grid) + offset();
  const std::uint64_t kind = random.below(3);
  const double height = kind == 0   ? c.heights.minMeters
                        : kind == 1 ? c.heights.maxMeters
                                    : random.between(c.heights.minMeters, c.heights.maxMeters);
  const glm::dvec3 p = cubeGridDirection(c.path.face(), c.path.level() + grid, column, row) * (c.radius + height);
  if (random.below(2)) return p;
  const int exponent = stepExponent(c.radius, c.path.level());
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
