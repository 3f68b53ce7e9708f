#pragma once
// Smooth normals over a weld: each vertex has the sum of its triangles' normals, weighted by their areas. On the Moon's
// ground, beside the normals that come from the ground's gradient and need no weld.

#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "tests/accuracy/welding/weld_ways.h"

namespace terrane::accuracy {

/// At the corners of a soup.
struct SoupGround {
  std::vector<glm::dvec3> positionsBody;    ///< metres
  std::vector<glm::dvec3> gradientNormals;  ///< unit: as tiles are served with, in double
};
/// The ground of the scene "moon-ico", with the wavelengths that such a grid shows. Throws std::runtime_error.
SoupGround lunarGround(const Soup& soup);

/// Unit normals, one a corner.
std::vector<glm::dvec3> areaWeightedNormals(std::span<const glm::dvec3> positions, const Weld& weld);

/// Every tile welded in itself alone, as one that does not know its neighbours is.
Weld weldWithinTiles(const Soup& soup);

/// Degrees.
struct NormalDifferences {
  double mostOfCopies = 0;  ///< between a vertex's copies: what shows as a crease
  double mostOfExact = 0;   ///< from the normals that are given as exact
};
NormalDifferences compareNormals(std::span<const glm::dvec3> normals, std::span<const glm::dvec3> exact,
                                 const Weld& truth);

}  // namespace terrane::accuracy
