// Gradient noise far from the origin: what the type of the position costs and what it loses, by wavelength.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"

namespace terrane::accuracy {
namespace {

/// Positions are whole units of 2^-20 m; wavelengths are powers of two, so that the true cell and the true place in it
/// are integers.
using Units = std::int64_t;
constexpr int kUnitBits = 20;
constexpr std::size_t kPoints = 2048;

using Point = std::array<Units, 3>;

std::uint32_t hashOf(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ull +
                    static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Full +
                    static_cast<std::uint64_t>(z) * 0x165667B19E3779F9ull;
  h ^= h >> 29;
  h *= 0xBF58476D1CE4E5B9ull;
  return static_cast<std::uint32_t>(h >> 32);
}

/// Perlin 2002, "Improving noise": twelve directions, quintic fade. f: the place in the cell, 0 .. 1.
template <class Real>
Real noiseIn(const std::array<std::int64_t, 3>& cell, const std::array<Real, 3>& f) noexcept {
  constexpr std::array<std::array<Real, 3>, 12> kDirections{{{1, 1, 0},
                                                             {-1, 1, 0},
                                                             {1, -1, 0},
                                                             {-1, -1, 0},
                                                             {1, 0, 1},
                                                             {-1, 0, 1},
                                                             {1, 0, -1},
                                                             {-1, 0, -1},
                                                             {0, 1, 1},
                                                             {0, -1, 1},
                                                             {0, 1, -1},
                                                             {0, -1, -1}}};
  std::array<Real, 3> w{};
  for (std::size_t a = 0; a < 3; ++a) w[a] = f[a] * f[a] * f[a] * (f[a] * (f[a] * Real(6) - Real(15)) + Real(10));
  Real sum = 0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    Real weight = 1, height = 0;
    const std::array<std::int64_t, 3> at{cell[0] + static_cast<std::int64_t>(corner & 1),
                                         cell[1] + static_cast<std::int64_t>(corner >> 1 & 1),
                                         cell[2] + static_cast<std::int64_t>(corner >> 2)};
    const auto& direction = kDirections[hashOf(at[0], at[1], at[2]) % 12];
    for (std::size_t a = 0; a < 3; ++a) {
      const bool far = (corner >> a & 1) != 0;
      weight *= far ? w[a] : Real(1) - w[a];
      height += direction[a] * (far ? f[a] - Real(1) : f[a]);
    }
    sum += weight * height;
  }
  return sum;
}

/// The position as one number of this type: it is scaled to cells, then split.
template <class Real>
Real noiseOfPosition(const std::array<Real, 3>& meters, Real inverseWavelength) noexcept {
  std::array<std::int64_t, 3> cell{};
  std::array<Real, 3> f{};
  for (std::size_t a = 0; a < 3; ++a) {
    const Real scaled = meters[a] * inverseWavelength, whole = std::floor(scaled);
    cell[a] = static_cast<std::int64_t>(whole);
    f[a] = scaled - whole;
  }
  return noiseIn<Real>(cell, f);
}

/// The cell in integers; a float for the place in it.
template <class Real>
Real noiseOfCell(const Point& units, int cellBits) noexcept {
  std::array<std::int64_t, 3> cell{};
  std::array<Real, 3> f{};
  const Real inverse = static_cast<Real>(std::ldexp(1.0, -cellBits));
  for (std::size_t a = 0; a < 3; ++a) {
    cell[a] = units[a] >> cellBits;
    f[a] = static_cast<Real>(units[a] - (cell[a] << cellBits)) * inverse;
  }
  return noiseIn<Real>(cell, f);
}

template <class Real>
std::array<Real, 3> metersOf(const Point& p) noexcept {
  const auto unit = static_cast<Real>(0x1p-20);
  return {static_cast<Real>(p[0]) * unit, static_cast<Real>(p[1]) * unit, static_cast<Real>(p[2]) * unit};
}

std::vector<Point> pointsAt(double meters, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Point> points;
  const auto spread = [&] { return static_cast<Units>(random() >> 38) - (1 << 25); };  // 32 m around
  const auto base = static_cast<Units>(std::ldexp(meters * 0.5773502691896258, kUnitBits));
  for (std::size_t i = 0; i < kPoints; ++i) points.push_back({base + spread(), base + spread(), base + spread()});
  return points;
}

struct Scheme {
  const char* name;
  double (*value)(const Point& p, int cellBits);
  Work (*work)(const std::vector<Point>& points, int cellBits);
};

template <class Real>
double positionValue(const Point& p, int cellBits) {
  return static_cast<double>(
      noiseOfPosition<Real>(metersOf<Real>(p), static_cast<Real>(std::ldexp(1.0, kUnitBits - cellBits))));
}
template <class Real>
Work positionWork(const std::vector<Point>& points, int cellBits) {
  std::vector<std::array<Real, 3>> meters;
  for (const Point& p : points) meters.push_back(metersOf<Real>(p));
  return [meters, inverse = static_cast<Real>(std::ldexp(1.0, kUnitBits - cellBits))](std::size_t count) {
    Real sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += noiseOfPosition<Real>(meters[i % kPoints], inverse);
    return static_cast<double>(sum);
  };
}
template <class Real>
double cellValue(const Point& p, int cellBits) {
  return static_cast<double>(noiseOfCell<Real>(p, cellBits));
}
template <class Real>
Work cellWork(const std::vector<Point>& points, int cellBits) {
  return [points, cellBits](std::size_t count) {
    Real sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += noiseOfCell<Real>(points[i % kPoints], cellBits);
    return static_cast<double>(sum);
  };
}

constexpr std::array<Scheme, 4> kSchemes{{{"float32 position", positionValue<float>, positionWork<float>},
                                          {"float64 position", positionValue<double>, positionWork<double>},
                                          {"integer cell, float32 within", cellValue<float>, cellWork<float>},
                                          {"integer cell, float64 within", cellValue<double>, cellWork<double>}}};

struct Place {
  const char* name;
  double meters;
};
constexpr std::array<Place, 3> kPlaces{{{"1 km", 1e3}, {"the Moon's radius", 1.7374e6}, {"1 AU", 1.495978707e11}}};

Report run(const Settings& settings, Progress& progress) {
  const std::vector<Point> timed = pointsAt(1.7374e6, settings.seed);
  std::vector<Work> ways;
  for (const Scheme& scheme : kSchemes) ways.push_back(scheme.work(timed, kUnitBits));
  const std::vector<double> times =
      nanosecondsPerItem(ways, settings.quick ? 20'000 : 200'000, settings.quick ? 7 : 25);

  Report report;
  report.columns = {{"place", "distance from the origin"},
                    {"scheme", "scheme"},
                    {"wavelengthMeters", "wavelength, m"},
                    {"errorShare", "worst error, share of the amplitude"},
                    {"timeNsPerSample", "time, ns a sample"}};
  double doubleAtAu = 0, cellAtAu = 0, floatAtMoon = 0;
  for (std::size_t p = 0; p < kPlaces.size(); ++p) {
    const std::vector<Point> points = pointsAt(kPlaces[p].meters, settings.seed + p);
    for (std::size_t s = 0; s < kSchemes.size(); ++s) {
      for (int cellBits = 10; cellBits <= 30; cellBits += 2) {
        double worst = 0;
        for (const Point& point : points)
          worst = std::max(worst, std::fabs(kSchemes[s].value(point, cellBits) - noiseOfCell<double>(point, cellBits)));
        report.rows.push_back({fmt::format("{}, {}", kSchemes[s].name, kPlaces[p].name), std::string(kSchemes[s].name),
                               std::ldexp(1.0, cellBits - kUnitBits), worst, times[s]});
        if (cellBits != 10) continue;
        if (p == 1 && s == 0) floatAtMoon = worst;
        if (p == 2 && s == 1) doubleAtAu = worst;
        if (p == 2 && s == 2) cellAtAu = worst;
      }
    }
    progress.at(static_cast<double>(p + 1) / kPlaces.size());
  }
  report.plots = {{"Error by wavelength", "wavelengthMeters", "errorShare", "place"}};
  report.findings = {
      fmt::format("At a wavelength of 1 mm on the Moon noise of a float32 position is another noise (error {:.2g} of "
                  "the amplitude). At 1 AU that of a "
                  "float64 position errs by {:.2g}; with the cell in integers and a float32 within it the error stays "
                  "{:.1g}, anywhere.",
                  floatAtMoon, doubleAtAu, cellAtAu)};
  return report;
}

const Registration kRegistered({70, "noise", "Noise far from the origin",
                                "In which type must a position reach gradient noise, down to a wavelength of 1 mm?",
                                run});

}  // namespace
}  // namespace terrane::accuracy
