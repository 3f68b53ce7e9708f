#pragma once
// A point of the icosahedron's surface by what does not depend on the face it is seen from: the vertices of the solid
// that it has weights at, lowest first. And tiles at random.

#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "common/tiling/face_path.h"
#include "common/tiling/icosahedron.h"
#include "common/tiling/triangle_tile.h"

namespace terrane::test {

using SolidPoint = std::map<int, std::int64_t>;

inline SolidPoint solidPoint(int face, const FaceWeights& weights) {
  SolidPoint point;
  for (int k = 0; k < kTriangleCorners; ++k)
    if (weights[k] != 0) point[icosahedronCorners(face)[static_cast<std::size_t>(k)]] = weights[k];
  return point;
}

inline std::vector<FacePath> allIcoTiles(int level) {
  std::vector<FacePath> tiles;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (std::uint64_t digits = 0; digits < std::uint64_t{1} << (2 * level); ++digits)
      tiles.push_back(FacePath::fromPackedDigits(Scheme::Ico, face, level, digits));
  }
  return tiles;
}

/// Each third tile keeps to an edge or corner of its face for many levels.
inline FacePath randomIcoTile(std::mt19937_64& random, int level) {
  FacePath path = FacePath::wholeFace(Scheme::Ico, static_cast<int>(random() % kIcosahedronFaces));
  const int corner = static_cast<int>(random() % 3), other = static_cast<int>(random() % 3);
  const bool atEdge = random() % 3 == 0;
  while (path.level() < level) {
    const int digit = atEdge ? (random() % 2 != 0 ? corner : other) : static_cast<int>(random() % 4);
    path = path.child(digit);
  }
  return path;
}

}  // namespace terrane::test
