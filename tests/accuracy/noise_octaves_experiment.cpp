// Sums of octaves at 1 AU down to a wavelength of 1 mm: what the type of the position costs and loses in metres.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/noise_kernels.h"
#include "tests/accuracy/side_by_side.h"

namespace terrane::accuracy {
namespace {

constexpr std::array<int, 5> kOctaves{1, 4, 8, 16, 20};
constexpr int kFinestCellBits = 10;  // 2^-10 m
/// Of the wavelength: ground about as steep as the Moon's hills.
constexpr double kAmplitudeShare = 1.0 / 40;

/// So few that what else the machine does seldom falls into the time of one way.
constexpr std::size_t kTimedPoints = 256;

double wavelengthMeters(int octave) { return std::ldexp(1.0, kFinestCellBits - kUnitBits + octave); }

template <class Real>
Real sumOfPosition(const std::array<Real, 3>& meters, int octaves) noexcept {
  Real sum = 0, amplitude = static_cast<Real>(kAmplitudeShare * wavelengthMeters(0));
  auto inverse = static_cast<Real>(1 / wavelengthMeters(0));
  for (int k = 0; k < octaves; ++k) {
    sum += amplitude * noiseOfPosition<Real>(meters, inverse);
    amplitude *= 2;
    inverse /= 2;
  }
  return sum;
}
template <class Real>
Real sumOfCells(const Point& p, int octaves) noexcept {
  Real sum = 0, amplitude = static_cast<Real>(kAmplitudeShare * wavelengthMeters(0));
  for (int k = 0; k < octaves; ++k) {
    sum += amplitude * noiseOfCell<Real>(p, kFinestCellBits + k);
    amplitude *= 2;
  }
  return sum;
}

struct Scheme {
  const char* name;
  double (*heightMeters)(const Point& p, int octaves);
  Work (*work)(const std::vector<Point>& points, int octaves);
};

template <class Real>
double positionHeight(const Point& p, int octaves) {
  return static_cast<double>(sumOfPosition<Real>(metersOf<Real>(p), octaves));
}
template <class Real>
Work positionWork(const std::vector<Point>& points, int octaves) {
  std::vector<std::array<Real, 3>> meters;
  for (const Point& p : points) meters.push_back(metersOf<Real>(p));
  return [meters, octaves](std::size_t count) {
    Real sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += sumOfPosition<Real>(meters[i % kPoints], octaves);
    return static_cast<double>(sum);
  };
}
template <class Real>
double cellHeight(const Point& p, int octaves) {
  return static_cast<double>(sumOfCells<Real>(p, octaves));
}
template <class Real>
Work cellWork(const std::vector<Point>& points, int octaves) {
  return [points, octaves](std::size_t count) {
    Real sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += sumOfCells<Real>(points[i % kPoints], octaves);
    return static_cast<double>(sum);
  };
}

/// The last is what the others are compared with.
constexpr std::array<Scheme, 4> kSchemes{
    {{"float32 position", positionHeight<float>, positionWork<float>},
     {"float64 position", positionHeight<double>, positionWork<double>},
     {"integer cell, float32", cellHeight<float>, cellWork<float>},
     {"integer cell, float64 (the reference)", cellHeight<double>, cellWork<double>}}};
constexpr std::size_t kFloat = 0, kDouble = 1, kCell = 2, kReference = 3;

Report run(const Settings& settings, Progress& progress) {
  const std::vector<Point> points = pointsAt(kAstronomicalUnitMeters, settings.seed);
  Report report;
  report.columns = {{"scheme", "scheme"},
                    {"octaves", "octaves"},
                    {"longestMeters", "longest wavelength, m"},
                    {"errorMeters", "worst height error, m"},
                    {"errorShare", "error / sum of amplitudes"},
                    {"timeNsPerSample", "time, ns a sample"},
                    {"timeNsPerOctave", "time, ns an octave"},
                    {"timeRatio", "time / that of float32"}};
  std::array<double, kSchemes.size()> worst{}, worstOfFew{}, ns{};  // of the last row of each; of the first
  for (std::size_t n = 0; n < kOctaves.size(); ++n) {
    const int octaves = kOctaves[n];
    std::vector<Work> ways;
    for (const Scheme& scheme : kSchemes) ways.push_back(scheme.work(points, octaves));
    const std::vector<double> times = nanosecondsPerItem(ways, kTimedPoints, settings.quick ? 9 : 101);
    const double amplitudes = kAmplitudeShare * (wavelengthMeters(octaves) - wavelengthMeters(0));
    for (std::size_t s = 0; s < kSchemes.size(); ++s) {
      worst[s] = 0;
      for (const Point& p : points)
        worst[s] = std::max(
            worst[s], std::fabs(kSchemes[s].heightMeters(p, octaves) - kSchemes[kReference].heightMeters(p, octaves)));
      ns[s] = times[s];
      if (n == 0) worstOfFew[s] = worst[s];
      report.rows.push_back({std::string(kSchemes[s].name), std::int64_t{octaves}, wavelengthMeters(octaves - 1),
                             worst[s], worst[s] / amplitudes, times[s], times[s] / octaves, times[s] / times[kFloat]});
    }
    progress.at(static_cast<double>(n + 1) / kOctaves.size());
  }
  report.plots = {{"Error over octaves", "octaves", "errorMeters", "scheme", false, true},
                  {"Time over octaves", "octaves", "timeNsPerSample", "scheme", false, false}};
  report.findings = {
      fmt::format(
          "At 1 AU and a wavelength of 1 mm float32 positions give other ground. Height errors of {} octave and "
          "of {}, up to {:.3g} m long: float32 positions {:.2g} and {:.2g} m, float64 positions {:.2g} and {:.2g} "
          "m, cells in integers with float32 within {:.2g} and {:.2g} m. The first two err by the place, "
          "the last by the height of the tallest octaves: sum those in double, as Terrane does.",
          kOctaves.front(), kOctaves.back(), wavelengthMeters(kOctaves.back() - 1), worstOfFew[kFloat], worst[kFloat],
          worstOfFew[kDouble], worst[kDouble], worstOfFew[kCell], worst[kCell]),
      fmt::format("Time of a sample of {} octaves, against float32 positions: float64 positions {:.2f}, integer cells "
                  "with float32 {:.2f}, with float64 {:.2f}.",
                  kOctaves.back(), ns[kDouble] / ns[kFloat], ns[kCell] / ns[kFloat], ns[kReference] / ns[kFloat])};
  return report;
}

const Registration kRegistered({71, "noise-octaves", "Sums of octaves at 1 AU",
                                "What does each octave add in time and in error, down to a wavelength of 1 mm?", run});

}  // namespace
}  // namespace terrane::accuracy
