#include "server/fields/far_field.h"

#include <cmath>
#include <functional>
#include <limits>

#include "common/numerics/strict_math.h"
#include "server/fields/lunar_bounds.h"

namespace terrane::lunar {
void FarField::Part::clear() {
  clearOfLevel();
  basins.clear();
  patches.clear();
}

void FarField::Part::clearOfLevel() {
  octaves.clear();
  groups.clear();
  runs.clear();
  halos.clear();
}

void FarField::Part::apply(Program& program) const {
  program.relief = groups.front();
  program.regolith = groups.data() + 1;
  program.regolithCount = groups.size() - 1;
  program.basins = basins.data();
  program.basinCount = basins.size();
  program.patches = patches.data();
  program.patchCount = patches.size();
  program.runs = runs.data();
  program.runCount = runs.size();
  program.halos = halos.data();
  program.haloRunCount = halos.size();
}

bool FarField::fitsOneCell(const NoiseGroup& group, const NoiseOctave& octave) const noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const double* row = group.rotation + 3 * axis;
    const auto along = [&](const double v[3]) { return (row[0] * v[0] + row[1] * v[1]) + row[2] * v[2]; };
    const double middle = along(patch_.origin) * octave.inverseWavelength + octave.offset[axis];
    const double extent =
        ((std::abs(along(patch_.axisA)) * patch_.halfA + std::abs(along(patch_.axisB)) * patch_.halfB) + patch_.sag) *
        octave.inverseWavelength * 1.000001;
    if (std::nearbyint(middle - extent) != std::nearbyint(middle + extent)) return false;
  }
  return true;
}

/// What a polynomial misses of a wave of amplitude 1.
double FarField::missedOf(double inverseWavelength) const noexcept {
  const double share = kFarOctaveRadii * patch_.ball.radius * inverseWavelength, square = share * share;
  return kFarOctaveError * (square * square * square);
}

/// How many of the group's octaves are far. The last one is kept near where the next group's scale is.
std::size_t FarField::chooseIn(const NoiseGroup& group, bool keepLast) {
  std::size_t chosen = 0;
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    const double amplitude = std::abs(octave.amplitude) + std::abs(octave.lavaAmplitude);
    if (kFarOctaveRadii * patch_.ball.radius * octave.inverseWavelength > 1 ||
        amplitude * missedOf(octave.inverseWavelength) > kOctaveShare * tolerance_)
      break;
    if ((keepLast && k + 1 == group.count) || !fitsOneCell(group, octave)) continue;
    farOctaves_ |= bitOf(octave);
    ++chosen;
  }
  return chosen;
}

/// How far what a group adds may be from what its polynomials do. Scaled by 1 + modulation * last: by two polynomials'
/// product where the group is far in part, else in one, of whose waves the frequencies add up.
double FarField::errorIn(const NoiseGroup& group, const NoiseOctave* last) const noexcept {
  double missed = 0, missedOfProduct = 0, sum = 0;
  bool isWhole = true;
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    const double amplitude = std::abs(octave.amplitude) + std::abs(octave.lavaAmplitude);
    sum += kNoiseBound * amplitude;
    if (isChosen(octave)) {
      missed += amplitude * missedOf(octave.inverseWavelength);
      if (last != nullptr) missedOfProduct += amplitude * missedOf(octave.inverseWavelength + last->inverseWavelength);
    } else {
      isWhole = false;
    }
  }
  if (last == nullptr) return missed;
  const double modulation = group.modulation * kNoiseBound;
  if (isWhole) return missed + modulation * missedOfProduct;
  const double ofLast = isChosen(*last) ? missedOf(last->inverseWavelength) : 0;
  return (1 + modulation) * missed + group.modulation * sum * ofLast;
}

void FarField::chooseOctaves(const Program& whole, const NoiseOctave* table, const FarPatch& patch,
                             double toleranceMeters) {
  patch_ = patch;
  tolerance_ = toleranceMeters;
  table_ = table;
  farOctaves_ = 0;
  octaveCount_ = 0;
  octaveError_ = 0;
  const NoiseOctave* last = nullptr;
  bool wholeSoFar = true;
  for (std::size_t g = 0; g <= whole.regolithCount; ++g) {
    const NoiseGroup& group = g == 0 ? whole.relief : whole.regolith[g - 1];
    const std::uint64_t before = farOctaves_;
    std::size_t chosen = chooseIn(group, !wholeSoFar);
    if (chosen < group.count) {
      if (wholeSoFar) {
        farOctaves_ = before;
        chosen = chooseIn(group, true);
      }
      wholeSoFar = false;
    }
    octaveCount_ += static_cast<int>(chosen);
    octaveError_ += errorIn(group, last);
    if (group.count > 0) last = &group.octaves[group.count - 1];
    if (!wholeSoFar && g > 0) break;  // of regolith one sum can start from a far part
  }
}

