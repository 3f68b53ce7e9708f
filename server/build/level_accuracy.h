#pragma once
// What each level of a body leaves out, and what follows from it: how far descendants may reach beyond a tile's own
// heights, and the geometric error that selection works with. Metres, along the vertical. From the field's proven
// bounds; computed once for a body. Thread-safe.

#include <vector>

#include "common/tiling/face_path.h"
#include "server/fields/height_field.h"

namespace terrane {

struct LevelAccuracy {
  double minWavelengthMeters = 0;   ///< the field is sampled down to here: two cells
  double subtreeSlackMeters = 0;    ///< proven: no descendant's terrain leaves the tile's own vertex heights by more
  double skirtMarginMeters = 0;     ///< skirts hang this far below what they must cover (level_accuracy.cpp)
  double skirtSlackMeters = 0;      ///< proven: no skirt hangs further below the lowest terrain around it (skirt.h)
  double toleranceMeters = 0;       ///< how far a tile's heights may be from the field's: kToleranceSteps
  double geometricErrorMeters = 0;  ///< estimate, strictly decreasing with the level; see kErrorPerCell
};

/// Geometric error of a level, in widths of its cells. The deepest thing that a level leaves out is a crater whose
/// radius is the shortest wavelength it shows, two cells. Fresh, it is 0.196 of its width deep (Pike 1977,
/// "Size-dependence in the shape of fresh impact craters on the moon"): 0.8 cells; worn as most are, half that. At the
/// default tolerance of 2 pixels a cell then covers up to 5 pixels. The sum of all octaves' worst cases, which
/// subtreeSlackMeters is, would be several times that, and never seen.
inline constexpr double kErrorPerCell = 0.4;

/// In steps of the tile's lattice, which rounds by up to half a step in each axis: little beside that.
inline constexpr double kToleranceSteps = 1.0 / 64;

/// Levels 0 .. maxLevel.
std::vector<LevelAccuracy> levelAccuracies(const HeightField& field, double radiusMeters, Scheme scheme,
                                           int cellsPerEdge, int maxLevel);

}  // namespace terrane
