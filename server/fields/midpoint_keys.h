#pragma once
// Canonical names of grid vertices: the same three integers from every face and tile that has the vertex, over the
// edges and corners of the solid too, and from a little beyond a face's border. Exact; thread-safe.

#include "common/tiling/triangle_tile.h"
#include "server/fields/midpoint_displacement.h"

namespace terrane {

/// By its weights in units of 2^-gridLevel of a face (triangle_tile.h), gridLevel being the level at which the vertex
/// is new. One weight may be -1: a vertex one step beyond the face's border, its surroundings unfolded into the face's
/// plane. Around a vertex of the icosahedron, where a sixth triangle is missing, two such places are one vertex.
VertexKey icoVertexKey(int face, FaceWeights weights) noexcept;

/// The vertex of the icosahedron at such a place of gridLevel 0.
int icoCornerAt(int face, FaceWeights weights) noexcept;

/// By column and row, -1 .. 2^gridLevel + 1, in units of 2^-gridLevel of a face; not both beyond the face. The key is
/// the point of the cube of half width 2^gridLevel, in the body frame.
VertexKey cubeVertexKey(int face, int gridLevel, std::int64_t column, std::int64_t row) noexcept;

}  // namespace terrane
