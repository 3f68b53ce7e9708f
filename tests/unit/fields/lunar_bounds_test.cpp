// The proven bounds against searches for violations: random places, then climbing towards the worst. Each prints how
// near it came.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "server/fields/lunar_bounds.h"
#include "tests/unit/fields/field_samples.h"

namespace terrane {
namespace {

using namespace test;

/// Moves every point towards larger scores: keeps the best of its own and of tries in shrinking neighbourhoods.
template <class Score>
double climb(std::mt19937_64& random, int points, int rounds, double reachMeters, const Score& score) {
  Directions best;
  for (int i = 0; i < points; ++i) best.add(randomDirection(random));
  std::vector<double> value = score(best);
  for (int round = 0; round < rounds; ++round) {
    Directions next;
    const double reach = reachMeters / kMoonRadius * std::pow(0.75, round);
    for (int i = 0; i < points; ++i)
      next.add(glm::normalize(best.at(static_cast<std::size_t>(i)) + reach * randomDirection(random)));
    const std::vector<double> tried = score(next);
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (tried[i] <= value[i]) continue;
      value[i] = tried[i];
      best.x[i] = next.x[i];
      best.y[i] = next.y[i];
      best.z[i] = next.z[i];
    }
  }
  return *std::max_element(value.begin(), value.end());
}

TEST(LunarBounds, NothingLeftOutMovesTheGroundByMoreThanStated) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  std::mt19937_64 random(41);
  for (const int level : {2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24}) {
    const double wavelength = 2 * tileSpacing(level);
    const double bound = field->omittedAmplitudeMeters(wavelength, 0);
    const double worst = climb(random, 60, 9, 4 * wavelength, [&](const Directions& d) {
      const SurfaceSamples coarse = evaluate(*field, d, wavelength), fine = evaluate(*field, d, 0);
      std::vector<double> difference;
      for (std::size_t i = 0; i < d.x.size(); ++i) {
        difference.push_back(std::fabs(coarse.heightMeters[i] - fine.heightMeters[i]));
      }
      return difference;
    });
    std::printf("level %2d: left out up to %.4g m, stated %.4g m (%.0f %%)\n", level, worst, bound,
                100 * worst / bound);
    EXPECT_LE(worst, bound) << "level " << level;
    EXPECT_GT(worst, 0.02 * bound) << "level " << level;
  }
}

TEST(LunarBounds, NothingIsLeftOutBetweenEqualWavelengthsAndMoreBetweenFarOnes) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  EXPECT_EQ(field->omittedAmplitudeMeters(10, 10), 0);
  EXPECT_EQ(field->omittedAmplitudeMeters(0, 0), 0);
  EXPECT_LT(field->omittedAmplitudeMeters(10, 1), field->omittedAmplitudeMeters(10, 0.1));
  EXPECT_LE(field->omittedAmplitudeMeters(10, 1), field->omittedAmplitudeMeters(100, 1));
}

TEST(LunarBounds, TheBilinearSurfaceIsAsNearAsStated) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  std::mt19937_64 random(43);
  for (const int level : {3, 6, 9, 12, 15, 18, 21, 24}) {
    const double wavelength = 2 * tileSpacing(level);
    const double bound = field->interpolationErrorMeters(wavelength, tileSpacing(level));
    double worst = 0;
    for (int tile = 0; tile < 8; ++tile) {
      const std::uint64_t mask = (std::uint64_t{1} << level) - 1, column = random() & mask, row = random() & mask;
      const int face = static_cast<int>(random() % 6);
      const SurfaceSamples corners = evaluate(*field, tileGrid(face, level, column, row), wavelength);
      // The centres of all cells: where a bilinear patch is farthest from its corners.
      Directions centers;
      for (std::uint64_t j = 0; j < 64; ++j) {
        for (std::uint64_t i = 0; i < 64; ++i) {
          centers.add(cubeGridDirection(face, level + 7, (column * 64 + i) * 2 + 1, (row * 64 + j) * 2 + 1));
        }
      }
      const SurfaceSamples middle = evaluate(*field, centers, wavelength);
      const std::vector<double>& h = corners.heightMeters;
      for (std::size_t k = 0; k < 4096; ++k) {
        const std::size_t at = k / 64 * 65 + k % 64;
        worst =
            std::max(worst, std::fabs(middle.heightMeters[k] - 0.25 * (h[at] + h[at + 1] + h[at + 65] + h[at + 66])));
      }
    }
    std::printf("level %2d: bilinear error up to %.4g m, stated %.4g m (%.0f %%)\n", level, worst, bound,
                100 * worst / bound);
    EXPECT_LE(worst, bound) << "level " << level;
  }
}

