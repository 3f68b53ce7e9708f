#pragma once
// The polynomials behind tanQuarterPi and atanQuarterPi (cube_sphere.h), apart so that the test that measures them
// against multiprecision uses the same numbers. Each is the minimax polynomial of the relative error, found by the
// Remez exchange in 60-digit arithmetic and rounded to double coefficient by coefficient. Leading coefficients are sums
// high + low of two doubles, so that only the last two operations of an evaluation round noticeably.

#include <array>

namespace terrane::quarter_pi {

/// tan(x pi/4) = x (pi/4 + x^2 P(x^2)) for |x| <= 1/2.
inline constexpr double kTangentRange = 0.5;
inline constexpr double kTangentHigh = 0x1.921fb54442d18p-1;
inline constexpr double kTangentLow = 0x1.1a62633145c07p-55;
inline constexpr std::array<double, 9> kTangent{0x1.4abbce625be70p-3,  0x1.466bc67756099p-5,  0x1.45fff9b88ce01p-7,
                                                0x1.45f471355400cp-9,  0x1.45f39563a23bdp-11, 0x1.45e46d3c2ab43p-13,
                                                0x1.473a999447c32p-15, 0x1.34e0cce1eeb53p-17, 0x1.c0127059f97d9p-19};

/// (4/pi) atan(z) = z (4/pi + z^2 Q(z^2)) for |z| <= tan(pi/8) = sqrt(2) - 1.
inline constexpr double kArcTangentRange = 0x1.a827999fcef32p-2;
inline constexpr double kArcTangentHigh = 0x1.45f306dc9c883p+0;
inline constexpr double kArcTangentLow = -0x1.6b01ec5417056p-54;
inline constexpr std::array<double, 11> kArcTangent{-0x1.b2995e7b7b5e4p-2, 0x1.04c26be3adcebp-2,  -0x1.7483758bfc6afp-3,
                                                    0x1.21bb93c267c15p-3,  -0x1.da1b860b01e0ap-4, 0x1.9127cc9521115p-4,
                                                    -0x1.5b7e43f89f58ep-4, 0x1.30fa15c77b4d5p-4,  -0x1.06cd9d010180cp-4,
                                                    0x1.8d0075f642198p-5,  -0x1.7582d418f0bbep-6};

/// Relative error of either in exact arithmetic (quarter_pi_test).
inline constexpr double kPolynomialError = 0x1p-57;

}  // namespace terrane::quarter_pi
