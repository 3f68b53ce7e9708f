#pragma once
// A height field over the sphere: heights, gradients and reflectance for many directions at once, limited to the
// wavelengths that a tile level can show, with proven bounds on all that is left out. Deterministic: equal inputs give
// equal bits on every machine, thread and SIMD path, whatever else is in the batch. Body frame, metres. const is
// thread-safe.

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "common/scene/scene.h"
#include "common/tiling/face_path.h"
#include "common/tiling/tile_bounds.h"

namespace terrane {

/// Which build of the vector kernels runs. All give the same bits; tests run all.
enum class SimdPath : std::uint8_t { Default, V3, V4 };
/// The best that this CPU has.
SimdPath bestSimdPath() noexcept;
bool simdPathSupported(SimdPath path) noexcept;
/// "default", "v3", "v4"; errors name "--simd".
Result<SimdPath> parseSimdPath(std::string_view text);

/// Says which vertices samples are: all of a tile's grid, by grid index, or those along one edge, in the order of the
/// skirts (build/grid_directions.h), of which the last may be left out, as it is the next edge's first: of these
/// heights alone are asked for, gradients and reflectance may hold anything. cellsPerEdge is a power of two, at most
/// 256, and may be another than that of the tiles served.
struct GridPlace {
  static constexpr int kWholeGrid = -1;
  FacePath path;
  int cellsPerEdge = 0;
  int skirtEdge = kWholeGrid;
  bool isWholeGrid() const noexcept { return skirtEdge == kWholeGrid; }
};

/// Directions to sample, structure of arrays. Rows matter only for speed (a kernel may skip whole rows): count = rows *
/// rowLength.
struct SampleBatch {
  const double* x = nullptr;  ///< unit directions, body frame
  const double* y = nullptr;
  const double* z = nullptr;
  std::size_t rows = 0, rowLength = 0;
  /// Gradients and reflectance are averaged over about this far around each sample, so that a mesh with such cells does
  /// not show them aliased (heights are those of the point itself); 0: at the point.
  double footprintMeters = 0;
  /// Where the samples are a grid's vertices: fields that are made of the grid itself give each vertex its own height,
  /// to the bit, and the gradient of the mesh around it. For others the directions say it all.
  std::optional<GridPlace> grid = {};
  /// With a grid: how far heights may be from the field's own, beside roundings, where that saves time: inside a whole
  /// grid, where no other tile has the vertex, and, if the grid of the same tile came before with the same scratch,
  /// along an edge. 0: nowhere.
  double toleranceMeters = 0;
  std::size_t count() const noexcept { return rows * rowLength; }
};

/// Results, resized by evaluate; kept by the caller between calls so that nothing is allocated in the steady state.
struct SurfaceSamples {
  std::vector<double> heightMeters;
  /// Gradient of the height along the surface (tangent to the sphere of radius R), body frame, dimensionless (metres
  /// per metre).
  std::vector<float> gradientX, gradientY, gradientZ;
  std::vector<float> reflectance;  ///< linear normal albedo, 0..kColorScale; empty if the field has one colour
  struct Scratch;                  ///< kernels' own memory
  std::shared_ptr<Scratch> scratch;

  void resize(std::size_t count) {
    heightMeters.resize(count);
    gradientX.resize(count);
    gradientY.resize(count);
    gradientZ.resize(count);
    reflectance.resize(count);
  }
};

/// Heights of neighbouring vertices of a tile differ by at most this many times their distance (79 degrees); skirt_test
/// holds the lunar field to it, midpoint_field_test the other.
inline constexpr double kSteepestSlope = 5.0;

class HeightField {
 public:
  virtual ~HeightField() = default;

  /// Components with wavelengths of at least minWavelengthMeters (a tile level's two cells).
  virtual void evaluate(const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out) const = 0;

  /// Proven: |h(all wavelengths down to finestWavelengthMeters) - h(down to minWavelengthMeters)| <= this, everywhere.
  virtual double omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept = 0;
  /// Proven: how far h(down to minWavelengthMeters) may be from the bilinear surface through samples spacingMeters
  /// apart.
  virtual double interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept = 0;
  /// Proven: how far two evaluations of a level's heights at one place may be from each other beside the tolerance:
  /// what float32 rounds, where one of them has it.
  virtual double roundingMeters(double minWavelengthMeters) const noexcept = 0;
  /// Proven range of all heights.
  virtual HeightRange heightRange() const noexcept = 0;
  /// What shapes the field's values, for the body's revision: name, version and every parameter.
  virtual std::string identity() const = 0;
};

/// Whether the body's field can be made: what no range of a single parameter says. The error's field is the key below
/// the body ("midpoint.amplitude").
Result<void> checkHeightField(const Body& body);

/// Makes what the body names, and counts it ("field.lunar"). Never constructs another. Precondition: checkHeightField
/// finds nothing.
std::unique_ptr<const HeightField> makeHeightField(const Body& body, SimdPath simd);

}  // namespace terrane
