// Where a vertex is relative to a camera, from 1 mm to 30 AU from the origin: each scheme keeps the bound that its
// header states, against MPFR; and those that Terrane does not draw with are shown to fail where they are said to.
#include "common/numerics/relative_position.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

#include "common/numerics/double_float3.h"
#include "common/numerics/tiled_position.h"
#include "tests/numeric/double_float_search.h"

namespace terrane {
namespace {

using test::HighPrecision;
using test::Operands;

constexpr double kAstronomicalUnitMeters = 149597870700.0;
constexpr std::array kDistancesMeters{
    1e-3, 1.0, 1.7374e6, 6.371e6, 3.844e8, kAstronomicalUnitMeters, 30 * kAstronomicalUnitMeters};

double unit(Operands& operands) { return std::ldexp(static_cast<double>(operands.bits(53)), -52) - 1; }

glm::dvec3 somewhere(Operands& operands, double within) {
  return within * glm::dvec3(unit(operands), unit(operands), unit(operands));
}

/// Both are exact doubles, so the true difference is MPFR's.
double errorOf(float placed, double position, double camera) {
  return std::fabs(static_cast<double>(HighPrecision(HighPrecision(placed) - (HighPrecision(position) - camera))));
}

TEST(RelativePosition, DoubleFloatAndCameraRelativeKeepTheirBoundsFromAMillimetreToThirtyAstronomicalUnits) {
  Operands operands(361);
  for (const double distanceMeters : kDistancesMeters) {
    double worstPair = 0, worstWords = 0, worstCpu = 0, control = 0;
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 camera = somewhere(operands, distanceMeters);
      const glm::dvec3 vertex = camera + somewhere(operands, std::ldexp(2.0, -static_cast<int>(operands.bits(3))));
      const glm::vec3 pair = subtractAndDemote(fromDouble(vertex), fromDouble(camera));
      const glm::vec3 words = subtractWordsAndDemote(fromDouble(vertex), fromDouble(camera));
      const glm::vec3 cpu = cameraRelative(vertex, camera);
      for (int axis = 0; axis < 3; ++axis) {
        const double away = std::fabs(vertex[axis] - camera[axis]);
        const double size = std::max(std::fabs(vertex[axis]), std::fabs(camera[axis]));
        const double pairBound = kSubtractAndDemoteBound * kFloatUnit * away * 1.001 + 2 * kFloatUnitSquared * size;
        worstPair = std::max(worstPair, errorOf(pair[axis], vertex[axis], camera[axis]) / pairBound);
        worstWords = std::max(worstWords, errorOf(words[axis], vertex[axis], camera[axis]) /
                                              (2.001 * kFloatUnit * away + 4 * kFloatUnitSquared * size));
        worstCpu = std::max(
            worstCpu, errorOf(cpu[axis], vertex[axis], camera[axis]) / (kFloatUnit * away * 1.001 + 0x1p-53 * away));
        control = std::max(control, errorOf(static_cast<float>(vertex[axis]) - static_cast<float>(camera[axis]),
                                            vertex[axis], camera[axis]) /
                                        pairBound);
      }
    }
    std::cout << distanceMeters << " m: share of the bound: 18 operations " << worstPair << ", 3 operations "
              << worstWords << ", CPU " << worstCpu << "; control, float: " << control << '\n';
    EXPECT_LE(worstPair, 1.0) << distanceMeters;
    EXPECT_LE(worstWords, 1.0) << distanceMeters;
    EXPECT_LE(worstCpu, 1.0) << distanceMeters;
    EXPECT_GT(control, distanceMeters > 1e5 ? 1e4 : 0.0) << distanceMeters;
  }
}

TEST(RelativePosition, LatticeIntegersAreExactButForTheCamerasRestAtAnyDistance) {
  Operands operands(362);
  double worst = 0, control = 0;
  for (int i = 0; i < 20000; ++i) {
    const int exponent = static_cast<int>(operands.bits(5)) - 23;  // steps of 2^-23 .. 2^8 m
    const double step = std::ldexp(1.0, exponent);
    const double distanceMeters = step * 0x1p44 < 30 * kAstronomicalUnitMeters ? step * 0x1p43 : 1e12;
    const glm::dvec3 camera = somewhere(operands, distanceMeters);
    const CameraOnLattice onLattice = cameraOnLattice(camera, step);
    const glm::i64vec3 away(static_cast<std::int64_t>(operands.bits(18)) - (1 << 17));
    const auto toOrigin = originMinusCamera(onLattice.steps + away, onLattice.steps);
    ASSERT_TRUE(toOrigin);
    const glm::ivec3 offset(operands.bits(16), operands.bits(16), operands.bits(16));
    const glm::vec3 placed = relativeOnLattice(*toOrigin, offset, onLattice.rest, static_cast<float>(step));
    for (int axis = 0; axis < 3; ++axis) {
      const HighPrecision truth =
          HighPrecision(onLattice.steps[axis] + away[axis] + offset[axis]) * step - HighPrecision(camera[axis]);
      const double size = std::fabs(static_cast<double>(truth));
      // The subtraction rounds by u of the result, the rest by u/2 of a step.
      const double bound = 2.5 * kFloatUnit * size + kFloatUnit * step;
      worst =
          std::max(worst, std::fabs(static_cast<double>(HighPrecision(HighPrecision(placed[axis]) - truth))) / bound);
      const float plain =
          static_cast<float>(static_cast<double>(onLattice.steps[axis] + away[axis] + offset[axis]) * step) -
          static_cast<float>(camera[axis]);
      control = std::max(control, std::fabs(static_cast<double>(HighPrecision(HighPrecision(plain) - truth))) / bound);
    }
  }
  std::cout << "share of the bound " << worst << "; control, float: " << control << '\n';
  EXPECT_LE(worst, 1.0);
  EXPECT_GT(worst, 0.2);
  EXPECT_GT(control, 1e3);
}

TEST(RelativePosition, ACameraThatIsNowhereIsOnTheLatticeNevertheless) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const CameraOnLattice camera = cameraOnLattice({inf, nan, -1e300}, 0.25);
  EXPECT_EQ(camera.steps, glm::i64vec3(std::int64_t{1} << 62, 0, -(std::int64_t{1} << 62)));
  EXPECT_FALSE(originMinusCamera(glm::i64vec3(0), camera.steps));
}

