// LunarField::evaluate: batches cut into blocks, with the features near them, run through the kernels.

#include <algorithm>
#include <cmath>
#include <span>

#include "common/numerics/strict_math.h"
#include "common/tiling/tile_grid.h"
#include "server/fields/far_field.h"
#include "server/fields/far_fit.h"
#include "server/fields/far_ground.h"
#include "server/fields/lunar_field.h"
#include "server/fields/sample_blocks.h"

namespace terrane {

using namespace lunar;

/// One a calling thread; grows to its steady state with the first tiles.
struct SurfaceSamples::Scratch {
  Block block;
  FeatureGathering gathering;
  std::vector<NoiseGroup> groups;
  std::vector<SampleBlocks> blocks;  ///< of the shapes of batches seen last
  std::vector<double> borderPoints[3];
  FarField farField;
  FarExpansion expansion;
  /// What the expansion is of: only the edges of the same tile may be added to it.
  std::shared_ptr<const FeatureTables> expandedFor;
  FacePath expandedPath;
  std::uint64_t expandedFeatures = 0;  ///< version of the gathering
};

namespace {

constexpr std::size_t kLanes = 4;  ///< worked on side by side, for the compiler to make vectors of

double farthestFrom(const double center[3], const double* x, const double* y, const double* z,
                    std::size_t count) noexcept {
  const double cx = center[0], cy = center[1], cz = center[2];
  double squares[kLanes] = {};
  const auto add = [&](std::size_t i, std::size_t lane) {
    const double dx = x[i] - cx, dy = y[i] - cy, dz = z[i] - cz;
    const double square = (dx * dx + dy * dy) + dz * dz;
    squares[lane] = square > squares[lane] ? square : squares[lane];
  };
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
  for (; i < count; ++i) add(i, 0);
  return std::sqrt(*std::max_element(squares, squares + kLanes)) * (1 + 1e-9);
}

/// The middle of the least and the largest.
double middleOf(const double* v, std::size_t count) noexcept {
  double low[kLanes], high[kLanes];
  std::fill(low, low + kLanes, v[0]);
  std::fill(high, high + kLanes, v[0]);
  const auto add = [&](std::size_t i, std::size_t lane) {
    low[lane] = v[i] < low[lane] ? v[i] : low[lane];
    high[lane] = v[i] > high[lane] ? v[i] : high[lane];
  };
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
  for (; i < count; ++i) add(i, 0);
  return 0.5 * (*std::min_element(low, low + kLanes) + *std::max_element(high, high + kLanes));
}

/// Around directions, and all within a border of them: of a part of a sphere that does not go half round it the
/// farthest point from anywhere above it lies on its border.
Ball boundingBall(const double* x, const double* y, const double* z, std::size_t count, double radius) noexcept {
  Ball ball{{middleOf(x, count), middleOf(y, count), middleOf(z, count)}, 0};
  ball.radius = farthestFrom(ball.center, x, y, z, count);
  for (double& c : ball.center) c *= radius;
  ball.radius = (ball.radius + 1e-9) * radius;
  return ball;
}

}  // namespace

/// What a batch needs beside the field: the tables cut to its wavelength, and the features near it.
class LunarField::Evaluation {
 public:
  Evaluation(const LunarField& field, const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out)
      : field_(field),
        batch_(batch),
        minWavelength_(minWavelengthMeters),
        out_(out),
        scratch_(*out.scratch),
        program_(field.base_) {
    program_.heightsOnly = isEdge();
    program_.footprint = batch.footprintMeters;
    program_.minWavelength = minWavelengthMeters;
    scratch_.groups.clear();
    for (NoiseGroup group : field.groups_) {
      while (group.count > 0 && group.octaves[group.count - 1].inverseWavelength * minWavelengthMeters > 1)
        --group.count;
      scratch_.groups.push_back(group);
    }
    program_.relief = scratch_.groups.front();
    program_.regolith = scratch_.groups.data() + 1;
    while (program_.regolithCount + 1 < scratch_.groups.size() && program_.regolith[program_.regolithCount].count > 0) {
      ++program_.regolithCount;
    }
    program_.doubleWavelength = kDoubleWavelengths * minWavelengthMeters;
    double finest = radius();
    for (const FeatureLayer& layer : field.features_->layers) {
      if (layer.longestWavelengthMeters() >= minWavelengthMeters) finest = layer.wavelengthMeters();
    }
    widestBall_ = kWidestBall * finest;
  }

