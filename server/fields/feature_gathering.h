#pragma once
// The craters, their halos and the rocks near a patch of ground, gathered once for all batches that lie in it: a tile's
// grid, then its borders at the levels beside it. What only the borders ask for is gathered near them alone. Body
// frame, metres. Belongs to one thread.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/fields/feature_layers.h"
#include "server/fields/lunar_program.h"

namespace terrane::lunar {

/// All features of a body. Immutable once made.
struct FeatureTables {
  double bodyRadius = 0;
  std::vector<FeatureLayer> layers;  ///< coarse to fine
  std::vector<Feature> landmarks;    ///< by falling size
  std::vector<Halo> landmarkHalos;
};

/// What a batch asks for.
struct FeatureWants {
  double minWavelengthMeters;
  /// The points are a row within what is gathered already, of which heights alone are asked for: no halos, and of the
  /// finest layers, which few ask for, only what is near them, not kept.
  bool border;
};

struct GatheredFeatures {
  std::span<const FeatureRun> runs;
  std::span<const Halo> halos;
};

class FeatureGathering {
 public:
  /// Features that may reach any of the points, of all layers with wavelengths of at least wants.minWavelengthMeters,
  /// coarse to fine, within a layer by face, row and column, landmarks last (of halos first): the order of the sums.
  /// Valid until the next call.
  GatheredFeatures near(const std::shared_ptr<const FeatureTables>& tables, const PointSet& points,
                        const FeatureWants& wants);
  /// Changes whenever what is kept of craters and rocks does.
  std::uint64_t version() const noexcept { return version_; }

 private:
  bool covers(const FeatureTables& tables, const PointSet& points) const noexcept;
  std::span<const FeatureRun> runs(const PointSet& points, const FeatureWants& wants);
  /// Gathers the first count layers for the patch.
  void gatherForPatch(std::size_t count);
  std::span<const Halo> halos(double minWavelength);
  void start(const std::shared_ptr<const FeatureTables>& tables, const PointSet& points);

  std::shared_ptr<const FeatureTables> tables_;  ///< held, so that it is never mistaken for another's
  PatchTarget patch_{Ball{}};
  std::uint64_t version_ = 0;
  std::vector<Feature> features_, landmarks_;
  std::vector<Halo> halos_;
  std::vector<std::size_t> layerEnds_,
      haloEnds_;  ///< of the layers gathered so far; of the landmarks' halos before them
  std::vector<Feature> rowFeatures_;
  std::vector<std::size_t> rowEnds_;
  std::vector<FeatureRun> runs_;
};

}  // namespace terrane::lunar