TEST(RelativePosition, AMorphedVertexStartsWithItsOwnBitsEndsWithItsParentsAndErrsLittleInBetween) {
  Operands operands(366);
  double worst = 0;
  std::size_t parents = 0, odd = 0;
  for (int i = 0; i < 20000; ++i) {
    const double step = std::ldexp(1.0, static_cast<int>(operands.bits(5)) - 23);
    const glm::dvec3 camera = somewhere(operands, step * 0x1p43);
    const CameraOnLattice own = cameraOnLattice(camera, step), onParents = cameraOnLattice(camera, 2 * step);
    const glm::ivec3 cameraOffBy = cameraOdd(own, onParents);
    odd += cameraOffBy.x == 1 ? 1u : 0u;
    for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(cameraOffBy[axis] & ~1, 0);
    const auto away = [&] { return static_cast<std::int64_t>(operands.bits(18)) - (1 << 17); };
    // A vertex of the parent's near the camera, and one of the child's near that.
    const glm::i64vec3 parent = onParents.steps + glm::i64vec3(away(), away(), away());
    const glm::ivec3 toParent(operands.bits(9) - 256, operands.bits(9) - 256, operands.bits(9) - 256);
    const glm::i64vec3 vertex = parent * std::int64_t{2} - glm::i64vec3(toParent);
    const glm::ivec3 steps(vertex - own.steps);
    const auto stepFloat = static_cast<float>(step);
    const auto at = [&](float morph, bool onVertex) {
      return relativeMorphed(steps, toParent, morph, onVertex, own.rest, stepFloat, cameraOffBy, onParents.rest);
    };
    ASSERT_EQ(at(0, true), relativeOnLattice(steps, glm::ivec3(0), own.rest, stepFloat));
    ASSERT_EQ(at(1, true),
              relativeOnLattice(glm::ivec3(parent - onParents.steps), glm::ivec3(0), onParents.rest, 2 * stepFloat));
    ++parents;
    const auto morph = static_cast<float>(0.5 + 0.5 * unit(operands));
    const glm::vec3 between = at(morph, true), end = at(1, false);
    for (int axis = 0; axis < 3; ++axis) {
      const auto check = [&](float placed, double share) {
        const HighPrecision truth =
            (HighPrecision(vertex[axis]) + HighPrecision(toParent[axis]) * share) * step - HighPrecision(camera[axis]);
        const double size = std::fabs(static_cast<double>(truth)) + std::abs(toParent[axis]) * step;
        const double bound = 3.5 * kFloatUnit * size + kFloatUnit * step;
        worst = std::max(worst, std::fabs(static_cast<double>(HighPrecision(HighPrecision(placed) - truth))) / bound);
      };
      check(between[axis], static_cast<double>(morph));
      check(end[axis], 1);
    }
  }
  std::cout << parents << " vertices, " << odd << " cameras odd in x: share of the bound " << worst << '\n';
  EXPECT_LE(worst, 1.0);
  EXPECT_GT(worst, 0.2);
  EXPECT_GT(odd, parents / 3);
}

