// The lunar field as a user of heights sees it: deterministic to the bit, continuous, with true gradients, finite
// everywhere.

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "tests/unit/fields/field_samples.h"

namespace terrane {
namespace {

using namespace test;

bool sameBits(const SurfaceSamples& a, std::size_t i, const SurfaceSamples& b, std::size_t j) {
  const auto bits = [](auto v) {
    return std::bit_cast<std::conditional_t<sizeof(v) == 8, std::uint64_t, std::uint32_t>>(v);
  };
  return bits(a.heightMeters[i]) == bits(b.heightMeters[j]) && bits(a.gradientX[i]) == bits(b.gradientX[j]) &&
         bits(a.gradientY[i]) == bits(b.gradientY[j]) && bits(a.gradientZ[i]) == bits(b.gradientZ[j]) &&
         bits(a.reflectance[i]) == bits(b.reflectance[j]);
}

struct TilePlace {
  int face, level;
  std::uint64_t column, row;
};
TilePlace randomTile(std::mt19937_64& random, int level) {
  const std::uint64_t mask = (std::uint64_t{1} << level) - 1;
  return {static_cast<int>(random() % 6), level, random() & mask, random() & mask};
}

TEST(LunarField, EverySimdPathGivesTheSameBits) {
  std::mt19937_64 random(7);
  std::vector<std::unique_ptr<const HeightField>> fields;
  for (const SimdPath path : supportedPaths()) fields.push_back(makeHeightField(testMoon(), path));
  for (int level = 0; level <= 26; level += 2) {
    const TilePlace t = randomTile(random, level);
    const Directions grid = tileGrid(t.face, t.level, t.column, t.row, 33);
    const SurfaceSamples expected = evaluate(*fields.front(), grid, 2 * tileSpacing(level));
    for (std::size_t p = 1; p < fields.size(); ++p) {
      const SurfaceSamples got = evaluate(*fields[p], grid, 2 * tileSpacing(level));
      for (std::size_t i = 0; i < grid.x.size(); ++i)
        ASSERT_TRUE(sameBits(expected, i, got, i)) << "level " << level << " sample " << i;
    }
  }
}

TEST(LunarField, ASampleDoesNotDependOnItsBatch) {
  std::mt19937_64 random(11);
  for (const SimdPath path : supportedPaths()) {
    const auto field = makeHeightField(testMoon(), path);
    SurfaceSamples reused;
    for (int level = 0; level <= 24; level += 4) {
      const TilePlace t = randomTile(random, level);
      const Directions grid = tileGrid(t.face, t.level, t.column, t.row);
      const double wavelength = 2 * tileSpacing(level);
      const SurfaceSamples whole = evaluate(*field, grid, wavelength);
      for (int repeat = 0; repeat < 12; ++repeat) {
        // A few samples of the tile among strangers from all over the body and from the antipodes, in another order.
        Directions mixed;
        std::vector<std::size_t> from;
        for (int k = 0; k < 23; ++k) {
          from.push_back(random() % grid.x.size());
          mixed.add(grid.at(from.back()));
          mixed.add(k % 2 ? randomDirection(random) : -grid.at(from.back()));
        }
        field->evaluate(mixed.batch(), wavelength, reused);
        for (std::size_t k = 0; k < from.size(); ++k)
          ASSERT_TRUE(sameBits(whole, from[k], reused, 2 * k)) << "level " << level;
      }
    }
  }
}

// As a tile's builder asks: the grid, then each border at the levels beside it, of which heights alone are wanted.
TEST(LunarField, HeightsOfBordersHaveTheBitsOfWholeSamples) {
  std::mt19937_64 random(12);
  for (const SimdPath path : supportedPaths()) {
    const auto field = makeHeightField(testMoon(), path);
    for (int level = 0; level <= 24; ++level) {
      const TilePlace t = randomTile(random, level);
      const Directions grid = tileGrid(t.face, t.level, t.column, t.row);
      const double wavelength = 2 * tileSpacing(level);
      SurfaceSamples built = evaluate(*field, grid, wavelength);
      for (int edge = 0; edge < 4; ++edge) {
        Directions border;
        for (std::size_t k = 0; k < 65; ++k)
          border.add(grid.at(edge == 0 ? k : edge == 1 ? 65 * k + 64 : edge == 2 ? 64 * 65 + 64 - k : 65 * (64 - k)));
        SampleBatch batch = border.batch();
        batch.grid = GridPlace{FacePath::wholeFace(Scheme::Cube, t.face), 64, edge};
        for (const double finer : {2.0, 1.0, 0.5}) {
          const SurfaceSamples alone = evaluate(*field, border, finer * wavelength);
          field->evaluate(batch, finer * wavelength, built);
          ASSERT_EQ(alone.heightMeters, built.heightMeters) << "level " << level << ", edge " << edge;
        }
      }
    }
  }
}

TEST(LunarField, TilesThatShareAnEdgeAgreeOnIt) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  for (int level = 1; level <= 24; level += 3) {
    const std::uint64_t last = (std::uint64_t{1} << level) - 1, middle = last / 2;
    const double wavelength = 2 * tileSpacing(level);
    // Face 0's u axis ends where face 2 begins: +X's right edge is +Y's left edge, row for row.
    const SurfaceSamples right = evaluate(*field, tileGrid(0, level, last, middle), wavelength);
    const SurfaceSamples left = evaluate(*field, tileGrid(2, level, 0, middle), wavelength);
    for (std::size_t j = 0; j < 65; ++j) ASSERT_TRUE(sameBits(right, j * 65 + 64, left, j * 65)) << "level " << level;
  }
}

TEST(LunarField, OneUlpOfDirectionMovesTheHeightByNextToNothing) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  std::mt19937_64 random(13);
  Directions a, b;
  for (int i = 0; i < 3000; ++i) {
    glm::dvec3 d = randomDirection(random);
    if (i % 4 == 0) d = glm::normalize(glm::dvec3(i % 8 ? 1e-17 : -1e-300, d.y, d.z));  // through a plane of the axes
    a.add(d);
    d[i % 3] = std::nextafter(d[i % 3], i % 2 ? 2.0 : -2.0);
    b.add(d);
  }
  const SurfaceSamples sa = evaluate(*field, a, 0), sb = evaluate(*field, b, 0);
  double worst = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i)
    worst = std::max(worst, std::fabs(sa.heightMeters[i] - sb.heightMeters[i]));
  std::printf("largest step: %.3g m\n", worst);
  EXPECT_LT(worst, 2e-5);
}

