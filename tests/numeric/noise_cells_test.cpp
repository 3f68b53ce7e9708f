// Noise on its integer cells: they tile the line without a fold at 0, and one ulp of the position, also from a cell
// into the next, changes the value by no more than the noise's slope and the rounding of its type allow. The very
// functions that tiles are made by, over the lengths they are used at.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <memory>
#include <random>
#include <type_traits>
#include <vector>

#include "common/numerics/strict_math.h"
#include "server/fields/lunar_bounds.h"
#include "server/fields/lunar_program.h"
#include "tests/numeric/samples.h"
#include "tests/support/high_precision.h"

namespace terrane::lunar {

#include "server/fields/lunar_noise.inl"

namespace {

using test::HighPrecision;

constexpr double kMoonRadius = 1'737'400.0;
constexpr double kIdentity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
/// Orthogonal and no multiple of the axes, as the field's groups are turned: quaternion (7, 3, 2, 5).
constexpr double kTurned[9] = {29.0 / 87,  -58.0 / 87, 58.0 / 87, 82.0 / 87, 19.0 / 87,
                               -22.0 / 87, 2.0 / 87,   62.0 / 87, 61.0 / 87};

/// Rounding of one value, in units of the type's u, to first order. The fraction of a cell: 1/2 on each of three axes,
/// by the slope kNoiseSlope of each at most: 6. The fades: 9 roundings of polynomials up to 10, 3 axes, by differences
/// of corner heights up to 4, of which the fade's last product halves most: 100. Heights and three blends: 30.
constexpr double kNoiseRounding = 140;  // seen: 35
template <class Real>
constexpr double unitRoundoff = std::is_same_v<Real, float> ? 0x1p-24 : 0x1p-53;

NoiseOctave octaveOf(int wavelengthExponent, double offset = 0) {
  NoiseOctave octave{};
  octave.inverseWavelength = std::ldexp(1.0, -wavelengthExponent);
  octave.offset[0] = octave.offset[1] = octave.offset[2] = offset;
  octave.amplitude = 1;
  octave.seed = 1969;
  return octave;
}

/// Values of one octave at the positions, in blocks as the field computes them.
template <class Real>
std::vector<double> noiseAt(const std::vector<glm::dvec3>& positions, const NoiseOctave& octave,
                            const double* rotation) {
  const auto block = std::make_unique<Block>();
  const auto samples = std::make_unique<OctaveSamples<Real>>();
  std::vector<double> values;
  for (std::size_t first = 0; first < positions.size(); first += kBlockCapacity) {
    const std::size_t count = std::min(kBlockCapacity, positions.size() - first);
    block->count = (count + kChunk - 1) / kChunk * kChunk;
    for (std::size_t i = 0; i < block->count; ++i) {
      const glm::dvec3& p = positions[first + std::min(i, count - 1)];
      block->x[i] = p.x;
      block->y[i] = p.y;
      block->z[i] = p.z;
    }
    evaluateOctave<Real, lunar::Wanted::All>(rotateBlock(*block, rotation), octave, *samples);
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<double>(samples->value[i]));
  }
  return values;
}

// ---- cells ----

/// The control: cell and fraction by a cast, which cuts towards 0.
std::int32_t truncatedCell(double t) { return static_cast<std::int32_t>(t); }
double truncatedNoise(double t) {
  const auto cell = static_cast<std::uint32_t>(truncatedCell(t));
  const double fraction = std::fabs(t - truncatedCell(t));
  return noiseInCell<double>(cellDirections(cell, 3, 5, 1969), fraction, 0.4, 0.3).value;
}

TEST(NoiseCells, HaveTheSameWidthOnBothSidesOfZero) {
  std::array<int, 17> places{}, control{};
  for (int k = -8 * 64; k < 8 * 64; ++k) {
    const double t = (k + 0.5) / 64;
    ++places[static_cast<std::size_t>(static_cast<std::int32_t>(cellIndex(t)) + 8)];
    ++control[static_cast<std::size_t>(truncatedCell(t) + 8)];
    const double fraction = (t - roundToCell(t)) + 0.5;
    ASSERT_TRUE(fraction >= 0 && fraction <= 1) << t;
    ASSERT_EQ(roundToCell(t), static_cast<double>(static_cast<std::int32_t>(cellIndex(t))));
  }
  for (std::size_t cell = 1; cell < 16; ++cell) EXPECT_EQ(places[cell], 64) << "cell " << static_cast<int>(cell) - 8;
  EXPECT_EQ(control[8], 128) << "the control's cell 0 is two cells wide";
}

TEST(NoiseCells, ShowNoMirrorAtZero) {
  // A fold at 0 would repeat what lies on the one side on the other.
  std::vector<glm::dvec3> right, left;
  int mirroredControl = 0;
  const int count = 200;
  for (int k = 1; k <= count; ++k) {
    const double t = 0.9 * k / count;
    right.push_back({t, 0.4, 0.3});
    left.push_back({-t, 0.4, 0.3});
    mirroredControl += truncatedNoise(t) == truncatedNoise(-t);
  }
  const std::vector<double> a = noiseAt<double>(right, octaveOf(0, 0.5), kIdentity);
  const std::vector<double> b = noiseAt<double>(left, octaveOf(0, 0.5), kIdentity);
  int mirrored = 0;
  for (std::size_t i = 0; i < a.size(); ++i) mirrored += std::fabs(a[i] - b[i]) < 1e-6;
  EXPECT_LT(mirrored, 3);
  EXPECT_EQ(mirroredControl, count) << "the control is its own mirror image";
}

// ---- one ulp ----

template <class Real>
void checkRounding() {
  std::mt19937_64 random = test::seededRandom(52);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<double, 3> f{unit(random), unit(random), unit(random)};
    if (i % 4 == 0) f[static_cast<std::size_t>(i / 4 % 3)] = i % 8 == 0 ? 1 - 0x1p-30 : 0x1p-30;
    const Cell cell = cellDirections(static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random()),
                                     static_cast<std::uint32_t>(random()), 7);
    const double value = static_cast<double>(
        noiseInCell<Real>(cell, static_cast<Real>(f[0]), static_cast<Real>(f[1]), static_cast<Real>(f[2])).value);
    const HighPrecision exact =
        noiseInCell<HighPrecision>(cell, HighPrecision(f[0]), HighPrecision(f[1]), HighPrecision(f[2])).value;
    worst = std::max(worst, static_cast<double>(HighPrecision(abs(HighPrecision(value - exact)))));
  }
  std::cout << "worst rounding " << worst / unitRoundoff<Real> << " u, bound " << kNoiseRounding << " u\n";
  EXPECT_LE(worst, kNoiseRounding * unitRoundoff<Real>);
}