TEST(RelativePosition, ASplitAt65536MetresLosesMillimetresWherePairsLoseNone) {
  // Cesium's encoding: multiples of 65536 m towards 0, and the rest, each as a float.
  Operands operands(363);
  double worst = 0, pairs = 0;
  const auto split = [](double meters) {
    const double high = std::trunc(meters / 65536) * 65536;
    return DoubleFloat(static_cast<float>(high), static_cast<float>(meters - high));
  };
  for (int i = 0; i < 20000; ++i) {
    const double camera = 6.371e6 * unit(operands), vertex = camera + 2 * unit(operands);
    worst = std::max(worst, errorOf(subtractWordsAndDemote(split(vertex), split(camera)), vertex, camera));
    pairs = std::max(pairs, errorOf(subtractWordsAndDemote(fromDouble(vertex), fromDouble(camera)), vertex, camera));
  }
  std::cout << "split: " << worst << " m, pairs: " << pairs << " m\n";
  // Two rests of up to 65536 m, half an ulp (2^-9 m) each, and the difference.
  EXPECT_LE(worst, 2 * 0x1p-9 + 1e-6);
  EXPECT_GT(worst, 1.9e-3) << "the known figure at the Earth's radius";
  EXPECT_LE(pairs, 1.5e-7);
}

TEST(TiledPosition, OffsetsKeepTheirBoundAndRegularisationLosesNothing) {
  Operands operands(364);
  for (const float tileMeters : {2048.0f, 0x1p18f, 0x1p21f}) {
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 at = somewhere(operands, 1e9);
      const TiledPosition tiled = tiledFromDouble(at, tileMeters);
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_LE(std::fabs(tiled.offsetMeters[axis]), tileMeters / 2);
        worst = std::max(worst, std::fabs(toDouble(tiled, tileMeters)[axis] - at[axis]));
      }
      // Just below, on and above a border, where a half that is added in float would be rounded.
      const double border =
          (std::floor(at.x / static_cast<double>(tileMeters)) + 0.5) * static_cast<double>(tileMeters);
      for (const double near :
           {std::nextafter(border, -1e30), border, std::nextafter(border, 1e30), border - 0.03 * unit(operands)}) {
        const TiledPosition there = tiledFromDouble(glm::dvec3(near), tileMeters);
        ASSERT_LE(std::fabs(there.offsetMeters.x), tileMeters / 2);
        worst = std::max(worst, std::fabs(toDouble(there, tileMeters).x - near));
      }
      TiledPosition unruly = tiled;
      unruly.offsetMeters += glm::vec3(3 * tileMeters);
      ASSERT_EQ(toDouble(regularised(unruly, tileMeters), tileMeters), toDouble(unruly, tileMeters));
    }
    std::cout << "tiles of " << tileMeters << " m: off by " << worst << " m\n";
    EXPECT_LE(worst, tiledPositionBound(static_cast<double>(tileMeters)));
    EXPECT_GT(worst, 0.9 * tiledPositionBound(static_cast<double>(tileMeters)));
  }
  for (const float below : {std::nextafter(0x1p20f, 0.0f), -std::nextafter(0x1p20f, 0.0f), 0x1p20f, -0x1p20f}) {
    const TiledPosition at{glm::ivec3(0), glm::vec3(below)};
    EXPECT_EQ(toDouble(regularised(at, 0x1p21f), 0x1p21f).x, static_cast<double>(below)) << below;
  }
  const float nan = test::Limits::quiet_NaN();
  EXPECT_TRUE(std::isnan(tiledFromDouble(glm::dvec3(nan), 2048.0f).offsetMeters.x));
  EXPECT_EQ(tiledFromDouble(glm::dvec3(test::Limits::infinity()), 2048.0f).tile, glm::ivec3(0));
  EXPECT_TRUE(std::isnan(tiledFromDouble(glm::dvec3(0x1p42), 2048.0f).offsetMeters.x)) << "out of reach";
}

