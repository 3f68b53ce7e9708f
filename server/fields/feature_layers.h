#pragma once
// Craters and rocks as hashed grids: a layer is one size class, D in [2^k, 2^(k+1)) metres, on a grid of the six
// equi-angular cube faces whose cells are 2 * 2^(k+1) metres wide; a cell holds at most one feature, placed by a hash
// of the cell. Sizes within a class follow the cumulative power law D^-2. Body frame, metres. Immutable after
// construction, thread-safe.
//
// What the bounds stand on (feature_layers_test checks both):
// 1. A feature's bowl lies within its own cell, so no two bowls of a layer overlap.
// 2. Its apron reaches beyond its cell by less than half of the narrowest cell's width, so at most four features of a
// layer touch a
//    point: its own cell's and those across one side, one other side, and the corner between them.
//
// Morphometry: depth 0.2 D for fresh simple craters (Pike 1977), shallower for small ones (Stopar et al. 2017: 0.18 at
// 400 m, 0.15 at 100-200 m, 0.12 at 30-100 m); rim 0.036 D^1.014; above 16 km complex: depth 1.044 D^0.301, rim 0.236
// D^0.399 (kilometres), with flat floors and central peaks (Pike 1977). Wear makes them shallower and rounder.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/fields/feature_target.h"
#include "server/fields/lunar_program.h"
#include "server/fields/mix_hash.h"

namespace terrane::lunar {

/// Young craters up to this wear have a halo.
inline constexpr double kHaloWear = 0.12;

struct FeatureLayer {
  FeatureStage stage = FeatureStage::YoungCrater;
  int exponent = 0;  ///< D in [2^exponent, 2^(exponent + 1)) metres
  std::uint64_t seed = 0;
  std::uint32_t cellsPerFace = 1;
  double occupancy = 0;             ///< share of cells that hold a feature
  double wearMin = 0, wearMax = 0;  ///< 0 fresh, 1 hardly visible
  double wearSkew = 1;              ///< > 1: mostly worn; < 1: mostly fresh (a blend of u and 1 - (1 - u)^2)

  double smallestDiameter() const noexcept;
  double largestDiameter() const noexcept { return 2 * smallestDiameter(); }
  /// A feature's wavelength is its radius: a level shows it, fading in with its size, from two cells on. These are the
  /// layer's shortest and longest.
  double wavelengthMeters() const noexcept { return 0.5 * smallestDiameter(); }
  double longestWavelengthMeters() const noexcept { return 0.5 * largestDiameter(); }
  /// A halo's wavelength is its own radius: it is seen where the crater in it is not yet.
  bool hasHalos() const noexcept { return stage == FeatureStage::YoungCrater && wearMin < kHaloWear; }
  double longestHaloMeters() const noexcept { return kHaloRadii * longestWavelengthMeters(); }
};

/// The outline's lobes stay within 1 +- this.
inline constexpr double kCraterLobes = 0.10;
inline constexpr double kRockLobes = 0.24;
/// A rock is at most this many radii high.
inline constexpr double kRockHeight = 0.9;

/// What a crater of this diameter looks like before wear, metres.
struct Morphometry {
  double depth, rim;   ///< rim crest to floor; rim above the surroundings
  double floorRadius;  ///< of the flat floor, in crater radii
  double peak;
};
Morphometry freshCrater(double diameterMeters) noexcept;

/// A crater at a unit direction; hash gives its orientation and outline. wear in 0..1.
Feature makeCrater(const double direction[3], double bodyRadius, double diameter, double wear,
                   std::uint64_t hash) noexcept;

/// Around a crater, in its tangent frame. rays: how much of the brightness they sway by.
Halo makeHalo(const Feature& crater, double brightness, double rays) noexcept;

/// Layers from coarse to fine for a body (feature_layer_table.cpp).
struct LayerSettings {
  double radiusMeters = 0, craterDensity = 1, rockDensity = 1, finestDetailMeters = 0;
  std::uint64_t seed = 0;
};
std::vector<FeatureLayer> makeLayers(const LayerSettings& settings);

/// Appends every feature of the layer that may reach the target (a PatchTarget or a RowTarget), in the order face, row,
/// column.
template <class Target>
void gatherFeatures(const FeatureLayer& layer, double bodyRadius, const Target& target, std::vector<Feature>& out);

/// In the same way the halos of the layer's craters.
void gatherHalos(const FeatureLayer& layer, double bodyRadius, const PatchTarget& patch, std::vector<Halo>& out);

/// The feature of one cell, if it has one.
bool featureOfCell(const FeatureLayer& layer, double bodyRadius, int face, std::uint32_t column, std::uint32_t row,
                   Feature& out);

}  // namespace terrane::lunar
