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
  const auto add = [&](int exponent, double amplitude, double lava, double mottle) {
    NoiseOctave octave{};
    octave.mottle = mottle;
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
    // Mottling from some 250 km down, of regolith alike in all octaves, so that none shows where it enters.
    add(k, kRelief[row] * scale, kLava[row] * scale, coarsest - k < 2 ? 0 : 0.45);
  }
  double amplitude = 105 * roughness_ * scale;
  for (int k = kReliefFinest - 1; std::ldexp(1.0, k) >= finestDetail_; --k) {
    if ((kReliefFinest - 1 - k) % 6 == 0) starts.push_back(octaves_.size());
    add(k, amplitude, 0, 0.35);
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

double LunarField::omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept {
  return bounds_.omittedAmplitudeMeters(minWavelengthMeters, finestWavelengthMeters);
}

double LunarField::interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept {
  return bounds_.interpolationErrorMeters(minWavelengthMeters, spacingMeters);
}

HeightRange LunarField::heightRange() const noexcept { return bounds_.heightRange(); }

std::string LunarField::identity() const {
  return fmt::format("lunar 3 seed={} mare={:a} craters={:a} roughness={:a} rocks={:a} finest={:a}", seed_,
                     mareFraction_, craterDensity_, roughness_, rockDensity_, finestDetail_);
}

}  // namespace terrane