TEST(TiledPosition, PrecisionFallsOffTowardsATilesBorderAndWithoutEndWhereOffsetsAreNotRegularised) {
  // A thing that moves by 1 mm a frame: in the middle of a tile of 2^18 m it does, at the border it does not, and an
  // offset that only ever grows stands still at last.
  constexpr float kTileMeters = 0x1p18f, kStepMeters = 0.001f;
  const auto travelled = [&](double fromMeters, bool regularise) {
    TiledPosition at{glm::ivec3(0), glm::vec3(static_cast<float>(fromMeters), 0, 0)};
    const double before = toDouble(at, kTileMeters).x;
    for (int frame = 0; frame < 1000; ++frame) {
      at.offsetMeters.x += kStepMeters;
      if (regularise) at = regularised(at, kTileMeters);
    }
    return toDouble(at, kTileMeters).x - before;
  };
  const double middle = travelled(0, true), border = travelled(131000, true),
               unruly = travelled(38 * 0x1p18 + 100, false), regular = travelled(38 * 0x1p18 + 100, true);
  std::cout << "1 m in steps of 1 mm: in the middle " << middle << " m, at the border " << border
            << " m; 10,000 km from the origin " << unruly << " m, regularised first " << regular << " m\n";
  EXPECT_NEAR(middle, 1, 1e-3);
  EXPECT_GT(std::fabs(border - 1), 0.5) << "the falloff: half an ulp there is 3.9 mm, so that 1 mm is nothing";
  EXPECT_EQ(unruly, 0.0);
  EXPECT_NEAR(regular, 1, 0.25);
}

TEST(TiledPosition, ACameraThatCrossesATilesBorderMakesItsSurroundingsJumpUnlessTheWayIsHalved) {
  // The oscillation: vertices around a border, the camera to and fro across it by a millimetre.
  Operands operands(365);
  constexpr float kTileMeters = 0x1p21f;
  constexpr double kBorderMeters = 0x1p20;
  double jump = 0, steady = 0;
  for (int i = 0; i < 20000; ++i) {
    // Multiples of 1/16 m, which offsets hold exactly up to the border: all that errs is the subtraction.
    const auto place = [&](double meters) { return glm::dvec3(std::round(meters * 16) / 16, 0, 0); };
    const TiledPosition vertex = tiledFromDouble(place(kBorderMeters + 20 * unit(operands)), kTileMeters);
    const TiledPosition camera = tiledFromDouble(place(kBorderMeters + 20 * unit(operands)), kTileMeters);
    const double truth = toDouble(vertex, kTileMeters).x - toDouble(camera, kTileMeters).x;
    const auto error = [&](const glm::vec3& placed) { return std::fabs(static_cast<double>(placed.x) - truth); };
    jump = std::max(jump, error(relativeByTilesAndOffsets(vertex.tile, vertex.offsetMeters, camera.tile,
                                                          camera.offsetMeters, kTileMeters)));
    steady = std::max(steady, error(relativeByHalves(vertex.tile, vertex.offsetMeters, camera.tile, camera.offsetMeters,
                                                     kTileMeters)));
  }
  std::cout << "off by " << jump << " m; by halves: " << steady << " m\n";
  EXPECT_EQ(steady, 0.0);
  EXPECT_GT(jump, 0.05);
}

TEST(TiledPosition, AProductOfTiledNumbersNeedsBothCrossTerms) {
  // (T1 S + O1) (T2 S + O2): leaving out O1 T2 S, as is easily done, is wrong as soon as the second leaves its tile.
  constexpr double kSize = 8, kT1 = 3, kO1 = 1.5, kT2 = 4, kO2 = 2.25;
  const double exact = (kT1 * kSize + kO1) * (kT2 * kSize + kO2);
  const double full = kT1 * kT2 * kSize * kSize + kT1 * kSize * kO2 + kO1 * kT2 * kSize + kO1 * kO2;
  EXPECT_EQ(full, exact);
  EXPECT_EQ(exact - (full - kO1 * kT2 * kSize), 48.0) << "the control";
}

}  // namespace
}  // namespace terrane
