#include "client/dust/pebble_shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <utility>

#include "common/numerics/strict_math.h"

namespace terrane {
namespace {

constexpr int kPlanes = 11;
constexpr std::uint64_t kSeed = 0x7E22A4ull;

struct Plane {
  glm::dvec3 normal;
  double distance;
};
using Shape = std::array<Plane, kPlanes>;

std::array<Shape, kGrainVariants> makeShapes() {
  std::uint64_t state = kSeed;
  const auto random = [&state] {
    state += 0x9E3779B97F4A7C15ull;
    std::uint64_t h = state;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBull;
    return static_cast<double>((h ^ (h >> 31)) >> 11) * 0x1p-53;
  };
  std::array<Shape, kGrainVariants> shapes;
  for (Shape& shape : shapes) {
    for (Plane& plane : shape) {
      glm::dvec3 v(0.0);
      do v = {2 * random() - 1, 2 * random() - 1, 2 * random() - 1};
      while (glm::dot(v, v) > 1 || glm::dot(v, v) < 0.01);
      plane = {v / std::sqrt(glm::dot(v, v)), 0.6 + 0.3 * random()};
    }
  }
  return shapes;
}

std::array<float, kGrainVariants> radiiAlong(const glm::dvec3& direction) {
  static const std::array<Shape, kGrainVariants> shapes = makeShapes();
  std::array<float, kGrainVariants> radii{};
  for (std::size_t i = 0; i < radii.size(); ++i) {
    double radius = 1;
    for (const Plane& plane : shapes[i])
      if (const double along = glm::dot(direction, plane.normal); along > 0)
        radius = std::min(radius, plane.distance / along);
    radii[i] = static_cast<float>(radius);
  }
  return radii;
}

PebbleVertex vertexAlong(const glm::dvec3& v) {
  const glm::dvec3 unit = v / std::sqrt(glm::dot(v, v));
  PebbleVertex vertex;
  vertex.direction = {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)};
  vertex.radii = vertex.coarserRadii = radiiAlong(unit);
  return vertex;
}

PebbleMesh icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  const std::array<glm::dvec3, 12> corners{{{-1, g, 0},
                                            {1, g, 0},
                                            {-1, -g, 0},
                                            {1, -g, 0},
                                            {0, -1, g},
                                            {0, 1, g},
                                            {0, -1, -g},
                                            {0, 1, -g},
                                            {g, 0, -1},
                                            {g, 0, 1},
                                            {-g, 0, -1},
                                            {-g, 0, 1}}};
  PebbleMesh mesh;
  for (const glm::dvec3& corner : corners) mesh.vertices.push_back(vertexAlong(corner));
  mesh.triangles = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                    3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
  return mesh;
}

/// In the middle of an edge by direction; the edge is met where both ends' pulls are equal.
PebbleVertex between(const PebbleVertex& a, const PebbleVertex& b) {
  const glm::dvec3 first(a.direction[0], a.direction[1], a.direction[2]),
      second(b.direction[0], b.direction[1], b.direction[2]);
  PebbleVertex vertex = vertexAlong(first + second);
  const double halfCosine = std::sqrt((1 + glm::dot(first, second)) / 2);  // of half the angle between them
  for (std::size_t i = 0; i < vertex.radii.size(); ++i) {
    const double p = a.radii[i], q = b.radii[i];
    vertex.coarserRadii[i] = static_cast<float>(2 * p * q / (p + q) * halfCosine);
  }
  return vertex;
}

PebbleMesh split(const PebbleMesh& coarse) {
  PebbleMesh fine;
  fine.vertices = coarse.vertices;
  for (PebbleVertex& vertex : fine.vertices) vertex.coarserRadii = vertex.radii;
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::uint16_t> added;
  const auto middle = [&](std::uint16_t a, std::uint16_t b) {
    const auto [at, isNew] = added.try_emplace(std::minmax(a, b), static_cast<std::uint16_t>(fine.vertices.size()));
    if (isNew) fine.vertices.push_back(between(coarse.vertices[a], coarse.vertices[b]));
    return at->second;
  };
  for (std::size_t t = 0; t < coarse.triangles.size(); t += 3) {
    const std::uint16_t a = coarse.triangles[t], b = coarse.triangles[t + 1], c = coarse.triangles[t + 2];
    const std::uint16_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
  }
  return fine;
}

}  // namespace

PebbleMesh pebbleMesh(int splits) {
  PebbleMesh mesh = icosahedron();
  for (int i = 0; i < splits; ++i) mesh = split(mesh);
  return mesh;
}

}  // namespace terrane
