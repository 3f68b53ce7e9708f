#pragma once
// Tiles and points on their surfaces at random, the awkward ones often, to hold against volumes; in long double, so
// that what a test finds is the volumes' error and not its own.

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "common/tiling/face_path.h"
#include "common/tiling/tile_bounds.h"

namespace terrane::test {

struct Vec {
  long double x, y, z;
  Vec(long double a, long double b, long double c) : x(a), y(b), z(c) {}
  explicit Vec(const glm::dvec3& p) : x(p.x), y(p.y), z(p.z) {}
};
inline Vec operator-(const Vec& a, const Vec& b) { return Vec(a.x - b.x, a.y - b.y, a.z - b.z); }
inline Vec operator+(const Vec& a, const Vec& b) { return Vec(a.x + b.x, a.y + b.y, a.z + b.z); }
inline Vec operator*(const Vec& a, long double k) { return Vec(a.x * k, a.y * k, a.z * k); }
inline long double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline long double length(const Vec& a) { return std::sqrt(dot(a, a)); }
inline Vec cross(const Vec& a, const Vec& b) {
  return Vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/// Prints its seed.
struct Random {
  explicit Random(std::uint64_t seed);
  double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(engine); }
  double between(double a, double b) { return a + (b - a) * unit(); }
  std::uint64_t below(std::uint64_t n) { return engine() % n; }
  std::mt19937_64 engine;
};

struct Case {
  FacePath path;
  double radius;
  HeightRange heights;
};

/// Tiles anywhere, at a face's centre, and at its corners, of bodies from an asteroid to the Sun.
Case randomCase(Random& random, int level, Scheme scheme = Scheme::Cube);

/// A surface point of the tile: grid corners and edges often, the inside too, at the lowest, the highest or any height,
/// and half of the time rounded to the level's lattice, as a vertex is.
glm::dvec3 samplePoint(Random& random, const Case& c);

struct Plane {
  Vec normal;  ///< unit, outward
  long double offset;
};
/// The supporting planes of the hull of eight points: all planes through three of them with no other in front.
std::vector<Plane> supportingPlanes(const std::array<glm::dvec3, 8>& hull);

bool boxContains(const OrientedBox& box, const Vec& p);

}  // namespace terrane::test
