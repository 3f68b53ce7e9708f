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

/// Heights of all vertices of the grid, by grid index, and their gradients (midpoint_gradient.h).
void sampleGrid(const Surface& surface, const GridPlace& grid, SurfaceSamples& out);

/// Heights along an edge.
void sampleEdge(const Surface& surface, const GridPlace& grid, std::span<double> heightMeters);

/// Heights and gradients at unit directions.
void sampleDirections(const Surface& surface, Scheme scheme, const SampleBatch& batch, SurfaceSamples& out);

}  // namespace terrane::midpoint
