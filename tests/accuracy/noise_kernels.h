#pragma once
// Gradient noise in any type, of positions in that type or of cells in integers; and points far from the origin whose
// cells are known exactly. Metres.

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace terrane::accuracy {

/// Positions are whole units of 2^-20 m; wavelengths are powers of two, so that the true cell and the true place in it
/// are integers.
using Units = std::int64_t;
inline constexpr int kUnitBits = 20;
inline constexpr std::size_t kPoints = 2048;

using Point = std::array<Units, 3>;

inline std::uint32_t hashOf(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
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

/// kPoints of them, within 32 m of one so far from the origin.
inline std::vector<Point> pointsAt(double meters, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Point> points;
  const auto spread = [&] { return static_cast<Units>(random() >> 38) - (1 << 25); };  // 32 m around
  const auto base = static_cast<Units>(std::ldexp(meters * 0.5773502691896258, kUnitBits));
  for (std::size_t i = 0; i < kPoints; ++i) points.push_back({base + spread(), base + spread(), base + spread()});
  return points;
}

inline constexpr double kMoonRadiusMeters = 1.7374e6, kAstronomicalUnitMeters = 1.495978707e11;

}  // namespace terrane::accuracy
