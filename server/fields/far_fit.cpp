#include "server/fields/far_fit.h"

#include <algorithm>
#include <array>

#include "common/numerics/strict_math.h"

namespace terrane::lunar {
namespace {

/// Chebyshev polynomials T_0 .. T_5: coefficients of powers.
constexpr double kChebyshev[kFarNodes][kFarNodes] = {{1, 0, 0, 0, 0, 0},  {0, 1, 0, 0, 0, 0},  {-1, 0, 2, 0, 0, 0},
                                                     {0, -3, 0, 4, 0, 0}, {1, 0, -8, 0, 8, 0}, {0, 5, 0, -20, 0, 16}};

double chebyshevAt(int n, double x) noexcept {
  double before = 1, now = x;
  if (n == 0) return before;
  for (int k = 1; k < n; ++k) {
    const double next = 2 * x * now - before;
    before = now;
    now = next;
  }
  return now;
}

/// What each node's value adds to each coefficient.
template <int kDegree>
using FitMatrix = std::array<std::array<double, kFarNodeCount>, static_cast<std::size_t>(farTerms(kDegree))>;

template <int kDegree>
FitMatrix<kDegree> fitMatrix() noexcept {
  FitMatrix<kDegree> matrix{};
  for (int m = 0; m <= kDegree; ++m) {
    for (int n = 0; m + n <= kDegree; ++n) {
      const double weight = (m == 0 ? 1.0 : 2.0) * (n == 0 ? 1.0 : 2.0) / kFarNodeCount;
      for (int node = 0; node < kFarNodeCount; ++node) {
        const double share = weight * (chebyshevAt(m, farNodeA(node)) * chebyshevAt(n, farNodeB(node)));
        std::size_t term = 0;
        for (int j = 0; j <= kDegree; ++j) {
          for (int i = 0; i + j <= kDegree; ++i, ++term)
            if (i <= m && j <= n)
              matrix[term][static_cast<std::size_t>(node)] += share * (kChebyshev[m][i] * kChebyshev[n][j]);
        }
      }
    }
  }
  return matrix;
}

template <class Real, int kDegree>
void fit(const Real* values, FarPolynomial<Real, kDegree>& out) noexcept {
  static const FitMatrix<kDegree> matrix = fitMatrix<kDegree>();
  out.isConstant = std::all_of(values, values + kFarNodeCount, [&](Real v) { return v == values[0]; });
  if (out.isConstant) {
    std::fill(std::begin(out.coefficients), std::end(out.coefficients), Real(0));
    out.coefficients[0] = values[0];
    return;
  }
  for (std::size_t term = 0; term < matrix.size(); ++term) {
    double sums[4] = {0, 0, 0, 0};
    for (std::size_t node = 0; node < kFarNodeCount; node += 4)
      for (std::size_t k = 0; k < 4; ++k) sums[k] += matrix[term][node + k] * static_cast<double>(values[node + k]);
    out.coefficients[term] = static_cast<Real>((sums[0] + sums[1]) + (sums[2] + sums[3]));
  }
}

}  // namespace

void fitExpansion(const FarPatch& patch, const Block& nodes, FarExpansion& out) noexcept {
  out.ground = FarGround::Mixed;
  for (int i = 0; i < 3; ++i) {
    out.origin[i] = patch.origin[i];
    out.alongA[i] = patch.axisA[i] / patch.halfA;
    out.alongB[i] = patch.axisB[i] / patch.halfB;
  }
  const auto visit = [](auto& polynomial, const auto* values) { fit(values, polynomial); };
  forEachFarHeight(out, nodes, visit);
  forEachFarSlope(out, nodes, visit);
}

}  // namespace terrane::lunar
