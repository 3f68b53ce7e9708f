#pragma once
// A tile for tests of the wire formats: fractal ground on a body of the Moon's radius, on the lattice, with normals,
// colours and skirts, as a builder would make it. The same for equal settings.

#include <array>
#include <cstdint>

#include "proto/tile_mesh.h"

namespace terrane::test {

/// A tile of each scheme.
inline const std::array<FacePath, 2> kSamplePaths{
    FacePath::cubeTile(2, 7, 51, 90), FacePath::fromPackedDigits(Scheme::Ico, 17, 7, 0b00'11'10'01'11'11'00)};

struct SampleSettings {
  FacePath path = kSamplePaths[0];
  int cellsPerEdge = 64;
  bool skirts = true;
  bool colors = true;
  std::uint32_t seed = 1;
  double radiusMeters = 1737400;
  double roughness = 0.05;  ///< highest relief over tile width
};

Tile sampleTile(const SampleSettings& settings = {});

/// Equal as a set of vertices and triangles, told apart by their grid index: an encoder may order both anew. Normals
/// within normalTolerance (length of the difference).
bool sameMesh(const TileMesh& expected, const TileMesh& actual, double normalTolerance);
bool sameMetadata(const TileMetadata& expected, const TileMetadata& actual);

}  // namespace terrane::test
