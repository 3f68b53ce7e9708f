#pragma once
// Data of all characters on one mesh's triangles: kinds that make an entropy coder choose differently, the ends of all
// ranges, and normals where the octahedron is folded. The same for equal seeds.

#include <string>
#include <utility>
#include <vector>

#include "proto/tile_mesh.h"

namespace terrane::test {

/// Named; the first is the model itself.
std::vector<std::pair<std::string, TileMesh>> kindsOfData(const TileMesh& model, unsigned seed);

}  // namespace terrane::test
