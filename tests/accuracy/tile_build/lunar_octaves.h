#pragma once
// Octaves as tall as those of the server's Moon, and its kernel reduced to them: everything else of a Program is laid
// so far from the ground that it adds exactly 0.

#include <cmath>
#include <random>
#include <vector>

#include "server/fields/height_field.h"
#include "server/fields/lunar_program.h"

namespace terrane::accuracy {

/// Amplitudes fall faster below this wavelength, 2^13 m.
inline constexpr int kFinestReliefExponent = 13;

/// Wavelengths from 2^coarsest to 2^finest metres, the coarsest first.
inline std::vector<lunar::NoiseOctave> lunarOctaves(int coarsest, int finest, std::uint64_t seed) {
  // Products, not powers: libm's last bit depends on the CPU.
  const auto amplitude = [](int exponent) {
    double meters = 190;
    for (int k = kFinestReliefExponent; k < exponent; ++k) meters *= 1.44;
    for (int k = kFinestReliefExponent; k > exponent; --k) meters *= 0.52;
    return meters;
  };
  std::mt19937_64 random(seed);
  std::vector<lunar::NoiseOctave> octaves;
  for (int exponent = coarsest; exponent >= finest; --exponent) {
    lunar::NoiseOctave octave{};
    octave.inverseWavelength = std::ldexp(1.0, -exponent);
    for (double& offset : octave.offset) offset = std::ldexp(static_cast<double>(random() >> 11), -53) * 1000 - 0.5;
    octave.amplitude = amplitude(exponent);
    octave.seed = static_cast<std::uint32_t>(random());
    octaves.push_back(octave);
  }
  return octaves;
}

/// Points into `groups`, which it fills, and into `octaves`. Octaves from doubleWavelength on are computed in double.
inline lunar::Program octavesOnly(const std::vector<lunar::NoiseOctave>& octaves, double doubleWavelength,
                                  double radiusMeters, std::vector<lunar::NoiseGroup>& groups) {
  const auto group = [](const lunar::NoiseOctave* first, std::size_t count) {
    return lunar::NoiseGroup{first, count, {1, 0, 0, 0, 1, 0, 0, 0, 1}, 0};
  };
  lunar::Program program{};
  program.radius = radiusMeters;
  program.doubleWavelength = doubleWavelength;
  program.relief = group(octaves.data(), 0);
  groups = {group(octaves.data(), octaves.size())};
  program.regolith = groups.data();
  program.regolithCount = 1;
  constexpr double kFarMeters = 1e9;
  program.lavaTop = program.lavaFloor = program.clampLow = -kFarMeters;
  program.clampHigh = kFarMeters;
  program.lavaBlend = program.clampBlend = 1;
  return program;
}

inline lunar::EvaluateBlock kernelOf(SimdPath path) noexcept {
  switch (path) {
    case SimdPath::V3:
      return lunar::evaluateBlockV3;
    case SimdPath::V4:
      return lunar::evaluateBlockV4;
    case SimdPath::Default:
      break;
  }
  return lunar::evaluateBlockDefault;
}

inline const char* nameOf(SimdPath path) noexcept {
  switch (path) {
    case SimdPath::V3:
      return "AVX2";
    case SimdPath::V4:
      return "AVX-512";
    case SimdPath::Default:
      break;
  }
  return "default";
}

}  // namespace terrane::accuracy
