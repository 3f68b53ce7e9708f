#pragma once
// What every decoded mesh must be, whatever the bytes were. Stops the fuzzer at the input that breaks it.

#include <cmath>
#include <cstdlib>

#include "proto/draco_mesh.h"

namespace terrane::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

inline void requireSound(const TileMesh& mesh, const DecodeLimits& limits) {
  const std::size_t vertices = mesh.vertexCount();
  require(vertices <= limits.maxVertices && mesh.triangles.size() <= 3 * static_cast<std::size_t>(limits.maxTriangles));
  require(mesh.offsets.size() == 3 * vertices && mesh.normals.size() == 3 * vertices);
  require(mesh.colors.empty() || mesh.colors.size() == 3 * vertices);
  for (const std::uint32_t index : mesh.triangles) require(index < vertices);
  for (const float component : mesh.normals) require(std::abs(component) < 1.01f);
}

}  // namespace terrane::fuzz
