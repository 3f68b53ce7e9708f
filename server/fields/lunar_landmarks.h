#pragma once
// The places that make the Moon recognisable: its great basins, the lava plains, and the young craters with rays.
// Positions and diameters after the IAU Gazetteer of Planetary Nomenclature, depths rounded from published altimetry;
// sizes are for the Moon's radius and scale with the body's. Directions are written out as numbers (x, y, z for
// longitude 0 on +X, north on +Z) because no trigonometry may reach a tile; they are normalised on use.

#include <span>

namespace terrane::lunar {

/// The radius that the table's lengths belong to.
inline constexpr double kTableRadiusMeters = 1737400.0;

struct BasinRow {
  double direction[3];
  double radiusKm, depthMeters, ringMeters;
};
struct LavaRow {
  double direction[3];
  double reachKm;  ///< no lava beyond
  double inner;    ///< part of the reach within which lava stands at its full level
};
struct CraterRow {
  double direction[3];
  double diameterKm;
  double youth;  ///< strength of its rays, 0 = none
};

std::span<const BasinRow> basinTable() noexcept;
std::span<const LavaRow> lavaTable() noexcept;
std::span<const CraterRow> craterTable() noexcept;

}  // namespace terrane::lunar
