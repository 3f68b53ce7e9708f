// Gradient noise far from the origin: what the type of the position costs and what it loses, by wavelength.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/noise_kernels.h"
#include "tests/accuracy/side_by_side.h"

namespace terrane::accuracy {
namespace {

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

/// Compared with the cell in integers and float64 within, which is as good as exact beside these.
constexpr std::array<Scheme, 3> kSchemes{{{"float32", positionValue<float>, positionWork<float>},
                                          {"float64", positionValue<double>, positionWork<double>},
                                          {"cell, float32", cellValue<float>, cellWork<float>}}};

struct Place {
  const char* name;
  double meters;
};
constexpr std::array<Place, 3> kPlaces{
    {{"1 km", 1e3}, {"Moon's radius", kMoonRadiusMeters}, {"1 AU", kAstronomicalUnitMeters}}};

Report run(const Settings& settings, Progress& progress) {
  const std::vector<Point> timed = pointsAt(kMoonRadiusMeters, settings.seed);
  std::vector<Work> ways;
  for (const Scheme& scheme : kSchemes) ways.push_back(scheme.work(timed, kUnitBits));
  const std::vector<double> times =
      nanosecondsPerItem(ways, settings.quick ? 20'000 : 200'000, settings.quick ? 7 : 25);

  Report report;
  report.columns = {{"place", "position, and how far out"},
                    {"scheme", "scheme"},
                    {"wavelengthMeters", "wavelength, m"},
                    {"errorShare", "worst error, share of the amplitude"},
                    {"timeNsPerSample", "time, ns a sample"}};
  double doubleAtAu = 0, cellAnywhere = 0, floatAtMoon = 0;
  for (std::size_t p = 0; p < kPlaces.size(); ++p) {
    const std::vector<Point> points = pointsAt(kPlaces[p].meters, settings.seed + p);
    for (std::size_t s = 0; s < kSchemes.size(); ++s) {
      for (int cellBits = 10; cellBits <= 30; cellBits += 4) {
        double worst = 0;
        for (const Point& point : points)
          worst = std::max(worst, std::fabs(kSchemes[s].value(point, cellBits) - noiseOfCell<double>(point, cellBits)));
        report.rows.push_back({fmt::format("{}, {}", kSchemes[s].name, kPlaces[p].name), std::string(kSchemes[s].name),
                               std::ldexp(1.0, cellBits - kUnitBits), worst, times[s]});
        if (s == 2) cellAnywhere = std::max(cellAnywhere, worst);
        if (cellBits != 10) continue;
        if (p == 1 && s == 0) floatAtMoon = worst;
        if (p == 2 && s == 1) doubleAtAu = worst;
      }
    }
    progress.at(static_cast<double>(p + 1) / kPlaces.size());
  }
  report.plots = {{"Error by wavelength", "wavelengthMeters", "errorShare", "place"}};
  report.findings = {fmt::format(
      "At a wavelength of 1 mm on the Moon noise of a float32 position is another noise (error {:.2g} of the "
      "amplitude). At 1 AU that of a float64 position errs by {:.2g}; with the cell in integers and a float32 within "
      "it the error is at most {:.1g} at any of these places and wavelengths.",
      floatAtMoon, doubleAtAu, cellAnywhere)};
  return report;
}

const Registration kRegistered({70, "noise", "Noise far from the origin",
                                "In which type must a position reach gradient noise, down to a wavelength of 1 mm?",
                                run});

}  // namespace
}  // namespace terrane::accuracy
