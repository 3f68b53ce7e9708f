#include "tests/accuracy/placement/sample.h"

#include <cmath>
#include <limits>
#include <random>

namespace terrane::accuracy {

double pixelsOf(double meters) { return meters / kDistanceMeters * (360 / std::tan(0.5235987755982988)); }

Sample makeSample(double metersFromOrigin, std::uint64_t seed, std::size_t vertices) {
  std::mt19937_64 random(seed);
  const auto unit = [&] { return std::ldexp(static_cast<double>(random() >> 11), -52) - 1; };
  const auto direction = [&] {
    for (;;) {
      const std::array<double, 3> d{unit(), unit(), unit()};
      const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      if (square > 1 || square < 0.01) continue;
      const double norm = std::sqrt(square);
      return std::array<double, 3>{d[0] / norm, d[1] / norm, d[2] / norm};
    }
  };
  Sample sample;
  const auto away = direction();
  for (std::size_t a = 0; a < 3; ++a) {
    sample.camera.units[a] =
        static_cast<Units>(std::llround(away[a] * metersFromOrigin / kUnitMeters)) + static_cast<Units>(random() % 997);
    sample.camera.restUnits[static_cast<int>(a)] = std::ldexp(static_cast<double>(random() >> 34), -30);
  }
  for (std::size_t i = 0; i < vertices; ++i) {
    const auto d = direction();
    UnitPoint vertex{};
    for (std::size_t a = 0; a < 3; ++a) {
      const Units at = sample.camera.units[a] + static_cast<Units>(std::llround(d[a] * kDistanceMeters / kUnitMeters));
      vertex[a] = (at >> 10) * kLatticeUnits;
    }
    sample.vertices.push_back(vertex);
  }
  return sample;
}

namespace {

/// By so much, on every axis; vertices stay on their lattice.
void moveTo(Sample& sample, const UnitPoint& place) {
  for (std::size_t a = 0; a < 3; ++a) {
    const Units by = (place[a] - sample.camera.units[a]) / kLatticeUnits * kLatticeUnits;
    sample.camera.units[a] += by;
    for (UnitPoint& vertex : sample.vertices) vertex[a] += by;
  }
}

/// The nearest place where (units - first) is a multiple of period.
Units nearestBorder(Units units, Units first, Units period) {
  const Units ratio = (units - first) / period;
  return first + ratio * period;
}

}  // namespace

void moveBetweenFloats(Sample& sample) {
  UnitPoint border = sample.camera.units;
  for (Units& coordinate : border) {
    const auto here = static_cast<float>(coordinate);
    const auto next = std::nextafter(here, std::numeric_limits<float>::infinity());
    if (std::fabs(here) < 0x1p25f) continue;  // floats are as fine as units
    coordinate = static_cast<Units>(here) + (static_cast<Units>(next) - static_cast<Units>(here)) / 2;
  }
  moveTo(sample, border);
}

Sample makeSampleOf(double metersFromOrigin, std::uint64_t seed, int camera, std::size_t vertices) {
  Sample sample = makeSample(metersFromOrigin, seed * 1009 + static_cast<std::uint64_t>(camera), vertices);
  constexpr Units kSplit = Units{1} << 36, kTile = Units{1} << 31;
  if (metersFromOrigin < 65536) return sample;  // nearer than the first border
  UnitPoint border = sample.camera.units;
  switch (camera % 12) {
    case 3:
      for (Units& coordinate : border) coordinate = nearestBorder(coordinate, 0, kSplit);
      break;
    case 7:
      for (Units& coordinate : border) coordinate = nearestBorder(coordinate, kTile / 2, kTile);
      break;
    case 11:
      moveBetweenFloats(sample);
      return sample;
    default:
      return sample;
  }
  moveTo(sample, border);
  return sample;
}

glm::vec3 floatsOf(const FinePoint& point) { return pairsOf(point).hi; }

glm::dvec3 doublesOf(const FinePoint& point) {
  const UnitPoint& units = point.units;
  const glm::dvec3 whole(static_cast<double>(units[0]), static_cast<double>(units[1]), static_cast<double>(units[2]));
  return (whole + point.restUnits) * kUnitMeters;
}

DoubleFloat3 pairsOf(const FinePoint& point) {
  DoubleFloat3 pairs;
  for (int axis = 0; axis < 3; ++axis) {  // from integers: a double may hold less than they do
    const Units units = point.units[static_cast<std::size_t>(axis)];
    const auto high = static_cast<float>(units);
    const double rest = static_cast<double>(units - static_cast<Units>(high)) + point.restUnits[axis];
    const DoubleFloat pair = twoSum(high, static_cast<float>(rest));
    pairs.hi[axis] = pair.hi * static_cast<float>(kUnitMeters);
    pairs.lo[axis] = pair.lo * static_cast<float>(kUnitMeters);
  }
  return pairs;
}

DoubleFloat3 splitOf(const FinePoint& point) {
  DoubleFloat3 split;
  constexpr int kSplitBits = 36;  // 65536 m of units
  for (int axis = 0; axis < 3; ++axis) {
    const Units units = point.units[static_cast<std::size_t>(axis)];
    const Units high = units / (Units{1} << kSplitBits);  // towards 0
    const double rest = static_cast<double>(units - high * (Units{1} << kSplitBits)) + point.restUnits[axis];
    split.hi[axis] = static_cast<float>(high) * 65536.0f;
    split.lo[axis] = static_cast<float>(rest * kUnitMeters);
  }
  return split;
}

glm::dvec3 trueRelative(const UnitPoint& vertex, const FinePoint& camera) {
  glm::dvec3 relative(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    relative[axis] = (static_cast<double>(vertex[a] - camera.units[a]) - camera.restUnits[axis]) * kUnitMeters;
  }
  return relative;
}

double errorMeters(const glm::vec3& placed, const UnitPoint& vertex, const FinePoint& camera) {
  const glm::dvec3 error = glm::dvec3(placed) - trueRelative(vertex, camera);
  return std::sqrt(error.x * error.x + error.y * error.y + error.z * error.z);
}

}  // namespace terrane::accuracy
