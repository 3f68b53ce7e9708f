// The camera's place in every octave of a texture: exact from 0.1 mm to 1,000 km, and so what a shader adds to it gives
// a point the same coordinate from every camera.

#include "common/numerics/octave_coordinates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>

#include "tests/support/high_precision.h"

namespace terrane {
namespace {

using test::HighPrecision;

constexpr double kUnit = 0x1p-24;
constexpr int kFinest = -13, kCoarsest = 20;

/// What a shader adds up, in wavelengths, for a point relative to the camera; whole cells as it wraps them.
struct Sum {
  std::int32_t cell;
  float fraction;
};
Sum asShader(const OctaveCoordinates& camera, int axis, float relativeMeters, int exponent) {
  const float place = camera.rest[axis] + relativeMeters * std::ldexp(1.0f, -exponent);
  const float whole = std::floor(place);
  const auto cell =
      static_cast<std::uint32_t>(camera.cell[axis]) + static_cast<std::uint32_t>(static_cast<std::int64_t>(whole));
  return {static_cast<std::int32_t>(cell), place - whole};
}

/// (cell + fraction) minus the true coordinate, in wavelengths, modulo 2^32.
double errorWavelengths(const Sum& sum, const HighPrecision& meters, int exponent) {
  HighPrecision off = HighPrecision(sum.cell) + HighPrecision(sum.fraction) - ldexp(meters, -exponent);
  off -= round(off / HighPrecision(0x1p32)) * HighPrecision(0x1p32);
  return static_cast<double>(off);
}

TEST(OctaveCoordinates, CellAndRestAreThePositionExactlyUpToTheRestsRounding) {
  std::mt19937_64 random(20261126);
  std::uniform_real_distribution<double> direction(-1, 1);
  for (const double size : {1e-3, 1.0, 1.7374e6, 6.371e6, 1.5e11, 4.5e12})
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 position{size * direction(random), size * direction(random), -size * direction(random)};
      for (int exponent = kFinest; exponent <= kCoarsest; ++exponent) {
        const OctaveCoordinates at = octaveCoordinates(position, exponent);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_GE(at.rest[axis], 0.0f);
          ASSERT_LE(at.rest[axis], 1.0f);
          ASSERT_LE(
              std::fabs(errorWavelengths({at.cell[axis], at.rest[axis]}, HighPrecision(position[axis]), exponent)),
              0.5 * kUnit)
              << position[axis] << " m, octave " << exponent;
        }
      }
    }
}

TEST(OctaveCoordinates, APointHasTheSameCoordinateFromEveryCameraWithinTheBound) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  double worstShare = 0, worstFloat32 = 0;
  for (int i = 0; i < 20000; ++i) {
    const double camera = 1.7374e6 * unit(random);
    const double distance = std::pow(10.0, 3 + 6 * unit(random));
    const auto relative = static_cast<float>(distance * unit(random));
    const HighPrecision point = HighPrecision(camera) + HighPrecision(relative);
    for (int exponent = kFinest; exponent <= kCoarsest; ++exponent) {
      const double wavelength = std::ldexp(1.0, exponent);
      if (std::fabs(static_cast<double>(relative)) > 0x1p23 * wavelength) continue;  // far below a pixel there
      const double bound = 2 * kUnit + kUnit * std::fabs(static_cast<double>(relative)) / wavelength;
      const OctaveCoordinates at = octaveCoordinates({camera, 0, 0}, exponent);
      const double error = std::fabs(errorWavelengths(asShader(at, 0, relative, exponent), point, exponent));
      ASSERT_LE(error, bound) << camera << " m, " << relative << " m, octave " << exponent;
      worstShare = std::max(worstShare, error / bound);
      const float control = (static_cast<float>(camera) + relative) * std::ldexp(1.0f, -exponent);
      worstFloat32 = std::max(worstFloat32,
                              std::fabs(static_cast<double>(HighPrecision(control) - ldexp(point, -exponent))) / bound);
    }
  }
  std::printf("worst: %.2f of the bound; the position in float32: %.3g of it\n", worstShare, worstFloat32);
  EXPECT_GT(worstShare, 0.3);  // the bound is no idle one
  EXPECT_GT(worstFloat32, 1e6);
}

TEST(OctaveCoordinates, NeighbouringOctavesAgree) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-4.5e12, 4.5e12);
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 position{unit(random), unit(random), unit(random)};
    for (int exponent = kFinest; exponent < kCoarsest; ++exponent) {
      const OctaveCoordinates fine = octaveCoordinates(position, exponent),
                              coarse = octaveCoordinates(position, exponent + 1);
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_EQ(static_cast<std::uint32_t>(fine.cell[axis]) >> 1,
                  static_cast<std::uint32_t>(coarse.cell[axis]) & 0x7fffffffu);
    }
  }
}

TEST(OctaveCoordinates, NegativePositionsRoundDownAndWhatIsNotFiniteIsNothing) {
  const OctaveCoordinates below = octaveCoordinates({-0.25, -1.0, -0.0}, 0);
  EXPECT_EQ(below.cell, glm::ivec3(-1, -1, 0));
  EXPECT_EQ(below.rest, glm::vec3(0.75f, 0.0f, 0.0f));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    const OctaveCoordinates at = octaveCoordinates({bad, 1.5, bad}, 0);
    EXPECT_EQ(at.cell, glm::ivec3(0, 1, 0));
    EXPECT_EQ(at.rest, glm::vec3(0.0f, 0.5f, 0.0f));
  }
  for (const double extreme : {5e-324, 1e-310, 1.7976931348623157e308}) {
    const OctaveCoordinates at = octaveCoordinates({extreme, -extreme, 0}, 100);
    EXPECT_GE(at.rest.y, 0.0f);
    EXPECT_LE(at.rest.y, 1.0f);
  }
}

}  // namespace
}  // namespace terrane