TEST(Noise, IsRoundedWithinItsBoundInFloatAndInDouble) {
  checkRounding<float>();
  checkRounding<double>();
}

/// Two adjacent doubles.
struct Neighbours {
  double below, above;
};

/// Two adjacent doubles x, y near `start` metres with cells k and k + 1 of the octave.
Neighbours acrossABorder(double start, const NoiseOctave& octave) {
  const auto cellOf = [&](double x) { return cellIndex(x * octave.inverseWavelength + octave.offset[0]); };
  double low = start, high = start + 1 / octave.inverseWavelength;
  while (std::nextafter(low, high) < high) {
    const double middle = low + 0.5 * (high - low);
    (cellOf(middle) == cellOf(start) ? low : high) = middle;
  }
  return {low, high};
}

/// The most that a move of the position by d along x may change the value: its own way, and what rounding adds to the
/// cell coordinate (two roundings of at most half an ulp each) and to the value, at both ends.
template <class Real>
double largestChange(double d, double coordinate, const NoiseOctave& octave) {
  const double cellsMoved = d * octave.inverseWavelength + 4 * 0x1p-53 * std::fabs(coordinate);
  return kNoiseSlope * cellsMoved + 2 * kNoiseRounding * unitRoundoff<Real>;
}

template <class Real>
void checkOneUlp(int wavelengthExponent) {
  std::mt19937_64 random = test::seededRandom(53);
  std::uniform_real_distribution<double> along(-kMoonRadius, kMoonRadius);
  const NoiseOctave octave = octaveOf(wavelengthExponent, 371.25);
  std::vector<glm::dvec3> from, to;
  std::vector<double> bounds;
  int borders = 0;
  for (int i = 0; i < 4000; ++i) {
    const double y = along(random), z = along(random), start = along(random);
    const Neighbours x =
        i % 2 == 0 ? acrossABorder(start, octave) : Neighbours{start, std::nextafter(start, 2 * kMoonRadius)};
    from.push_back({x.below, y, z});
    to.push_back({x.above, y, z});
    const auto cellOf = [&](double p) { return cellIndex(p * octave.inverseWavelength + octave.offset[0]); };
    const std::uint32_t cells = cellOf(x.above) - cellOf(x.below);
    ASSERT_LE(cells, 1u) << "one ulp leads into the same cell or the next, never elsewhere";
    borders += static_cast<int>(cells);
    bounds.push_back(largestChange<Real>(x.above - x.below, x.above * octave.inverseWavelength + 371.25, octave));
  }
  EXPECT_GE(borders, 2000);
  const std::vector<double> a = noiseAt<Real>(from, octave, kIdentity), b = noiseAt<Real>(to, octave, kIdentity);
  double worst = 0, largestBound = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_LE(std::fabs(a[i] - b[i]), bounds[i]) << from[i].x;
    worst = std::max(worst, std::fabs(a[i] - b[i]));
    largestBound = std::max(largestBound, bounds[i]);
  }
  std::cout << "wavelength 2^" << wavelengthExponent << " m: changes by " << worst << " at most, bound " << largestBound
            << '\n';
}

