// The far field: what its polynomials miss stays below what far_field.h states, by the worst choice of everything, and
// a tile made with it is the tile made without.

#include "server/fields/far_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>

#include "server/fields/far_fit.h"
#include "server/fields/feature_layers.h"
#include "tests/unit/fields/field_samples.h"

namespace terrane::lunar {
namespace {

using namespace terrane::test;

double valueAt(const FarHeight& polynomial, double a, double b) {
  double sum = 0, powerB = 1;
  std::size_t term = 0;
  for (int j = 0; j <= kFarHeightDegree; ++j, powerB *= b) {
    double power = powerB;
    for (int i = 0; i + j <= kFarHeightDegree; ++i, power *= a) sum += polynomial.coefficients[term++] * power;
  }
  return sum;
}

/// The polynomial of a function of the patch's points.
FarHeight fitted(const FarPatch& patch, const std::function<double(const glm::dvec3&)>& function) {
  static Block block;
  for (int k = 0; k < kFarNodeCount; ++k) {
    glm::dvec3 p;
    patch.pointAt(farNodeA(k), farNodeB(k), &p.x);
    block.relief[k] = function(p);
  }
  FarExpansion expansion;
  fitExpansion(patch, block, expansion);
  return expansion.relief;
}

/// A tile's patch, as far as its shape goes: up to half as long again as it is wide.
FarPatch randomPatch(std::mt19937_64& random, const glm::dvec3& direction, double ballRadius) {
  std::uniform_real_distribution<double> unit;
  const glm::dvec3 side = glm::normalize(glm::cross(direction, randomDirection(random)));
  const glm::dvec3 other = glm::cross(direction, side);
  const double longer = 0.5 + unit(random);
  const double scale = ballRadius / (1.01 * std::sqrt(1 + longer * longer)) / kMoonRadius;
  std::vector<double> x, y, z;
  for (const double v : {-1.0, 1.0}) {
    for (const double u : {-1.0, 1.0}) {
      const glm::dvec3 p = glm::normalize(direction + scale * (u * side + v * longer * other));
      x.push_back(p.x);
      y.push_back(p.y);
      z.push_back(p.z);
    }
  }
  const glm::dvec3 middle = direction * kMoonRadius;
  return patchAround({x.data(), y.data(), z.data(), 4, kMoonRadius, {{middle.x, middle.y, middle.z}, ballRadius}}, 2,
                     kMoonRadius);
}

constexpr double kPlaces[] = {-1.0, -0.84, -0.5, 0.0, 0.47, 0.86, 1.0};

/// A corner's weight falls with it, on either side of the corner.
double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

/// Of noise of wavelength 1 and amplitude 1 over a patch within its cell [0, 1]^3: what the worst directions of all
/// corners together add to the polynomial's error.
double worstOctaveError(const FarPatch& patch, const glm::dvec3& origin) {
  std::array<double, std::size(kPlaces) * std::size(kPlaces)> sums{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::array<FarHeight, 3> parts;
    const auto part = [&](const glm::dvec3& p, int axis) {
      const glm::dvec3 t = p - origin;
      double weight = 1;
      glm::dvec3 d;
      for (int i = 0; i < 3; ++i) {
        d[i] = t[i] - ((corner >> i) & 1u ? 1 : 0);
        weight *= 1 - fade(std::min(1.0, std::abs(d[i])));
      }
      return weight * d[axis];
    };
    for (int axis = 0; axis < 3; ++axis)
      parts[static_cast<std::size_t>(axis)] = fitted(patch, [&](const glm::dvec3& p) { return part(p, axis); });
    std::size_t at = 0;
    for (const double b : kPlaces) {
      for (const double a : kPlaces) {
        glm::dvec3 p, error;
        patch.pointAt(a, b, &p.x);
        for (int axis = 0; axis < 3; ++axis)
          error[axis] = std::abs(valueAt(parts[static_cast<std::size_t>(axis)], a, b) - part(p, axis));
        sums[at++] += error.x + error.y + error.z - std::min({error.x, error.y, error.z});
      }
    }
  }
  return *std::max_element(sums.begin(), sums.end());
}

TEST(FarField, NoChoiceOfGradientsExceedsTheOctaveError) {
  std::mt19937_64 random(59);
  std::uniform_real_distribution<double> unit;
  double worst = 0, across = 0;
  for (int i = 0; i < 1500; ++i) {
    const glm::dvec3 direction = randomDirection(random);
    const FarPatch patch = randomPatch(random, direction, 1 / kFarOctaveRadii);
    const double room = 1 - 2.001 * patch.ball.radius;
    glm::dvec3 within;
    for (int axis = 0; axis < 3; ++axis) within[axis] = patch.ball.radius + room * unit(random);
    const glm::dvec3 middle(patch.origin[0], patch.origin[1], patch.origin[2]);
    worst = std::max(worst, worstOctaveError(patch, middle - within));
    if (i < 100) across = std::max(across, worstOctaveError(patch, middle));
  }
  std::printf("worst %.3e of the amplitude, next to a cell's border %.3e\n", worst, across);
  EXPECT_LE(worst, kFarOctaveError);
  EXPECT_GT(worst, 0.5 * kFarOctaveError);
  EXPECT_GT(across, 10 * kFarOctaveError) << "control: a polynomial cannot follow from cell to cell";
}

Program emptyProgram(double footprint) {
  Program program{};
  program.radius = kMoonRadius;
  program.minWavelength = 1e-3;
  program.footprint = footprint;
  program.lavaBlend = program.clampBlend = 1;
  return program;
}

/// One of the kernels' own sums at a point.
double sumAt(const Program& program, double (Block::*sum)[kBlockCapacity], const glm::dvec3& p) {
  static Block block;
  block.count = kChunk;
  for (std::size_t i = 0; i < block.count; ++i) {
    block.x[i] = p.x;
    block.y[i] = p.y;
    block.z[i] = p.z;
  }
  evaluateBlockDefault(program, block);
  return (block.*sum)[0];
}

/// Less what doubles round at the Moon's radius, which is no error of the polynomial.
double worstError(const FarPatch& patch, const std::function<double(const glm::dvec3&)>& height, double rounding) {
  const FarHeight polynomial = fitted(patch, height);
  double worst = 0;
  for (const double b : kPlaces) {
    for (const double a : kPlaces) {
      glm::dvec3 p;
      patch.pointAt(a, b, &p.x);
      worst = std::max(worst, std::abs(valueAt(polynomial, a, b) - height(p)) - rounding);
    }
  }
  return worst;
}

/// A direction so far from another, to any side.
glm::dvec3 directionBeside(std::mt19937_64& random, const glm::dvec3& direction, double distanceMeters) {
  const glm::dvec3 side = glm::normalize(glm::cross(direction, randomDirection(random)));
  return glm::normalize(direction + side * (distanceMeters / kMoonRadius));
}

TEST(FarField, CratersStayWithinTheirErrors) {
  std::mt19937_64 random(61);
  std::uniform_real_distribution<double> unit;
  double worstEjecta = 0, worstBowl = 0, crossing = 0;
  int far = 0;
  for (int i = 0; i < 6000; ++i) {
    const glm::dvec3 center = randomDirection(random);
    const double diameter = std::exp2(4 + 14 * unit(random));
    const double wear = unit(random);
    const Feature crater = makeCrater(&center.x, kMoonRadius, diameter, wear, random());
    const double distance = crater.radius * 2.4 * std::sqrt(unit(random));
    const double ballRadius = distance / kFarFeatureRadii * std::exp2(-2 * unit(random));
    const FarPatch patch = randomPatch(random, directionBeside(random, center, distance), std::max(0.5, ballRadius));
    const FeatureRun run{&crater, 1, FeatureStage::YoungCrater, true};
    Program program = emptyProgram(ballRadius / 50);
    program.runs = &run;
    program.runCount = 1;
    const double bound = farCraterError(crater, program, patch.ball);
    const bool isFar = bound < 1e9;
    if (!isFar && (i % 10 != 0 || patch.ball.radius * kFarFeatureRadii > distance)) continue;
    const double error = worstError(
        patch, [&](const glm::dvec3& p) { return sumAt(program, &Block::young, p); }, 1e-9);
    if (!isFar) {
      crossing = std::max(crossing, error / (crater.rim - crater.floor));
      continue;
    }
    ++far;
    EXPECT_LE(error, bound);
    const double share = kFarFeatureRadii * patch.ball.radius / (0.9 * distance);
    const bool ejecta = bound < kFarEjectaError * crater.rim * std::pow(share, 6) && distance > crater.radius;
    double& worst = ejecta ? worstEjecta : worstBowl;
    if (bound > 0) worst = std::max(worst, error / bound);
  }
  std::printf("%d far, worst of the bounds %.3f (ejecta), %.3f (bowl); with a joint across %.1e of the depth\n", far,
              worstEjecta, worstBowl, crossing);
  EXPECT_GT(far, 300);
  EXPECT_GT(worstEjecta, 0.1);
  EXPECT_GT(worstBowl, 0.1);
  EXPECT_GT(crossing, 2 * kFarBowlError) << "control: a polynomial cannot follow over a joint";
}

TEST(FarField, BasinsAndLavaStayWithinTheirErrors) {
  std::mt19937_64 random(67);
  std::uniform_real_distribution<double> unit;
  double worstBasin = 0, worstLava = 0;
  int far = 0;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 direction = randomDirection(random), center = direction * kMoonRadius;
    const double radius = 100e3 * (1 + 9 * unit(random)), height = 1000 + 8000 * unit(random);
    const double ballRadius = radius / kFarFeatureRadii * std::exp2(-3 * unit(random));
    const FarPatch patch =
        randomPatch(random, directionBeside(random, direction, 1.3 * radius * unit(random)), ballRadius);
    Program program = emptyProgram(0);
    const Basin basin{{center.x, center.y, center.z}, 1 / (radius * radius), 1.3 * radius, height, 0.3 * height};
    program.basins = &basin;
    program.basinCount = 1;
    const double inner = 0.3 + 0.6 * unit(random);
    const LavaPatch lava{
        {center.x, center.y, center.z}, 1 / (radius * radius), radius, inner * inner, 1 / (1 - inner * inner)};
    program.patches = &lava;
    program.patchCount = 1;
    if (const double bound = farBasinError(basin, patch.ball); bound < 1e9) {
      const double error = worstError(
          patch, [&](const glm::dvec3& p) { return sumAt(program, &Block::relief, p); }, 1e-8);
      EXPECT_LE(error, bound);
      if (bound > 0) worstBasin = std::max(worstBasin, error / bound);
      ++far;
    }
    if (const double bound = farLavaPatchError(lava, height, patch.ball); bound < 1e9) {
      const double error = worstError(
          patch, [&](const glm::dvec3& p) { return height * sumAt(program, &Block::dry, p); }, 1e-8);
      EXPECT_LE(error, bound);
      if (bound > 0) worstLava = std::max(worstLava, error / bound);
      ++far;
    }
  }
  std::printf("%d far, worst of the bounds %.3f (basins), %.3f (lava)\n", far, worstBasin, worstLava);
  EXPECT_GT(far, 300);
  EXPECT_GT(std::min(worstBasin, worstLava), 0.02);
}

}  // namespace
}  // namespace terrane::lunar
