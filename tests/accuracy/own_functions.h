#pragma once
// The functions that the project computes by itself, and what the C library would give; and arguments for each. In a
// header of its own, so that the program that evaluates them on another CPU's paths evaluates the same.

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "common/tiling/cube_sphere.h"

namespace terrane::accuracy {

struct FunctionOfOne {
  const char* function;
  const char* by;
  const char* range;
  double (*value)(double x);
  double low, high;  ///< of the arguments
  int own;           ///< index of the project's own one; -1: it has none
};

/// As the C library's users write them: its tangent takes an angle, not a share of pi / 4.
inline constexpr double kQuarterPi = 0x1.921fb54442d18p-1;
inline constexpr std::array<FunctionOfOne, 9> kFunctions{{
    {"tan(x pi/4)", "own", "-1 .. 1", tanQuarterPi, -1, 1, 0},
    {"tan(x pi/4)", "libm", "-1 .. 1", [](double x) { return std::tan(x * kQuarterPi); }, -1, 1, 0},
    {"atan(x) 4/pi", "own", "-1 .. 1", atanQuarterPi, -1, 1, 2},
    {"atan(x) 4/pi", "libm", "-1 .. 1", [](double x) { return std::atan(x) / kQuarterPi; }, -1, 1, 2},
    {"sin(x)", "libm", "-4 .. 4", [](double x) { return std::sin(x); }, -4, 4, -1},
    {"cos(x)", "libm", "-4 .. 4", [](double x) { return std::cos(x); }, -4, 4, -1},
    {"exp(x)", "libm", "-8 .. 8", [](double x) { return std::exp(x); }, -8, 8, -1},
    {"log(x)", "libm", "0.01 .. 100", [](double x) { return std::log(x); }, 0.01, 100, -1},
    {"x^0.52", "libm", "0.01 .. 100", [](double x) { return std::pow(x, 0.52); }, 0.01, 100, -1},
}};

inline std::vector<double> argumentsOf(const FunctionOfOne& f, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> out;
  while (out.size() < count) {
    const double share = std::ldexp(static_cast<double>(random() >> 11), -53);
    out.push_back(f.low + (f.high - f.low) * share);
  }
  return out;
}

}  // namespace terrane::accuracy
