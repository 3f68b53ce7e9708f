#pragma once
// The icosahedron of the `ico` scheme: twelve vertices on the unit sphere of the body frame, twenty triangular faces,
// and what lies beyond each of their edges. Exact tables; thread-safe.
//
// Vertices are the cyclic permutations of (0, +-A, +-B) with B / A the golden ratio (Coxeter, "Regular Polytopes",
// section 3.7). So all coordinates are 0, +-A or +-B, mirror images to the bit, and no vertex of five triangles lies at
// a pole: each of the six axes passes through the middle of an edge, which every grid has as a vertex with the exact
// coordinates 0, 0, +-1. Edges lie along the antimeridian and the meridian of 0.
//   vertex 4 k + 2 [B < 0] + [A < 0]: 0 along axis k, +-A along axis k + 1, +-B along axis k + 2 (mod 3).
//   face 0..7, 4 [z < 0] + 2 [y < 0] + [x < 0]: in the middle of an octant.
//   face 8..19, 8 + 4 k + 2 [main < 0] + [second < 0]: two at the edge that axis k = x, y, z passes through; main is
//   the coordinate along k, second the one along k + 1.
//
// Corners 0, 1, 2 of a face run counter-clockwise seen from outside. Edge k lies opposite corner k and runs from corner
// k + 1 to corner k + 2 (mod 3). Two faces that share an edge run along it in opposite directions.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

namespace terrane {

inline constexpr int kIcosahedronVertices = 12;
inline constexpr int kIcosahedronFaces = 20;
inline constexpr int kTriangleCorners = 3;

/// Within 0.51 ulp of 1 / sqrt(1 + phi^2) and phi / sqrt(1 + phi^2). Of the two doubles beside B it is the one with
/// which A A + B B rounds to 1, so that normalising a vertex gives that vertex.
inline constexpr double kIcosahedronA = 0x1.0d2ca0da1530dp-1;
inline constexpr double kIcosahedronB = 0x1.b38880b4603e5p-1;

/// Distance of a face's plane from the centre, in circumradii; tan(pi/3)^-1 tan(pi/5)^-1 (Coxeter, section 2.4).
inline constexpr double kIcosahedronInradius = 0.7946544722917661;
/// The angle under which an edge is seen from the centre, radians.
inline constexpr double kIcosahedronEdgeAngle = 1.1071487177940904;

/// 0 <= vertex < 12.
glm::dvec3 icosahedronVertex(int vertex) noexcept;

/// The vertices at a face's corners.
const std::array<int, kTriangleCorners>& icosahedronCorners(int face) noexcept;

struct FaceEdge {
  int face, edge;
  bool operator==(const FaceEdge&) const = default;
};
/// The face beyond an edge and which of its edges that is.
FaceEdge beyondFaceEdge(int face, int edge) noexcept;

/// The face that a direction passes through: any finite non-zero vector of any length. Within 1e-15 radians of an
/// edge it may be the face on the other side. Where faces are equally near the answer is one in an octant's middle
/// before one at an axis, those in the order of the axes; a zero coordinate counts as positive.
int icosahedronFaceAt(const glm::dvec3& direction) noexcept;

}  // namespace terrane