  /// Features are gathered for the whole batch where it is compact, as tiles are, else for each block, else for each
  /// sample: a ball over half the Moon would hold more pebbles than there is time.
  void run() {
    const bool isGrid = batch_.grid && !isEdge();
    PointSet points{batch_.x, batch_.y, batch_.z, batch_.count(), radius(), {}};
    if (isGrid) points = borderPoints();
    points.ball = boundingBall(points.x, points.y, points.z, points.count, radius());
    const bool compact = points.ball.radius <= widestBall_;
    if (compact) gather(points);
    const bool mayExpand = compact && batch_.grid && batch_.toleranceMeters > kLeastTolerance * radius();
    if (mayExpand && isEdge() && isExpanded()) program_ = scratch_.farField.nearOf(program_, scratch_.expansion);
    if (!mayExpand || !isGrid || !expand(points)) {
      const SampleBlocks& all = blocks(std::nullopt);
      for (std::size_t k = 0; k < all.count(); ++k) evaluateBlock(all[k], compact);
      return;
    }
    // Vertices of the border are evaluated in full: other tiles share them, and must come to the same bits.
    const SampleBlocks& parts = blocks(gridOfTile());
    for (std::size_t k = parts.insideCount(); k < parts.count(); ++k) evaluateBlock(parts[k], true);
    const Program whole = program_;
    program_ = scratch_.farField.nearOf(whole, scratch_.expansion);
    if (showsAllOldGround()) simplifyGround(program_, scratch_.farField.patch().ball, scratch_.expansion);
    if (scratch_.expansion.ground == FarGround::Lava) program_ = scratch_.farField.nearOf(whole, scratch_.expansion);
    for (std::size_t k = 0; k < parts.insideCount(); ++k) evaluateBlock(parts[k], true);
  }

 private:
  /// In radii of the body: what a position's doubles round, some times over.
  static constexpr double kLeastTolerance = 0x1p-48;
  /// A patch flatter than this is expanded: the sphere bends too much over others.
  static constexpr double kLeastSphereRadii = 16;
  static constexpr double kWidestBall =
      300;  ///< in wavelengths of the finest layer; a tile has a ball of some 25 to 50

  double radius() const noexcept { return field_.radius_; }
  bool isEdge() const noexcept { return batch_.grid && !batch_.grid->isWholeGrid(); }
  TileGrid gridOfTile() const noexcept { return {batch_.grid->path.scheme(), batch_.grid->cellsPerEdge}; }
  bool isExpanded() const noexcept {
    return scratch_.expandedFor == field_.features_ && scratch_.expandedPath == batch_.grid->path &&
           scratch_.expandedFeatures == scratch_.gathering.version();
  }
  /// Whether no finer level shows more relief or old craters.
  bool showsAllOldGround() const noexcept {
    const NoiseGroup& relief = field_.groups_.front();
    const auto isShown = [&](const FeatureLayer& layer) {
      return layer.stage != FeatureStage::OldCrater || layer.wavelengthMeters() >= minWavelength_;
    };
    return (relief.count == 0 || relief.octaves[relief.count - 1].inverseWavelength * minWavelength_ <= 1) &&
           std::ranges::all_of(field_.features_->layers, isShown);
  }
  const SampleBlocks& blocks(const std::optional<TileGrid>& grid) {
    constexpr std::size_t kMostShapes = 8;
    std::vector<SampleBlocks>& known = scratch_.blocks;
    for (const SampleBlocks& one : known)
      if (one.isOf(batch_.rows, batch_.rowLength, grid)) return one;
    if (known.size() == kMostShapes) known.erase(known.begin());
    return known.emplace_back(batch_.rows, batch_.rowLength, grid);
  }

  /// A grid's border spans all of it.
  PointSet borderPoints() {
    const SampleBlocks& parts = blocks(gridOfTile());
    std::vector<double>* axes = scratch_.borderPoints;
    for (int a = 0; a < 3; ++a) axes[a].clear();
    for (std::size_t k = parts.insideCount(); k < parts.count(); ++k) {
      for (const std::uint32_t sample : parts[k]) {
        axes[0].push_back(batch_.x[sample]);
        axes[1].push_back(batch_.y[sample]);
        axes[2].push_back(batch_.z[sample]);
      }
    }
    return {axes[0].data(), axes[1].data(), axes[2].data(), axes[0].size(), radius(), {}};
  }