TEST(LunarField, GradientsAgreeWithFiniteDifferences) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  std::mt19937_64 random(17);
  for (const double wavelength : {100000.0, 5000.0, 300.0, 20.0, 0.5}) {
    const double step = wavelength * 2e-3 + (wavelength < 4 ? 4e-3 : 1.0);  // well above the heights' rounding
    Directions points;
    std::vector<glm::dvec3> tangents;
    for (int i = 0; i < 600; ++i) {
      const glm::dvec3 d = randomDirection(random);
      const glm::dvec3 t = glm::normalize(glm::cross(d, randomDirection(random)));
      tangents.push_back(t);
      points.add(d);
      points.add(glm::normalize(d + t * (step / kMoonRadius)));
      points.add(glm::normalize(d - t * (step / kMoonRadius)));
    }
    const SurfaceSamples s = evaluate(*field, points, wavelength);
    double square = 0, slope = 0;
    int far = 0;
    for (std::size_t i = 0; i < tangents.size(); ++i) {
      const double difference = (s.heightMeters[3 * i + 1] - s.heightMeters[3 * i + 2]) / (2 * step);
      const glm::dvec3 gradient(s.gradientX[3 * i], s.gradientY[3 * i], s.gradientZ[3 * i]);
      EXPECT_NEAR(glm::dot(gradient, points.at(3 * i)), 0, 1e-5);
      const double error = glm::dot(gradient, tangents[i]) - difference;
      square += error * error;
      slope += difference * difference;
      far += std::fabs(error) > 0.02;
    }
    const double n = static_cast<double>(tangents.size());
    std::printf("wavelength %g m: slope rms %.4f, gradient error rms %.2g\n", wavelength, std::sqrt(slope / n),
                std::sqrt(square / n));
    EXPECT_LT(std::sqrt(square / n), 0.004) << wavelength;
    EXPECT_LT(far, 6) << wavelength;  // a step over a sharp crest
  }
}