void FarField::takeOctaves(const Program& whole, bool far, Part& out) const {
  out.octaves.reserve(64);  // groups point into it
  for (std::size_t g = 0; g <= whole.regolithCount; ++g) {
    NoiseGroup group = g == 0 ? whole.relief : whole.regolith[g - 1];
    const std::size_t begin = out.octaves.size();
    for (std::size_t k = 0; k < group.count; ++k)
      if (isChosen(group.octaves[k]) == far) out.octaves.push_back(group.octaves[k]);
    const std::size_t taken = out.octaves.size() - begin;
    if (g > 0 && taken == 0) continue;
    if (g > 0 && taken < group.count) group.part = far ? GroupPart::Far : GroupPart::Near;
    group.octaves = out.octaves.data() + begin;
    group.count = taken;
    out.groups.push_back(group);
  }
}

void FarField::partLandmarks(const Program& whole) {
  for (std::size_t k = 0; k < whole.basinCount; ++k) {
    const double error = farBasinError(whole.basins[k], patch_.ball);
    (accepts(error) ? far_ : near_).basins.push_back(whole.basins[k]);
    if (accepts(error)) featureError_ += error;
  }
  for (std::size_t k = 0; k < whole.patchCount; ++k) {
    const double error = farLavaPatchError(whole.patches[k], whole.lavaTop - whole.lavaFloor, patch_.ball);
    (accepts(error) ? far_ : near_).patches.push_back(whole.patches[k]);
    if (accepts(error)) featureError_ += error;
  }
}

double FarField::errorOf(FeatureStage stage, const Feature& feature, const Program& atLevel) const noexcept {
  // The next coarser level, whose edges are added to the expansion too, must show it in whole.
  if (stage == FeatureStage::Rock || feature.radius < kLeastFarFeatureRadii * patch_.ball.radius ||
      shownShare(feature.radius, 2 * atLevel.minWavelength) < 1)
    return std::numeric_limits<double>::infinity();
  return farCraterError(feature, atLevel, patch_.ball);
}

void FarField::judgeCraters(const Program& whole) {
  judged_.clear();
  verdicts_.clear();
  for (std::size_t k = 0; k < whole.runCount; ++k) {
    const FeatureRun& run = whole.runs[k];
    if (judged_.empty() || judged_.back().end() != run.features) judged_.push_back({run.features, 0, verdicts_.size()});
    judged_.back().count += run.count;
    for (std::size_t i = 0; i < run.count; ++i) {
      const double error = errorOf(run.stage, run.features[i], whole);
      verdicts_.push_back(accepts(error));
      if (accepts(error)) featureError_ += error;
    }
  }
}

bool FarField::isJudgedFar(const Feature& feature) const noexcept {
  for (const Judged& judged : judged_)
    if (!std::less<>()(&feature, judged.features) && std::less<>()(&feature, judged.end()))
      return verdicts_[judged.begin + static_cast<std::size_t>(&feature - judged.features)] != 0;
  return false;
}

void FarField::takeCraters(const Program& whole, bool far, Part& out) const {
  for (std::size_t k = 0; k < whole.runCount; ++k) {
    const FeatureRun& run = whole.runs[k];
    std::size_t begin = 0;
    const auto takeUpTo = [&](std::size_t end) {
      if (end > begin) out.runs.push_back({run.features + begin, end - begin, run.stage, run.inDouble || far});
      begin = end + 1;
    };
    for (std::size_t i = 0; i < run.count; ++i)
      if (isJudgedFar(run.features[i]) != far) takeUpTo(i);
    takeUpTo(run.count);
  }
}

void FarField::takeHalos(const Program& whole, bool far, Part& out) const {
  const double least = kLeastFarFeatureRadii * patch_.ball.radius / kHaloRadii;
  for (std::size_t k = 0; k < whole.haloRunCount; ++k) {
    const HaloRun& run = whole.halos[k];
    std::size_t begin = 0;
    const auto takeUpTo = [&](std::size_t end) {
      if (end > begin) out.halos.push_back({run.halos + begin, end - begin});
      begin = end + 1;
    };
    for (std::size_t i = 0; i < run.count; ++i)
      if ((run.halos[i].radius >= least && isFarHalo(run.halos[i], patch_.ball)) != far) takeUpTo(i);
    takeUpTo(run.count);
  }
}

void FarField::floodNear(Part& near) {
  NoiseGroup& relief = near.groups.front();
  for (std::size_t k = 0; k < relief.count; ++k) near.octaves[k].amplitude = near.octaves[k].lavaAmplitude;
  std::erase_if(near.runs, [](const FeatureRun& run) { return run.stage == FeatureStage::OldCrater; });
}

Program FarField::farOf(const Program& whole) {
  far_.clear();
  near_.clear();
  featureError_ = 0;
  partLandmarks(whole);
  judgeCraters(whole);
  takeOctaves(whole, true, far_);
  takeCraters(whole, true, far_);
  takeHalos(whole, true, far_);
  Program program = whole;
  far_.apply(program);
  program.far = nullptr;
  program.doubleWavelength = 0;
  program.rayCount = 0;
  return program;
}

Program FarField::nearOf(const Program& whole, const FarExpansion& expansion) {
  near_.clearOfLevel();
  takeOctaves(whole, false, near_);
  takeCraters(whole, false, near_);
  if (!whole.heightsOnly) takeHalos(whole, false, near_);
  if (expansion.ground == FarGround::Lava) floodNear(near_);
  Program program = whole;
  near_.apply(program);
  program.far = &expansion;
  return program;
}

}  // namespace terrane::lunar
