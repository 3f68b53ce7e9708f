#include "server/fields/lunar_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "common/numerics/strict_math.h"
#include "server/fields/lunar_landmarks.h"

namespace terrane {

using namespace lunar;

/// One a calling thread; grows to its steady state with the first tiles.
struct SurfaceSamples::Scratch {
  Block block;
  FeatureGathering gathering;
  std::vector<NoiseGroup> groups;
};

namespace {

double parameter(const Body& body, std::string_view name) {
  if (const auto found = body.fieldParameters.find(name); found != body.fieldParameters.end()) return found->second;
  for (const ParameterSpec& spec : fieldRow(FieldKind::Lunar).parameters) {
    if (spec.name == name) return spec.defaultValue;
  }
  return 0;
}

EvaluateBlock kernelFor(SimdPath path) noexcept {
#if defined(__x86_64__)
  if (simdPathSupported(path)) {
    if (path == SimdPath::V4) return evaluateBlockV4;
    if (path == SimdPath::V3) return evaluateBlockV3;
  }
#else
  (void)path;
#endif
  return evaluateBlockDefault;
}

void unitTimes(const double direction[3], double length, double out[3]) noexcept {
  const double norm =
      std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  for (int i = 0; i < 3; ++i) out[i] = direction[i] / norm * length;
}

/// The rotation of an integer quaternion: rational, so orthogonal to the last bit or two.
void rotationOf(double w, double x, double y, double z, double m[9]) noexcept {
  const double n = w * w + x * x + y * y + z * z;
  const double rows[9] = {w * w + x * x - y * y - z * z, 2 * (x * y - w * z),           2 * (x * z + w * y),
                          2 * (x * y + w * z),           w * w - x * x + y * y - z * z, 2 * (y * z - w * x),
                          2 * (x * z - w * y),           2 * (y * z + w * x),           w * w - x * x - y * y + z * z};
  for (int i = 0; i < 9; ++i) m[i] = rows[i] / n;
}

/// A batch cut into compact blocks: rows x columns each.
struct BlockGrid {
  std::size_t rows, columns;            ///< of blocks
  std::size_t blockRows, blockColumns;  ///< samples, at most
};
BlockGrid blockGrid(const SampleBatch& batch) noexcept {
  const auto pieces = [](std::size_t n, std::size_t most) { return (n + most - 1) / most; };
  const std::size_t rows = pieces(batch.rows, kBlockSide);
  const std::size_t blockRows = pieces(batch.rows, rows);
  const std::size_t mostColumns = kBlockSide * kBlockSide / blockRows;
  const std::size_t columns = pieces(batch.rowLength, mostColumns);
  return {rows, columns, blockRows, pieces(batch.rowLength, columns)};
}

Ball boundingBall(const double* x, const double* y, const double* z, std::size_t count) noexcept {
  double low[3] = {x[0], y[0], z[0]}, high[3] = {x[0], y[0], z[0]};
  for (std::size_t i = 1; i < count; ++i) {
    const double p[3] = {x[i], y[i], z[i]};
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  Ball ball{};
  for (int a = 0; a < 3; ++a) ball.center[a] = 0.5 * (low[a] + high[a]);
  double square = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = x[i] - ball.center[0], dy = y[i] - ball.center[1], dz = z[i] - ball.center[2];
    square = std::max(square, dx * dx + dy * dy + dz * dz);
  }
  ball.radius = std::sqrt(square) * (1 + 1e-9);
  return ball;
}

}  // namespace

LunarField::LunarField(const Body& body, SimdPath simd)
    : radius_(body.radiusMeters),
      seed_(body.seed),
      mareFraction_(parameter(body, "mare-fraction")),
      craterDensity_(parameter(body, "crater-density")),
      roughness_(parameter(body, "roughness")),
      rockDensity_(parameter(body, "rock-density")),
      finestDetail_(parameter(body, "finest-detail")),
      evaluateBlock_(kernelFor(simd)) {
  makeNoise();
  makeFeatures();
  const double scale = std::min(1.0, radius_ / kTableRadiusMeters);
  base_.radius = radius_;
  base_.lavaTop = (-2050 + 4500 * mareFraction_) * scale;
  base_.lavaFloor = base_.lavaTop - (mareFraction_ > 0 ? 6000 : 50000) * scale;
  base_.lavaBlend = 220 * scale;
  base_.clampLow = -8500 * scale;
  base_.clampHigh = 8500 * scale;
  base_.clampBlend = 3500 * scale;
  base_.mareSmoothing = 0.6;
  base_.inverseReliefAmplitude = 1 / (3000 * scale);
  base_.basins = basins_.data();
  base_.basinCount = basins_.size();
  base_.patches = patches_.data();
  base_.patchCount = patches_.size();
  base_.rays = rays_.data();
  base_.rayCount = rays_.size();
  bounds_ = LunarBounds(base_, groups_, features_->layers, features_->landmarks);
}

void LunarField::makeNoise() {
  const double scale = std::min(1.0, radius_ / kTableRadiusMeters);
  // Metres, by wavelength 2^20 .. 2^13.
  constexpr std::array<double, 8> kRelief{2400, 1900, 1400, 950, 720, 520, 330, 190};
  constexpr std::array<double, 8> kLava{500, -420, 260, 130, -70, 45, -28, 16};
  constexpr int kReliefFinest = 13;
  int coarsest = kReliefFinest;
  while (coarsest < 20 && std::ldexp(1.0, coarsest + 1) <= 0.65 * radius_) ++coarsest;
  std::vector<std::size_t> starts{0};
  const auto add = [&](int exponent, double amplitude, double lava) {
    NoiseOctave octave{};
    octave.inverseWavelength = std::ldexp(1.0, -exponent);
    const std::uint64_t h = mixHash(seed_ ^ mixHash(static_cast<std::uint64_t>(exponent) + 64));
    for (int a = 0; a < 3; ++a)
      octave.offset[a] = hashUnit(mixHash(h ^ static_cast<std::uint64_t>(a + 1))) * 1000 - 0.5;
    octave.seed = static_cast<std::uint32_t>(h);
    octave.amplitude = amplitude;
    octave.lavaAmplitude = lava;
    octaves_.push_back(octave);
  };
  for (int k = coarsest; k >= kReliefFinest; --k) {
    const auto row = static_cast<std::size_t>(20 - k);
    add(k, kRelief[row] * scale, kLava[row] * scale);
  }
  double amplitude = 105 * roughness_ * scale;
  for (int k = kReliefFinest - 1; std::ldexp(1.0, k) >= finestDetail_; --k) {
    if ((kReliefFinest - 1 - k) % 6 == 0) starts.push_back(octaves_.size());
    add(k, amplitude, 0);
    amplitude *= 0.52;
  }
  starts.push_back(octaves_.size());
  constexpr double kTurns[4][4] = {{7, 3, 2, 5}, {5, -4, 6, 1}, {3, 6, -2, 7}, {8, 1, -5, -3}};
  for (std::size_t g = 0; g + 1 < starts.size(); ++g) {
    NoiseGroup group{};
    group.octaves = octaves_.data() + starts[g];
    group.count = starts[g + 1] - starts[g];
    const double* q = kTurns[g % 4];
    rotationOf(q[0], q[1], q[2], q[3], group.rotation);
    group.modulation = 0.7;
    groups_.push_back(group);
  }
}

void LunarField::makeFeatures() {
  const auto features = std::make_shared<FeatureTables>();
  features->bodyRadius = radius_;
  features->layers = makeLayers({radius_, craterDensity_, rockDensity_, finestDetail_, seed_});
  makeLandmarks(*features);
  features_ = features;
}

void LunarField::makeLandmarks(FeatureTables& features) {
  const double scale = radius_ / kTableRadiusMeters, heightScale = std::min(1.0, scale);
  for (const BasinRow& row : basinTable()) {
    Basin b{};
    unitTimes(row.direction, radius_, b.center);
    const double radius = row.radiusKm * 1000 * scale;
    b.inverseRadiusSquared = 1 / (radius * radius);
    b.reach = radius * 1.2042;  // sqrt(1.45), rounded up
    b.depth = row.depthMeters * heightScale;
    b.ring = row.ringMeters * heightScale;
    basins_.push_back(b);
  }
  if (mareFraction_ > 0) {
    for (const LavaRow& row : lavaTable()) {
      LavaPatch p{};
      unitTimes(row.direction, radius_, p.center);
      p.reach = row.reachKm * 1000 * scale;
      p.inverseReachSquared = 1 / (p.reach * p.reach);
      p.reach *= 1 + 1e-9;
      p.innerSquared = row.inner * row.inner;
      p.inverseRamp = 1 / (1 - p.innerSquared);
      patches_.push_back(p);
    }
  }
  std::vector<CraterRow> craters(craterTable().begin(), craterTable().end());
  std::stable_sort(craters.begin(), craters.end(),
                   [](const CraterRow& a, const CraterRow& b) { return a.diameterKm > b.diameterKm; });
  for (const CraterRow& row : craters) {
    const double diameter = row.diameterKm * 1000 * scale;
    const std::uint64_t h = mixHash(static_cast<std::uint64_t>(row.diameterKm * 4096) ^ 0x5bd1e995u);
    Feature f = makeCrater(row.direction, radius_, diameter, row.youth > 0 ? 0.05 : 0.35, h);
    if (row.youth > 0) {
      features.landmarkHalos.push_back(makeHalo(f, 0.05 * row.youth, 0));  // its rays are a system of their own
      RaySystem r{};
      for (int a = 0; a < 3; ++a) {
        r.center[a] = f.center[a];
        r.axis1[a] = f.axis1[a];
        r.axis2[a] = f.axis2[a];
      }
      const double reachInRadii = 10 + 18 * row.youth;
      r.inverseRadius = 1 / f.radius;
      r.reach = f.radius * reachInRadii * (1 + 1e-5);
      r.inverseReachInRadii = static_cast<float>(1 / reachInRadii);
      r.strength = static_cast<float>(0.10 * row.youth);
      for (int j = 0; j < 3; ++j) {
        const double c = 2 * hashUnit(mixHash(h ^ (50u + static_cast<unsigned>(j)))) - 1;
        const double s = std::sqrt(1 - c * c);
        r.phase[2 * j] = static_cast<float>(c);
        r.phase[2 * j + 1] = static_cast<float>(s);
      }
      rays_.push_back(r);
    }
    features.landmarks.push_back(f);
  }
}

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
    program_.heightsOnly = batch.grid && batch.grid->skirtEdge != GridPlace::kWholeGrid;
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
    program_.reliefInDouble = minWavelengthMeters < kCoarseWavelength;
    double finest = radius();
    for (const FeatureLayer& layer : field.features_->layers) {
      if (layer.longestWavelengthMeters() >= minWavelengthMeters) finest = layer.wavelengthMeters();
    }
    widestBall_ = kWidestBall * finest;
  }

  /// Features are gathered for the whole batch where it is compact, as tiles are, else for each block, else for each
  /// sample: a ball over half the Moon would hold more pebbles than there is time.
  void run() {
    const Ball whole = scaled(boundingBall(batch_.x, batch_.y, batch_.z, batch_.count()));
    const bool compact = whole.radius <= widestBall_;
    if (compact) gather({batch_.x, batch_.y, batch_.z, batch_.count(), radius(), whole});
    const BlockGrid grid = blockGrid(batch_);
    for (std::size_t blockRow = 0; blockRow < grid.rows; ++blockRow) {
      for (std::size_t blockColumn = 0; blockColumn < grid.columns; ++blockColumn) {
        const std::size_t rowEnd = std::min(batch_.rows, (blockRow + 1) * grid.blockRows);
        const std::size_t columnEnd = std::min(batch_.rowLength, (blockColumn + 1) * grid.blockColumns);
        const std::size_t used =
            listSamples(blockRow * grid.blockRows, rowEnd, blockColumn * grid.blockColumns, columnEnd);
        if (used > 0) evaluateBlock({indices_.data(), used}, compact);
      }
    }
  }

 private:
  static constexpr double kWidestBall =
      300;  ///< in wavelengths of the finest layer; a tile has a ball of some 25 to 50

  double radius() const noexcept { return field_.radius_; }
  Ball scaled(Ball ball) const noexcept {
    for (double& c : ball.center) c *= radius();
    ball.radius = (ball.radius + 1e-9) * radius();
    return ball;
  }

  /// A block's samples in strips of about four rows, column by column: then 16 in a row, a chunk, lie in a square, and
  /// a small crater touches few of them.
  std::size_t listSamples(std::size_t rowBegin, std::size_t rowEnd, std::size_t columnBegin, std::size_t columnEnd) {
    std::size_t used = 0;
    const std::size_t rows = rowEnd - rowBegin, strips = std::max<std::size_t>(1, rows / 4);
    for (std::size_t strip = 0; strip < strips; ++strip) {
      for (std::size_t column = columnBegin; column < columnEnd; ++column) {
        for (std::size_t row = rowBegin + rows * strip / strips; row < rowBegin + rows * (strip + 1) / strips; ++row)
          indices_[used++] = row * batch_.rowLength + column;
      }
    }
    return used;
  }

  void gather(const PointSet& points) {
    const GatheredFeatures gathered = scratch_.gathering.near(
        field_.features_, points, {minWavelength_, program_.reliefInDouble, program_.heightsOnly});
    program_.runs = gathered.runs.data();
    program_.runCount = gathered.runs.size();
    program_.halos = gathered.halos.data();
    program_.haloCount = gathered.halos.size();
  }

  void evaluateBlock(std::span<const std::size_t> indices, bool gathered) {
    Block& block = scratch_.block;
    block.count = (indices.size() + kChunk - 1) / kChunk * kChunk;
    for (std::size_t i = 0; i < block.count; ++i) {
      const std::size_t from = indices[std::min(i, indices.size() - 1)];
      block.x[i] = batch_.x[from] * radius();
      block.y[i] = batch_.y[from] * radius();
      block.z[i] = batch_.z[from] * radius();
    }
    const Ball whole = boundingBall(block.x, block.y, block.z, block.count);
    if (!gathered) {
      if (whole.radius > widestBall_ && indices.size() > 1) {
        for (std::size_t i = 0; i < indices.size(); ++i) evaluateBlock(indices.subspan(i, 1), false);
        return;
      }
      gather({block.x, block.y, block.z, block.count, 1.0, whole});
    }
    std::copy(whole.center, whole.center + 3, block.center);
    block.radius = whole.radius;
    for (std::size_t chunk = 0; chunk * kChunk < block.count; ++chunk) {
      const std::size_t at = chunk * kChunk;
      const Ball part = boundingBall(block.x + at, block.y + at, block.z + at, kChunk);
      std::copy(part.center, part.center + 3, block.chunkCenter[chunk]);
      block.chunkRadius[chunk] = part.radius;
    }
    field_.evaluateBlock_(program_, block);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::size_t to = indices[i];
      out_.heightMeters[to] = block.height[i];
      if (program_.heightsOnly) continue;
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
  std::array<std::size_t, kBlockCapacity> indices_{};
};

void LunarField::evaluate(const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out) const {
  const std::size_t count = batch.count();
  out.heightMeters.resize(count);
  out.gradientX.resize(count);
  out.gradientY.resize(count);
  out.gradientZ.resize(count);
  out.reflectance.resize(count);
  if (count == 0) return;
  if (!out.scratch) out.scratch = std::make_shared<SurfaceSamples::Scratch>();
  Evaluation(*this, batch, minWavelengthMeters, out).run();
}

double LunarField::omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept {
  return bounds_.omittedAmplitudeMeters(minWavelengthMeters, finestWavelengthMeters);
}

double LunarField::interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept {
  return bounds_.interpolationErrorMeters(minWavelengthMeters, spacingMeters);
}

HeightRange LunarField::heightRange() const noexcept { return bounds_.heightRange(); }

std::string LunarField::identity() const {
  return fmt::format("lunar 2 seed={} mare={:a} craters={:a} roughness={:a} rocks={:a} finest={:a}", seed_,
                     mareFraction_, craterDensity_, roughness_, rockDensity_, finestDetail_);
}

}  // namespace terrane