TEST(LunarBounds, NoHeightLeavesTheRange) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  const HeightRange range = field->heightRange();
  std::mt19937_64 random(47);
  for (const double sign : {1.0, -1.0}) {
    const double worst = climb(random, 100, 15, 300000, [&](const Directions& d) {
      std::vector<double> heights = evaluate(*field, d, 0).heightMeters;
      for (double& h : heights) h *= sign;
      return heights;
    });
    std::printf("%s point found: %.0f m, stated %.0f m\n", sign > 0 ? "highest" : "lowest", sign * worst,
                sign > 0 ? range.maxMeters : range.minMeters);
    EXPECT_LE(worst, sign > 0 ? range.maxMeters : -range.minMeters);
  }
}

/// What the twelve directions at a cell's corners can make of value, slope along e and curvature along e, at worst.
std::array<double, 3> worstNoise(const std::array<double, 3>& t, const std::array<double, 3>& e) {
  const auto fade = [](double x) { return x * x * x * (x * (x * 6 - 15) + 10); };
  const auto fade1 = [](double x) { return 30 * x * x * (1 - x) * (1 - x); };
  const auto fade2 = [](double x) { return 60 * x * (1 - x) * (1 - 2 * x); };
  std::array<double, 3> sum{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::array<double, 3> w{}, w1{}, w2{}, d{};
    for (unsigned a = 0; a < 3; ++a) {
      const bool high = (corner >> a) & 1u;
      w[a] = high ? fade(t[a]) : 1 - fade(t[a]);
      w1[a] = (high ? 1 : -1) * fade1(t[a]) * e[a];
      w2[a] = (high ? 1 : -1) * fade2(t[a]) * e[a] * e[a];
      d[a] = t[a] - (high ? 1 : 0);
    }
    const double weight = w[0] * w[1] * w[2];
    const double first = w1[0] * w[1] * w[2] + w[0] * w1[1] * w[2] + w[0] * w[1] * w1[2];
    const double second = w2[0] * w[1] * w[2] + w[0] * w2[1] * w[2] + w[0] * w[1] * w2[2] +
                          2 * (w1[0] * w1[1] * w[2] + w1[0] * w[1] * w1[2] + w[0] * w1[1] * w1[2]);
    std::array<double, 3> best{};
    for (unsigned zero = 0; zero < 3; ++zero) {
      for (unsigned signs = 0; signs < 4; ++signs) {
        std::array<double, 3> g{};
        g[(zero + 1) % 3] = signs & 1u ? 1 : -1;
        g[(zero + 2) % 3] = signs & 2u ? 1 : -1;
        const double height = g[0] * d[0] + g[1] * d[1] + g[2] * d[2], along = g[0] * e[0] + g[1] * e[1] + g[2] * e[2];
        best[0] = std::max(best[0], weight * height);
        best[1] = std::max(best[1], weight * along + first * height);
        best[2] = std::max(best[2], 2 * first * along + second * height);
      }
    }
    for (unsigned i = 0; i < 3; ++i) sum[i] += best[i];
  }
  return sum;
}

TEST(LunarBounds, NoChoiceOfGradientsExceedsTheNoiseConstants) {
  std::mt19937_64 random(53);
  std::uniform_real_distribution<double> unit;
  std::array<double, 3> worst{};
  for (int start = 0; start < 400; ++start) {
    for (unsigned which = 0; which < 3; ++which) {
      std::array<double, 3> t{unit(random), unit(random), unit(random)};
      glm::dvec3 e = randomDirection(random);
      double best = worstNoise(t, {e.x, e.y, e.z})[which], step = 0.3;
      for (int i = 0; i < 150; ++i, step *= 0.96) {
        std::array<double, 3> tryT = t;
        for (double& v : tryT) v = std::clamp(v + step * (2 * unit(random) - 1), 0.0, 1.0);
        const glm::dvec3 tryE = glm::normalize(e + step * randomDirection(random));
        const double value = worstNoise(tryT, {tryE.x, tryE.y, tryE.z})[which];
        if (value > best) {
          best = value;
          t = tryT;
          e = tryE;
        }
      }
      worst[which] = std::max(worst[which], best);
    }
  }
  std::printf("worst value %.5f, slope %.4f, curvature %.4f\n", worst[0], worst[1], worst[2]);
  EXPECT_LE(worst[0], lunar::kNoiseBound);
  EXPECT_LE(worst[1], lunar::kNoiseSlope);
  EXPECT_LE(worst[2], lunar::kNoiseCurvature);
  EXPECT_GT(worst[0], 0.99 * lunar::kNoiseBound);
}

}  // namespace
}  // namespace terrane
