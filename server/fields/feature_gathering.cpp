#include "server/fields/feature_gathering.h"

#include "common/numerics/strict_math.h"

namespace terrane::lunar {
namespace {

/// Features are gathered for a patch larger than asked by this share of its width on either side: a border's samples
/// between the vertices bulge out of the tile's ball.
constexpr double kSlack = 0.005;
/// What was gathered for a ball this many times larger would rather be gathered anew: most of it would be out of reach.
constexpr double kMostExcess = 2.5;

}  // namespace

bool FeatureGathering::covers(const FeatureTables& tables, const PointSet& points) const noexcept {
  return tables_.get() == &tables && patch_.ball().radius <= kMostExcess * points.ball.radius && patch_.holds(points);
}

void FeatureGathering::start(const std::shared_ptr<const FeatureTables>& tables, const PointSet& points) {
  ++version_;
  tables_ = tables;
  PointSet wider = points;
  wider.ball.radius *= 1 + 2 * kSlack;
  patch_ = PatchTarget(wider, kSlack);
  features_.clear();
  layerEnds_.clear();
  landmarks_.clear();
  halos_.clear();
  haloEnds_.clear();
  for (const Halo& h : tables->landmarkHalos)
    if (patch_.touchedFrom(h.center, 1, h.reach)) halos_.push_back(h);
  haloEnds_.push_back(halos_.size());
  for (const Feature& f : tables->landmarks)
    if (patch_.touchedFrom(f.center, 1, f.reach)) landmarks_.push_back(f);
}

GatheredFeatures FeatureGathering::near(const std::shared_ptr<const FeatureTables>& tables, const PointSet& points,
                                        const FeatureWants& wants) {
  if (!covers(*tables, points)) start(tables, points);
  return {runs(points, wants), wants.border ? std::span<const Halo>() : halos(wants.minWavelengthMeters)};
}

void FeatureGathering::gatherForPatch(std::size_t count) {
  if (layerEnds_.size() < count) ++version_;
  while (layerEnds_.size() < count) {
    gatherFeatures(tables_->layers[layerEnds_.size()], tables_->bodyRadius, patch_, features_);
    layerEnds_.push_back(features_.size());
  }
}

std::span<const FeatureRun> FeatureGathering::runs(const PointSet& points, const FeatureWants& wants) {
  const std::vector<FeatureLayer>& layers = tables_->layers;
  std::size_t count = 0;
  while (count < layers.size() && layers[count].longestWavelengthMeters() >= wants.minWavelengthMeters) ++count;
  if (!wants.border) gatherForPatch(count);
  runs_.clear();
  const double doubleFrom = kDoubleRadii * wants.minWavelengthMeters;
  const auto add = [&](const std::vector<Feature>& from, std::size_t begin, std::size_t end,
                       const FeatureLayer& layer) {
    if (begin == end) return;
    runs_.push_back({from.data() + begin, end - begin, layer.stage, layer.wavelengthMeters() >= doubleFrom});
  };
  const std::size_t kept = std::min(count, layerEnds_.size());
  for (std::size_t i = 0, begin = 0; i < kept; begin = layerEnds_[i++]) add(features_, begin, layerEnds_[i], layers[i]);
  if (kept < count) {
    const RowTarget row(points);
    rowFeatures_.clear();
    rowEnds_.clear();
    for (std::size_t i = kept; i < count; ++i) {
      gatherFeatures(layers[i], tables_->bodyRadius, row, rowFeatures_);
      rowEnds_.push_back(rowFeatures_.size());
    }
    for (std::size_t i = kept, begin = 0; i < count; begin = rowEnds_[i++ - kept])
      add(rowFeatures_, begin, rowEnds_[i - kept], layers[i]);
  }
  const auto landmarksFrom = [&](double radius) {
    std::size_t n = 0;
    while (n < landmarks_.size() && landmarks_[n].radius >= radius) ++n;
    return n;
  };
  const std::size_t large = landmarksFrom(doubleFrom), shown = landmarksFrom(wants.minWavelengthMeters);
  if (large > 0) runs_.push_back({landmarks_.data(), large, FeatureStage::YoungCrater, true});
  if (shown > large) runs_.push_back({landmarks_.data() + large, shown - large, FeatureStage::YoungCrater, false});
  return runs_;
}

std::span<const Halo> FeatureGathering::halos(double minWavelength) {
  const std::vector<FeatureLayer>& layers = tables_->layers;
  std::size_t count = 0;
  while (count < layers.size() && layers[count].longestHaloMeters() >= minWavelength) ++count;
  while (haloEnds_.size() <= count) {
    gatherHalos(layers[haloEnds_.size() - 1], tables_->bodyRadius, patch_, halos_);
    haloEnds_.push_back(halos_.size());
  }
  return std::span(halos_).first(haloEnds_[count]);
}

}  // namespace terrane::lunar
