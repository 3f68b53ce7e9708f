#include "server/build/level_accuracy.h"

#include <algorithm>

#include "common/numerics/strict_math.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"

namespace terrane {
namespace {

/// Of a cell's edge, in its nominal width.
double longestEdge(Scheme scheme) noexcept { return scheme == Scheme::Cube ? 1.0 : kIcoLongestEdge; }

/// How far a straight edge may lie below the surface that interpolates its ends' heights over a sphere: c^2 / 8 r for
/// level ends, and dr^2 / 4 r more where they differ by dr, kSteepestSlope times their distance at most (in the middle
/// direction a chord is at the harmonic mean of its ends' radii).
double sagMeters(double cell, double lowestRadius, double heightSpan) noexcept {
  const double rise = std::min(kSteepestSlope * cell, heightSpan);
  return (0.5 * cell * cell + rise * rise) / (4.0 * lowestRadius);
}

/// How far a skirt hangs below the lowest of the edges that may meet it, so that the lattice's rounding opens nothing:
/// half a step in each axis for a vertex of the tile, twice that for one of a coarser neighbour. Nor what the tolerance
/// of the skirt's and both tiles' heights does. And by a corner's lean, which takes the skirt's end along the edge by
/// less than that: up ground of 45 degrees, as much too high. The field's own rounding comes on top.
double skirtMarginMeters(double radiusMeters, int level, Scheme scheme) noexcept {
  return (3.0 * 0.8660254037844387 + 4.0 * kToleranceSteps + skirtCornerFlareSteps(scheme)) *
         stepMeters(stepExponent(radiusMeters, level, scheme));
}

}  // namespace

std::vector<LevelAccuracy> levelAccuracies(const HeightField& field, double radiusMeters, Scheme scheme,
                                           int cellsPerEdge, int maxLevel) {
  const auto cellMeters = [&](int level) { return nominalTileWidthMeters(radiusMeters, level, scheme) / cellsPerEdge; };
  const double finest = 2.0 * cellMeters(maxLevel);
  const HeightRange heights = field.heightRange();
  const double span = heights.maxMeters - heights.minMeters;
  std::vector<LevelAccuracy> levels;
  for (int level = 0; level <= maxLevel; ++level) {
    const double cell = cellMeters(level);
    LevelAccuracy accuracy;
    accuracy.minWavelengthMeters = 2.0 * cell;
    accuracy.toleranceMeters = kToleranceSteps * stepMeters(stepExponent(radiusMeters, level, scheme));
    accuracy.geometricErrorMeters = kErrorPerCell * cell;
    // Of the skirt's heights and the neighbour's, which may be of the coarser level.
    accuracy.skirtMarginMeters =
        skirtMarginMeters(radiusMeters, level, scheme) + 2.0 * field.roundingMeters(4.0 * cell);
    accuracy.skirtSlackMeters =
        accuracy.skirtMarginMeters + sagMeters(longestEdge(scheme) * cell, radiusMeters + heights.minMeters, span);
    if (level < maxLevel) {
      // The bound for square cells holds for triangles too: both rest on the mean square distance of a point from the
      // vertices it lies between, which is the half diagonal's at most, s^2 / 2, and the squared circumradius of an
      // acute triangle, (1.2 s)^2 / 3. No two heights differ by more than the field's whole range: at the coarsest
      // levels that is the better bound.
      accuracy.subtreeSlackMeters =
          std::min(span, 2.0 * accuracy.toleranceMeters + field.omittedAmplitudeMeters(2.0 * cell, finest) +
                             field.interpolationErrorMeters(2.0 * cell, cell));
    }
    levels.push_back(accuracy);
  }
  return levels;
}

}  // namespace terrane