TEST(Noise, OneUlpOfThePositionChangesItByNextToNothingAlsoFromCellToCell) {
  // Float below 2^13 m, double above, as the field has it; the finest is 2^-2 m.
  for (const int exponent : {-2, 3, 8, 12}) checkOneUlp<float>(exponent);
  for (const int exponent : {-2, 3, 13, 20}) checkOneUlp<double>(exponent);
}

TEST(Noise, IsContinuousWhereItsCellsAreTurnedAgainstTheAxes) {
  std::mt19937_64 random = test::seededRandom(54);
  std::uniform_real_distribution<double> along(-1e6, 1e6);
  const NoiseOctave octave = octaveOf(5, 0.25);
  std::vector<glm::dvec3> from, to;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 p(along(random), along(random), along(random));
    from.push_back(p);
    to.push_back({std::nextafter(p.x, 2e6), std::nextafter(p.y, -2e6), p.z});
  }
  const std::vector<double> a = noiseAt<float>(from, octave, kTurned), b = noiseAt<float>(to, octave, kTurned);
  // Five roundings turn a coordinate, of numbers below 2e6, on three axes and at both ends: 5 * 2 * 1.74, and as much
  // again for the sum with the offset.
  const double bound = largestChange<float>(0x1p-32, 2e6 / 32, octave) + kNoiseSlope * 35 * 0x1p-53 * 2e6 / 32;
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_LE(std::fabs(a[i] - b[i]), bound);
}

/// The control: the sinusoid that shaders hash positions with.
template <class Real>
Real sinusoidHash(Real x, Real y, Real z) {
  const Real wave = std::sin(x * Real(12.9898) + y * Real(78.233) + z * Real(37.719)) * Real(43758.5453);
  return wave - std::floor(wave);
}

/// What one ulp of y does to it: how often it changes at all, and by how much then, in the mean.
struct Flips {
  double share, meanChange;
};
template <class Real>
Flips flipsOfTheSinusoid() {
  std::mt19937_64 random = test::seededRandom(55);
  std::uniform_real_distribution<double> along(-kMoonRadius, kMoonRadius);
  double sum = 0;
  int changed = 0;
  const int count = 4000;
  for (int i = 0; i < count; ++i) {
    const Real x = static_cast<Real>(along(random)), y = static_cast<Real>(along(random)),
               z = static_cast<Real>(along(random));
    const Real beside = std::nextafter(y, std::numeric_limits<Real>::infinity());
    const Real change = std::fabs(sinusoidHash(x, y, z) - sinusoidHash(x, beside, z));
    changed += change > 0;
    sum += static_cast<double>(change);
  }
  return {static_cast<double>(changed) / count, sum / changed};
}

TEST(Noise, ASinusoidAsHashWouldFlipWithOneUlp) {
  // Two independent numbers in [0, 1) differ by a third in the mean.
  const Flips inFloat = flipsOfTheSinusoid<float>(), inDouble = flipsOfTheSinusoid<double>();
  std::cout << "control, fract(43758.5453 sin(dot)): one ulp changes " << 100 * inFloat.share << " % by "
            << inFloat.meanChange << " in float, " << 100 * inDouble.share << " % by " << inDouble.meanChange
            << " in double\n";
  EXPECT_GT(inFloat.share, 0.25);
  EXPECT_NEAR(inFloat.meanChange, 1.0 / 3, 0.05) << "unrelated";
  EXPECT_GT(inDouble.meanChange, 1e-5) << "amplified a hundred thousand times";
}

}  // namespace
}  // namespace terrane::lunar
