#pragma once
// What the midpoint field's samples are worked out with: a tile's grid, one of its edges, or single directions. Each
// thread keeps memory of a tile's size between calls and no more.

#include <span>

#include "server/fields/height_field.h"
#include "server/fields/midpoint_displacement.h"

namespace terrane::midpoint {

/// The surface of one grid level.
struct Surface {
  const MidpointDisplacement& displacement;
  int gridLevel;
  double radiusMeters;
};

/// Heights of all vertices of the grid, by grid index, and their gradients. The gradient at a vertex is that of its
/// triangles (of its neighbours' polygon, on the cube), by their areas: with neighbours p_k counter-clockwise,
///   sum_k (h_k - h) (p_k+1 - p_k-1) x p / (R sum_k p . (p_k - p) x (p_k+1 - p)),
/// exact where the height is linear. Summed from the neighbour with the least direction on, so that all tiles that have
/// the vertex round alike.
void sampleGrid(const Surface& surface, const GridPlace& grid, SurfaceSamples& out);

/// Heights along an edge.
void sampleEdge(const Surface& surface, const GridPlace& grid, std::span<double> heightMeters);

/// Heights and gradients at unit directions.
void sampleDirections(const Surface& surface, Scheme scheme, const SampleBatch& batch, SurfaceSamples& out);

}  // namespace terrane::midpoint