  /// Expands what is far of the batch. False if that is not worth it, or not near enough to the field.
  bool expand(const PointSet& border) {
    scratch_.expandedFor.reset();
    FarField& field = scratch_.farField;
    const FarPatch patch = patchAround(border, static_cast<std::size_t>(batch_.grid->cellsPerEdge) + 1, radius());
    if (patch.ball.radius * kLeastSphereRadii > radius()) return false;
    field.chooseOctaves(program_, field_.octaves_.data(), patch, batch_.toleranceMeters);
    if (!field.isWorthwhile()) return false;
    const Program far = field.farOf(program_);
    if (!(field.errorMeters() <= batch_.toleranceMeters)) return false;
    fillBlock(kFarNodeCount, [&](std::size_t i, double p[3]) {
      const int node = static_cast<int>(i);
      patch.pointAt(farNodeA(node), farNodeB(node), p);
    });
    field_.evaluateBlock_(far, scratch_.block);
    fitExpansion(patch, scratch_.block, scratch_.expansion);
    scratch_.expandedFor = field_.features_;
    scratch_.expandedPath = batch_.grid->path;
    scratch_.expandedFeatures = scratch_.gathering.version();
    return true;
  }

  void gather(const PointSet& points) {
    const GatheredFeatures gathered =
        scratch_.gathering.near(field_.features_, points, {minWavelength_, program_.heightsOnly});
    program_.runs = gathered.runs.data();
    program_.runCount = gathered.runs.size();
    halos_ = {gathered.halos.data(), gathered.halos.size()};
    program_.halos = &halos_;
    program_.haloRunCount = 1;
  }

  /// With count points, and the last of them again up to whole chunks.
  template <class PointAt>
  void fillBlock(std::size_t count, const PointAt& pointAt) {
    Block& block = scratch_.block;
    block.count = (count + kChunk - 1) / kChunk * kChunk;
    for (std::size_t i = 0; i < count; ++i) {
      double p[3];
      pointAt(i, p);
      block.x[i] = p[0];
      block.y[i] = p[1];
      block.z[i] = p[2];
    }
    for (double* const axis : {block.x, block.y, block.z}) std::fill(axis + count, axis + block.count, axis[count - 1]);
  }

  void evaluateBlock(std::span<const std::uint32_t> samples, bool gathered) {
    const double scale = radius();
    fillBlock(samples.size(), [&](std::size_t i, double p[3]) {
      p[0] = batch_.x[samples[i]] * scale;
      p[1] = batch_.y[samples[i]] * scale;
      p[2] = batch_.z[samples[i]] * scale;
    });
    if (!gathered) {
      const Block& block = scratch_.block;
      const Ball ball = boundingBall(block.x, block.y, block.z, block.count, 1.0);
      if (ball.radius > widestBall_ && samples.size() > 1) {
        for (std::size_t i = 0; i < samples.size(); ++i) evaluateBlock(samples.subspan(i, 1), false);
        return;
      }
      gather({block.x, block.y, block.z, block.count, 1.0, ball});
    }
    field_.evaluateBlock_(program_, scratch_.block);
    store(samples);
  }

  void store(std::span<const std::uint32_t> samples) {
    const Block& block = scratch_.block;
    if (program_.heightsOnly) {
      for (std::size_t i = 0; i < samples.size(); ++i) out_.heightMeters[samples[i]] = block.height[i];
      return;
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::size_t to = samples[i];
      out_.heightMeters[to] = block.height[i];
      out_.gradientX[to] = block.gradientX[i];
      out_.gradientY[to] = block.gradientY[i];
      out_.gradientZ[to] = block.gradientZ[i];
      out_.reflectance[to] = block.reflectance[i];
    }
  }

  const LunarField& field_;
  const SampleBatch& batch_;
  double minWavelength_, widestBall_ = 0;
  SurfaceSamples& out_;
  SurfaceSamples::Scratch& scratch_;
  Program program_;
  HaloRun halos_{};
};

void LunarField::evaluate(const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out) const {
  const std::size_t count = batch.count();
  out.resize(count);
  if (count == 0) return;
  if (!out.scratch) out.scratch = std::make_shared<SurfaceSamples::Scratch>();
  Evaluation(*this, batch, minWavelengthMeters, out).run();
}

}  // namespace terrane
