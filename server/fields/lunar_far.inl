// The far field's polynomials over one block of samples: part of every build of the lunar kernels.

#include "server/fields/lunar_features.inl"

namespace {

/// Horner's rule in a, from the power kPower on. Spelt out by recursion: a loop in the samples' loop would keep the
/// compiler from vectors.
template <class Real, int kDegree, int kPower = 0>
TERRANE_INLINE Real rowAt(const Real* c, Real a) {
  if constexpr (kPower == kDegree) {
    return c[kPower];
  } else {
    return rowAt<Real, kDegree, kPower + 1>(c, a) * a + c[kPower];
  }
}

/// The same in b, from row to row.
template <class Real, int kDegree>
TERRANE_INLINE Real polynomialAt(const Real* c, Real a, Real b) {
  if constexpr (kDegree == 0) {
    return c[0];
  } else {
    return polynomialAt<Real, kDegree - 1>(c + kDegree + 1, a, b) * b + rowAt<Real, kDegree>(c, a);
  }
}

template <class Real, int kDegree>
void expand(const FarPolynomial<Real, kDegree>& polynomial, const Real* a, const Real* b, std::size_t count,
            Real* out) {
  const Real* c = polynomial.coefficients;
  if (polynomial.isConstant) {
    for (std::size_t i = 0; i < count; ++i) out[i] = c[0];
    return;
  }
  for (std::size_t i = 0; i < count; ++i) out[i] = polynomialAt<Real, kDegree>(c, a[i], b[i]);
}

/// A sample's coordinates on the patch, for polynomials in double and in float.
struct FarCoordinates {
  alignas(64) double a[kBlockCapacity], b[kBlockCapacity];
  alignas(64) float singleA[kBlockCapacity], singleB[kBlockCapacity];
};

/// Of ground that is not mixed, what is near alone.
template <Wanted kWanted>
void clearNear(Block& b) {
  for (std::size_t i = 0; i < b.count; ++i) {
    b.rough[i] = 0.0;
    if constexpr (kWanted == Wanted::Heights) continue;
    b.youngX[i] = b.youngY[i] = b.youngZ[i] = b.roughX[i] = b.roughY[i] = b.roughZ[i] = 0.0f;
  }
}

template <Wanted kWanted>
void startFromFar(const FarExpansion& far, Block& b) {
  FarCoordinates at;
  const double *o = far.origin, *u = far.alongA, *v = far.alongB;
  for (std::size_t i = 0; i < b.count; ++i) {
    const double x = b.x[i] - o[0], y = b.y[i] - o[1], z = b.z[i] - o[2];
    at.a[i] = (x * u[0] + y * u[1]) + z * u[2];
    at.b[i] = (x * v[0] + y * v[1]) + z * v[2];
    at.singleA[i] = static_cast<float>(at.a[i]);
    at.singleB[i] = static_cast<float>(at.b[i]);
  }
  const auto visit = [&](const auto& polynomial, auto* out) {
    if constexpr (sizeof(*out) == sizeof(double)) {
      expand(polynomial, at.a, at.b, b.count, out);
    } else {
      expand(polynomial, at.singleA, at.singleB, b.count, out);
    }
  };
  if (far.ground != FarGround::Mixed) clearNear<kWanted>(b);
  forEachFarHeight(far, b, visit);
  if constexpr (kWanted == Wanted::All) forEachFarSlope(far, b, visit);
}

}  // namespace
