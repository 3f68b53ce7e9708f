#include "server/fields/midpoint_displacement.h"

#include <algorithm>
#include <cmath>

#include "common/numerics/strict_math.h"
#include "common/tiling/lattice.h"
#include "server/fields/height_field.h"
#include "server/fields/mix_hash.h"

namespace terrane {
namespace {

/// Mean, product and sum each round once or twice: by less than this part of the largest height, a level.
constexpr double kRoundingPerLevel = 0x1p-51;

/// The shortest edge of a grid, in nominal widths (midpoint_displacement_test): in the middle of a cube's edge, and on
/// the whole faces of the icosahedron.
constexpr double shortestEdge(Scheme scheme) noexcept { return scheme == Scheme::Cube ? 0.7071 : 0.9497; }

/// Cells of 128 to a tile.
constexpr int kMostCellLevels = 7;

/// What the margin of a tile's skirts, their sag and the lattice's rounding take of its room: some ten steps of 65,535,
/// and more at the coarsest levels, which have room to spare. (The finer vertices that skirts hang down to are in the
/// relief.)
constexpr double kWithoutSkirts = 0.99;

}  // namespace

double powerOfLevel(int level, double exponent) noexcept {
  double power = 1.0;
  double whole = std::floor(exponent), rest = exponent - whole;
  for (; whole > 0; whole -= 1.0) power *= level;
  // The binary digits of the rest: level^(1/2), level^(1/4), ...
  for (double root = level; rest > 0;) {
    root = std::sqrt(root);
    rest *= 2.0;
    if (rest < 1.0) continue;
    power *= root;
    rest -= 1.0;
  }
  return power;
}

MidpointDisplacement::MidpointDisplacement(double amplitudeMeters, double regularity, std::uint64_t seed) noexcept {
  largest_[0] = amplitudeMeters;
  double half = 1.0;
  for (int level = 1; level <= kFinestGridLevel; ++level) {
    half *= 0.5;
    largest_[static_cast<std::size_t>(level)] = amplitudeMeters * half * powerOfLevel(level, regularity);
  }
  for (std::size_t level = 0; level < seeds_.size(); ++level) seeds_[level] = mixHash(mixHash(seed) + level);
}

double MidpointDisplacement::meters(int gridLevel, const VertexKey& key) const noexcept {
  const auto level = static_cast<std::size_t>(gridLevel);
  std::uint64_t hash = mixHash(seeds_[level] ^ static_cast<std::uint64_t>(key.a));
  hash = mixHash(hash + static_cast<std::uint64_t>(key.b));
  hash = mixHash(hash + static_cast<std::uint64_t>(key.c));
  return largest_[level] * (2.0 * hashUnit(hash) - 1.0);
}

double MidpointDisplacement::largestSumMeters(int coarse, int finest) const noexcept {
  double sum = 0;
  for (int level = coarse + 1; level <= finest; ++level) sum += largestMeters(level);
  return sum + std::max(0, finest - coarse) * kRoundingPerLevel * largestHeightMeters();
}

double MidpointDisplacement::largestHeightMeters() const noexcept {
  double sum = 0;
  for (const double largest : largest_) sum += largest;
  return sum * (1.0 + (kFinestGridLevel + 1) * kRoundingPerLevel);
}

double MidpointDisplacement::largestRiseMeters(int gridLevel) const noexcept {
  double rise = 2.0 * largestMeters(0);
  for (int level = 1; level <= gridLevel; ++level) rise = 0.5 * rise + 2.0 * largestMeters(level);
  return rise;
}

double MidpointDisplacement::largestReliefMeters(Scheme scheme, int level) const noexcept {
  return (scheme == Scheme::Cube ? 2.0 : 1.0) * largestRiseMeters(level) +
         2.0 * largestSumMeters(level, kFinestGridLevel);
}

double mostAmplitudeMeters(double radiusMeters, Scheme scheme, double regularity) noexcept {
  const MidpointDisplacement unit(1.0, regularity, 0);
  double most = kMostHeight * radiusMeters / unit.largestHeightMeters();
  for (int level = 0; level <= maxLevel(radiusMeters, scheme); ++level) {
    const double width = nominalTileWidthMeters(radiusMeters, level, scheme);
    const double room = kTileOffsetMax * stepMeters(stepExponent(radiusMeters, level, scheme)) * kWithoutSkirts;
    const double along = farthestPoints(scheme) * width;
    most = std::min(most, std::sqrt(room * room - along * along) / unit.largestReliefMeters(scheme, level));
    const double cell = std::ldexp(width, -kMostCellLevels);
    const double rise = unit.largestRiseMeters(level + kMostCellLevels);
    most = std::min(most, kSteepestSlope * shortestEdge(scheme) * cell / rise);
  }
  return most;
}

}  // namespace terrane
