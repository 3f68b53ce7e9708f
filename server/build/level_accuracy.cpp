#include "server/build/level_accuracy.h"

#include <algorithm>

#include "common/numerics/strict_math.h"
#include "common/tiling/lattice.h"

namespace terrane {
namespace {

/// Heights of neighbouring vertices differ by at most this many times their distance (63 degrees; tile_builder_test holds the lunar field
/// to it). It only enters the sag below, in second order.
constexpr double kSteepestSlope = 2.0;

double cellMeters(double radiusMeters, int level, int cellsPerEdge) noexcept {
  return nominalTileWidthMeters(radiusMeters, level) / cellsPerEdge;
}

/// How far a straight edge may lie below the surface that interpolates its ends' heights over a sphere: c^2 / 8 r for level ends, and
/// dr^2 / 4 r more where they differ by dr (in the middle direction a chord is at the harmonic mean of its ends' radii).
double sagMeters(double cell, double lowestRadius) noexcept {
  return cell * cell * (1.0 + 2.0 * kSteepestSlope * kSteepestSlope) / (8.0 * lowestRadius);
}

}  // namespace

double roundingMeters(double radiusMeters, int level) noexcept {
  return 0.8660254037844387 * stepMeters(stepExponent(radiusMeters, level));
}

std::vector<LevelAccuracy> levelAccuracies(const HeightField& field, double radiusMeters, int cellsPerEdge, int maxLevel) {
  const double finest = 2.0 * cellMeters(radiusMeters, maxLevel, cellsPerEdge);
  const double lowestRadius = radiusMeters + field.heightRange().minMeters;
  std::vector<LevelAccuracy> levels(static_cast<std::size_t>(maxLevel) + 1);
  // Between a level and the next finer one; none below the last.
  std::vector<double> gaps(levels.size(), 0.0);
  for (int level = 0; level <= maxLevel; ++level) {
    const auto index = static_cast<std::size_t>(level);
    const double cell = cellMeters(radiusMeters, level, cellsPerEdge);
    LevelAccuracy& accuracy = levels[index];
    accuracy.minWavelengthMeters = 2.0 * cell;
    accuracy.geometricErrorMeters = kErrorPerCell * cell;
    if (level == maxLevel) break;
    const double interpolation = field.interpolationErrorMeters(2.0 * cell, cell);
    accuracy.subtreeSlackMeters = field.omittedAmplitudeMeters(2.0 * cell, finest) + interpolation;
    gaps[index] = field.omittedAmplitudeMeters(2.0 * cell, cell) + interpolation + sagMeters(cell, lowestRadius) +
                  roundingMeters(radiusMeters, level) + roundingMeters(radiusMeters, level + 1);
  }
  // From the finest up, so that a skirt is never shorter than a descendant's: bounds of a tile then hold for its subtree's skirts too.
  double deepest = 0;
  for (std::size_t level = levels.size(); level-- > 0;) {
    deepest = std::max({deepest, gaps[level], level > 0 ? gaps[level - 1] : 0.0});
    levels[level].skirtMeters = deepest;
  }
  return levels;
}

}  // namespace terrane