TEST(LunarField, GradientsOverAFootprintAreThoseOfTheGroundAveragedOverIt) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  std::mt19937_64 random(18);
  for (const int level : {5, 10, 15, 19}) {
    const double cell = tileSpacing(level);
    Directions points;
    std::vector<glm::dvec3> tangents;
    for (int i = 0; i < 1500; ++i) {
      const glm::dvec3 d = randomDirection(random);
      tangents.push_back(glm::normalize(glm::cross(d, randomDirection(random))));
      points.add(d);
      points.add(glm::normalize(d + tangents.back() * (cell / kMoonRadius)));
      points.add(glm::normalize(d - tangents.back() * (cell / kMoonRadius)));
    }
    SurfaceSamples exact, averaged;
    SampleBatch batch = points.batch();
    field->evaluate(batch, 2 * cell, exact);
    batch.footprintMeters = cell;
    field->evaluate(batch, 2 * cell, averaged);
    const auto squareError = [&](const SurfaceSamples& s) {
      double sum = 0;
      for (std::size_t i = 0; i < tangents.size(); ++i) {
        const double mean = (exact.heightMeters[3 * i + 1] - exact.heightMeters[3 * i + 2]) / (2 * cell);
        const glm::dvec3 gradient(s.gradientX[3 * i], s.gradientY[3 * i], s.gradientZ[3 * i]);
        const double error = glm::dot(gradient, tangents[i]) - mean;
        sum += error * error;
      }
      return sum / static_cast<double>(tangents.size());
    };
    const double point = std::sqrt(squareError(exact)), footprint = std::sqrt(squareError(averaged));
    std::printf("level %d: error rms of gradients at the point %.4f, over a footprint %.4f\n", level, point, footprint);
    EXPECT_LT(footprint, 0.85 * point) << level;
    EXPECT_EQ(averaged.heightMeters, exact.heightMeters) << "heights are those of the point";
  }
}

TEST(LunarField, SamplesDoNotDependOnWhatWasGatheredBefore) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  std::mt19937_64 random(12);
  for (int level = 2; level <= 24; level += 2) {
    const TilePlace t = randomTile(random, level);
    SurfaceSamples reused;
    field->evaluate(tileGrid(t.face, t.level, t.column, t.row).batch(), 2 * tileSpacing(level), reused);
    // A border at the next finer level, then at the next coarser one, then the tile beside, in the same memory.
    const std::uint64_t beside = t.column ^ 1u;
    for (const int other : {level + 1, level - 1, level}) {
      Directions edge;
      if (other == level) {
        edge = tileGrid(t.face, t.level, beside, t.row);
      } else {
        for (std::uint64_t k = 0; k <= 128; ++k)
          edge.add(cubeGridDirection(t.face, level + 7, t.column * 128 + k, t.row * 128));
      }
      field->evaluate(edge.batch(), 2 * tileSpacing(other), reused);
      const SurfaceSamples fresh = evaluate(*field, edge, 2 * tileSpacing(other));
      for (std::size_t i = 0; i < edge.x.size(); ++i) ASSERT_TRUE(sameBits(fresh, i, reused, i)) << level << ' ' << i;
    }
  }
}

TEST(LunarField, IsFiniteAndInRangeAtPolesAxesCornersAndEverywhere) {
  for (const SimdPath path : supportedPaths()) {
    const auto field = makeHeightField(testMoon(), path);
    Directions points;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (x || y || z) points.add(glm::normalize(glm::dvec3(x, y, z)));
        }
      }
    }
    points.add({0.0, -0.0, 1.0});
    points.add({-0.0, 1.0, -0.0});
    std::mt19937_64 random(19);
    for (int i = 0; i < 1000; ++i) points.add(randomDirection(random));
    const HeightRange range = field->heightRange();
    for (const double wavelength : {1e9, 1e5, 1e2, 0.0}) {
      const SurfaceSamples s = evaluate(*field, points, wavelength);
      for (std::size_t i = 0; i < points.x.size(); ++i) {
        ASSERT_TRUE(std::isfinite(s.heightMeters[i]) &&
                    std::isfinite(s.gradientX[i] + s.gradientY[i] + s.gradientZ[i]));
        ASSERT_GE(s.heightMeters[i], range.minMeters);
        ASSERT_LE(s.heightMeters[i], range.maxMeters);
        ASSERT_GE(s.reflectance[i], 0.02f);
        ASSERT_LE(s.reflectance[i], 0.4f);
      }
    }
  }
}

