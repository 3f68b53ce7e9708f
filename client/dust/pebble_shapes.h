#pragma once
// The shapes of grains: spheres cut by planes, as broken rock is. One mesh for each degree of detail, an icosahedron
// split so many times; a vertex keeps its direction in all of them, and every shape is a radius along it, so that one
// mesh serves all shapes. A vertex that a split added has a second radius, where its direction meets the edge that it
// splits: with that the finer mesh is the coarser one. Deterministic, no libm. Thread-safe.

#include <array>
#include <cstdint>
#include <vector>

#include "client/dust/grain_field.h"

namespace terrane {

struct PebbleVertex {
  std::array<float, 3> direction{};                  ///< unit
  std::array<float, kGrainVariants> radii{};         ///< of each shape, at most 1
  std::array<float, kGrainVariants> coarserRadii{};  ///< in the mesh of one split less; radii where it is there too
};
static_assert(sizeof(PebbleVertex) == 44);

struct PebbleMesh {
  std::vector<PebbleVertex> vertices;
  std::vector<std::uint16_t> triangles;  ///< 3 a triangle, counter-clockwise from outside
};

/// 20 * 4^splits triangles. Precondition: 0 <= splits <= 6.
PebbleMesh pebbleMesh(int splits);

/// The sphere that stands for all shapes where exactness is of no use (shadows): its radius.
inline constexpr float kPebbleMeanRadius = 0.85f;

}  // namespace terrane
