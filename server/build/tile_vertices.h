#pragma once
// A tile's vertex attributes from what the field gave: places on the lattice, normals, colours. Arrays are worked on
// whole, in loops that become vector instructions on every machine, with the same bits on all. Thread-safe: no shared
// state.

#include <cstdint>
#include <span>
#include <vector>

#include "common/tiling/face_path.h"
#include "common/tiling/lattice.h"
#include "server/build/grid_directions.h"
#include "server/build/tile_topology.h"
#include "server/fields/height_field.h"

namespace terrane {

/// In lattice steps from the body's centre, whole, of all vertices, skirts included.
struct LatticeCoordinates {
  std::vector<double> x, y, z;
};

struct VertexInput {
  const FacePath& path;
  const TileTopology& topology;
  const GridDirections& directions;        ///< of the grid
  const std::vector<double>& gridHeights;  ///< metres
  const std::vector<double>& skirtHeights;
  double radiusMeters;
  int stepExponent;
};

/// Where roundToLattice puts the grid's vertices and the skirts below them. Skirts lean outwards (kSkirtFlareSteps).
void placeVertices(const VertexInput& tile, LatticeCoordinates& out);

/// Offsets from the componentwise smallest point, which becomes the origin. False if one does not fit into 16 bits.
bool offsetsFromOrigin(const LatticeCoordinates& lattice, LatticePoint& origin, std::vector<std::uint16_t>& offsets);

/// A skirt vertex has the normal and colour of the edge vertex it hangs from.
void writeNormals(const GridDirections& directions, const SurfaceSamples& samples, double radiusMeters,
                  const TileTopology& topology, std::vector<float>& out);
void writeColors(const std::vector<float>& reflectance, const TileTopology& topology, std::vector<std::uint8_t>& out);

struct NumberRange {
  double least, greatest;
};
/// Precondition: not empty.
NumberRange rangeOf(std::span<const double> numbers) noexcept;

}  // namespace terrane