double meanReflectance(const HeightField& field, double latitude, double longitude) {
  constexpr double kDegree = 0.017453292519943295;
  const glm::dvec3 n(std::cos(latitude * kDegree) * std::cos(longitude * kDegree),
                     std::cos(latitude * kDegree) * std::sin(longitude * kDegree), std::sin(latitude * kDegree));
  std::mt19937_64 random(23);
  Directions points;
  for (int i = 0; i < 400; ++i) points.add(glm::normalize(n + 0.04 * randomDirection(random)));
  const SurfaceSamples s = evaluate(field, points, 2000);
  double sum = 0;
  for (const float r : s.reflectance) sum += static_cast<double>(r);
  return sum / 400;
}

TEST(LunarField, SeasAreDarkAndHighlandsBrightWhereTheMoonHasThem) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  for (const glm::dvec2 sea : {glm::dvec2(28, 18), glm::dvec2(34, -17), glm::dvec2(17, 59), glm::dvec2(8, 31)}) {
    EXPECT_LT(meanReflectance(*field, sea.x, sea.y), 0.085) << sea.x << ' ' << sea.y;
  }
  for (const glm::dvec2 land : {glm::dvec2(-45, 15), glm::dvec2(10, 170), glm::dvec2(60, 140)}) {
    EXPECT_GT(meanReflectance(*field, land.x, land.y), 0.115) << land.x << ' ' << land.y;
  }
}

TEST(LunarField, SettingsAndSeedChangeTheIdentityAndTheGround) {
  const auto plain = makeHeightField(testMoon(), bestSimdPath());
  Directions points;
  std::mt19937_64 random(29);
  for (int i = 0; i < 300; ++i) points.add(randomDirection(random));
  const SurfaceSamples before = evaluate(*plain, points, 100);
  std::vector<Body> bodies{testMoon(1970)};
  for (const ParameterSpec& spec : fieldRow(FieldKind::Lunar).parameters) {
    bodies.push_back(testMoon());
    bodies.back().fieldParameters.insert_or_assign(std::string(spec.name),
                                                   spec.defaultValue == spec.maximum ? spec.minimum : spec.maximum);
  }
  for (const Body& body : bodies) {
    const auto other = makeHeightField(body, bestSimdPath());
    EXPECT_NE(other->identity(), plain->identity());
    const SurfaceSamples after = evaluate(*other, points, 0);
    for (const double h : after.heightMeters) EXPECT_TRUE(std::isfinite(h));
  }
  const SurfaceSamples reseeded = evaluate(*makeHeightField(bodies.front(), bestSimdPath()), points, 100);
  int changed = 0;
  for (std::size_t i = 0; i < points.x.size(); ++i)
    changed += std::fabs(before.heightMeters[i] - reseeded.heightMeters[i]) > 1;
  EXPECT_GT(changed, 250);
}

TEST(LunarField, WorksForBodiesFromAsteroidToSun) {
  std::mt19937_64 random(31);
  Directions points;
  for (int i = 0; i < 500; ++i) points.add(randomDirection(random));
  for (const double radius : {250.0, 5e4, 6.371e6, 7e8}) {
    Body body = testMoon();
    body.radiusMeters = radius;
    const auto field = makeHeightField(body, bestSimdPath());
    const HeightRange range = field->heightRange();
    EXPECT_LT(range.maxMeters - range.minMeters, radius);
    const SurfaceSamples s = evaluate(*field, points, radius * 1e-3);
    for (const double h : s.heightMeters) {
      ASSERT_TRUE(h >= range.minMeters && h <= range.maxMeters) << radius;
    }
  }
}

TEST(LunarField, AnEmptyBatchGivesEmptyResults) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  SurfaceSamples samples = evaluate(*field, tileGrid(0, 3, 1, 1), 100);
  field->evaluate(SampleBatch{}, 100, samples);
  EXPECT_TRUE(samples.heightMeters.empty());
}

}  // namespace
}  // namespace terrane
