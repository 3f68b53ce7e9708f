#pragma once
// Shared by the field tests: random directions, tile grids, one-call evaluation.

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "server/fields/height_field.h"
#include "tests/support/moon_body.h"

namespace terrane::test {

inline constexpr double kMoonRadius = 1737400.0;

inline std::vector<SimdPath> supportedPaths() {
  std::vector<SimdPath> paths;
  for (const SimdPath path : {SimdPath::Default, SimdPath::V3, SimdPath::V4}) {
    if (simdPathSupported(path)) paths.push_back(path);
  }
  return paths;
}

inline glm::dvec3 randomDirection(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  for (;;) {
    const glm::dvec3 v(normal(random), normal(random), normal(random));
    if (const double length = glm::length(v); length > 1e-3) return v / length;
  }
}

/// Directions as a batch owns them.
struct Directions {
  std::vector<double> x, y, z;
  std::size_t rows = 0, rowLength = 0;
  void add(const glm::dvec3& d) {
    x.push_back(d.x);
    y.push_back(d.y);
    z.push_back(d.z);
    rows = 1;
    rowLength = x.size();
  }
  glm::dvec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  SampleBatch batch() const { return {x.data(), y.data(), z.data(), rows, rowLength}; }
};

/// The grid of a tile with 64 cells.
inline Directions tileGrid(int face, int level, std::uint64_t column, std::uint64_t row, std::uint64_t side = 65) {
  Directions d;
  for (std::uint64_t j = 0; j < side; ++j) {
    for (std::uint64_t i = 0; i < side; ++i) d.add(cubeGridDirection(face, level + 6, column * 64 + i, row * 64 + j));
  }
  d.rows = d.rowLength = side;
  return d;
}

inline double tileSpacing(int level) { return nominalTileWidthMeters(kMoonRadius, level) / 64; }

inline SurfaceSamples evaluate(const HeightField& field, const Directions& directions, double minWavelength) {
  SurfaceSamples samples;
  field.evaluate(directions.batch(), minWavelength, samples);
  return samples;
}

}  // namespace terrane::test
