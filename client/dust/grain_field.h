#pragma once
// Which grains lie on the ground, and where: a function of the body's radius and the settings alone, so that a grain is
// the same whichever tile draws it. Grains come in classes, one an octave of size: class c lays one grain at most in
// each cell of the grid that tiles of level c have (64 cells an edge; grain_cells.h), placed, sized and turned by an
// integer hash of the cell. A cell belongs to one face and a grain to one tile of every level, so none is counted
// twice.
//
// Deterministic: integers and + - x / sqrt in double, no libm. Thread-safe.

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "client/dust/grain_cells.h"
#include "common/tiling/face_path.h"

namespace terrane {

struct DustSettings {
  double cover = 0.03;  ///< share of the ground that the least octave of size covers; each above it a quarter less
  double smallestMeters = 0.0005;  ///< least diameter
  double largestMeters = 0.128;    ///< greatest
};

/// What one grain a cell can cover on average.
inline constexpr double kMostCover = 0.05;
inline constexpr int kGrainVariants = 4;

struct Grain {
  int classLevel = 0;
  std::uint64_t column = 0, row = 0;  ///< the cell of its class, on its face (grain_cells.h)
  glm::dvec2 cells{0.0};  ///< where its root is, in cells of the tile's mesh along i and j from vertex (0, 0)
  float diameterMeters = 0;
  float flattening = 1;          ///< height over width
  float centerHeight = 0;        ///< of its middle over the ground, in half heights; below 0 it is more than half sunk
  float shade = 1;               ///< its reflectance as a multiple of the ground's
  int variant = 0;               ///< of its shape, 0..kGrainVariants - 1
  float turn[4] = {0, 0, 0, 1};  ///< a unit quaternion x, y, z, w: uniform over all rotations
};

class GrainField {
 public:
  /// Precondition: 0 < smallestMeters <= largestMeters, radiusMeters > 0.
  GrainField(const DustSettings& settings, double radiusMeters, Scheme scheme) noexcept;

  /// The classes that have grains: those whose middle size is among the sizes wanted; none if coarsest > finest.
  int coarsestClass() const noexcept { return coarsest_; }
  int finestClass() const noexcept { return finest_; }
  /// No grain of a class is wider.
  double largestMeters(int classLevel) const noexcept;

  /// Appends the grains of one class whose roots lie in the tile, cell by cell. Precondition: a tile of the scheme;
  /// classLevel <= tile.level().
  void collect(const FacePath& tile, int classLevel, std::vector<Grain>& grains) const;

 private:
  double cellMeters(int classLevel) const noexcept;
  template <class Cell>
  void collectFrom(const FacePath& tile, int classLevel, std::vector<Grain>& grains) const;

  DustSettings settings_;
  double radiusMeters_;
  Scheme scheme_;
  int coarsest_ = 0, finest_ = -1;
};

}  // namespace terrane
