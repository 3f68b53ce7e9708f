#pragma once
// Ways of finding out which corners of a soup are the same vertex: by exact integer keys, and by sorting a hash of
// floating-point coordinates, theta + k phi, and joining neighbours in that order whose hashes are close.

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tests/accuracy/welding/soup.h"
#include "tests/accuracy/welding/vertex_keys.h"

namespace terrane::accuracy {

/// A number for every corner: equal for those that were joined; 0 .. count - 1.
struct Weld {
  std::vector<std::uint32_t> vertexOfCorner;
  std::uint32_t count = 0;
};

enum class Sort : std::uint8_t { Introsort, Heapsort };  ///< std::sort; std::make_heap and std::sort_heap

/// Precondition: gridLevel <= kKey64MaxGridLevel.
Weld weldByKey64(std::span<const Corner> corners);
Weld weldByKey64Radix(std::span<const Corner> corners);      ///< least significant byte first
Weld weldByKey64HashTable(std::span<const Corner> corners);  ///< open addressing; unsorted
Weld weldByKey128(std::span<const Corner> corners);

/// Of all corners with the same coordinates, to the bit but for the sign of zeros: exact where copies are alike.
Weld weldByCoordinates(std::span<const glm::dvec3> positions);

/// theta, the angle from +z, is of 0 .. pi, phi, the longitude, of -pi .. pi. k is irrational, so that no two vertices
/// share a hash by the icosahedron's symmetry alone.
inline constexpr double kLongitudeFactor = 1.4142135623730951;

template <class Real>
struct HashedCorner {
  Real hash;
  std::uint32_t corner;
};
/// In rising order of the hash, computed in Real by the C library.
template <class Real>
std::vector<HashedCorner<Real>> sortedHashes(std::span<const glm::vec<3, Real>> positions, Sort sort);

/// Joins corners whose hash is at most epsilon above that of the one before.
template <class Real>
Weld weldSorted(std::span<const HashedCorner<Real>> sorted, double epsilon);

/// A few units in the last place of the largest hashes.
template <class Real>
inline constexpr double kUsualEpsilon = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;

}  // namespace terrane::accuracy
