#include "server/fields/feature_gathering.h"

#include <cmath>

#include "common/numerics/strict_math.h"

namespace terrane::lunar {
namespace {

/// Craters from 1 km up are computed in double at fine levels.
constexpr int kDoubleExponent = 10;
/// A ball is gathered a little larger than asked: a border's samples between the vertices bulge out of the tile's ball.
constexpr double kSlack = 1.01;
/// What was gathered for a ball this many times larger would rather be gathered anew: most of it would be out of reach.
constexpr double kMostExcess = 2.5;

double distance(const double a[3], const double b[3]) noexcept {
  const double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

}  // namespace

bool FeatureGathering::covers(const FeatureTables& tables, const PointSet& points) const noexcept {
  if (tables_.get() != &tables || ball_.radius > kMostExcess * points.ball.radius) return false;
  const double limit = ball_.radius * ball_.radius;
  for (std::size_t i = 0; i < points.count; ++i) {
    const double dx = points.x[i] * points.scale - ball_.center[0], dy = points.y[i] * points.scale - ball_.center[1],
                 dz = points.z[i] * points.scale - ball_.center[2];
    if (!(dx * dx + dy * dy + dz * dz <= limit)) return false;
  }
  return true;
}

void FeatureGathering::start(const std::shared_ptr<const FeatureTables>& tables, const Ball& ball) {
  tables_ = tables;
  ball_ = ball;
  ball_.radius *= kSlack;
  features_.clear();
  layerEnds_.clear();
  landmarks_.clear();
  halos_.clear();
  haloEnds_.clear();
  for (const Halo& h : tables->landmarkHalos)
    if (distance(h.center, ball_.center) <= h.reach + ball_.radius) halos_.push_back(h);
  haloEnds_.push_back(halos_.size());
  for (const Feature& f : tables->landmarks)
    if (distance(f.center, ball_.center) <= f.reach + ball_.radius) landmarks_.push_back(f);
}

GatheredFeatures FeatureGathering::near(const std::shared_ptr<const FeatureTables>& tables, const PointSet& points,
                                        const FeatureWants& wants) {
  if (!covers(*tables, points)) start(tables, points.ball);
  return {runs(wants.minWavelengthMeters, wants.inDouble),
          wants.halos ? halos(wants.minWavelengthMeters) : std::span<const Halo>()};
}

std::span<const FeatureRun> FeatureGathering::runs(double minWavelength, bool inDouble) {
  const std::vector<FeatureLayer>& layers = tables_->layers;
  std::size_t count = 0;
  while (count < layers.size() && layers[count].longestWavelengthMeters() >= minWavelength) ++count;
  while (layerEnds_.size() < count) {
    gatherFeatures(layers[layerEnds_.size()], tables_->bodyRadius, ball_.center, ball_.radius, features_);
    layerEnds_.push_back(features_.size());
  }
  runs_.clear();
  for (std::size_t i = 0, begin = 0; i < count; begin = layerEnds_[i++]) {
    if (layerEnds_[i] == begin) continue;
    runs_.push_back({features_.data() + begin, layerEnds_[i] - begin, layers[i].stage,
                     inDouble && layers[i].exponent >= kDoubleExponent});
  }
  std::size_t shown = 0;
  while (shown < landmarks_.size() && landmarks_[shown].radius >= minWavelength) ++shown;
  if (shown > 0) runs_.push_back({landmarks_.data(), shown, FeatureStage::YoungCrater, inDouble});
  return runs_;
}

std::span<const Halo> FeatureGathering::halos(double minWavelength) {
  const std::vector<FeatureLayer>& layers = tables_->layers;
  std::size_t count = 0;
  while (count < layers.size() && layers[count].longestHaloMeters() >= minWavelength) ++count;
  while (haloEnds_.size() <= count) {
    gatherHalos(layers[haloEnds_.size() - 1], tables_->bodyRadius, ball_.center, ball_.radius, halos_);
    haloEnds_.push_back(halos_.size());
  }
  return std::span(halos_).first(haloEnds_[count]);
}

}  // namespace terrane::lunar
