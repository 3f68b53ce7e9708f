#pragma once
// How a weld differs from the true one, and where; and between which bounds an epsilon would have to lie.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tests/accuracy/welding/weld_ways.h"

namespace terrane::accuracy {

/// Where a vertex lies, for a hash of spherical angles: within 5 degrees of a pole, else on the antimeridian.
enum class Where : std::uint8_t { Pole, Seam, Elsewhere };
Where whereIs(const glm::dvec3& direction);

struct ByPlace {
  std::int64_t pole = 0, seam = 0, elsewhere = 0;
  void add(Where where, std::int64_t count);
  std::int64_t all() const { return pole + seam + elsewhere; }
};

struct WeldCounts {
  std::int64_t truth = 0, found = 0;  ///< vertices; found = truth + missed - wrong
  ByPlace missed;                     ///< pieces too many that the copies of a vertex fell into
  ByPlace wrong;                      ///< vertices too many that became one
};
/// directions: of the corners.
WeldCounts compare(const Weld& weld, const Weld& truth, std::span<const glm::dvec3> directions);

/// A hash welds rightly with an epsilon of at least leastForNoMiss and below mostForNoWrong: with none if those are the
/// wrong way round.
struct EpsilonBounds {
  double leastForNoMiss = 0;
  double leastForNoMissElsewhere = 0;  ///< leaving out vertices at the poles and the antimeridian
  double mostForNoWrong = 0;

  bool possible() const { return leastForNoMiss < mostForNoWrong; }
  bool possibleElsewhere() const { return leastForNoMissElsewhere < mostForNoWrong; }
};
template <class Real>
EpsilonBounds epsilonBounds(std::span<const HashedCorner<Real>> sorted, const Weld& truth,
                            std::span<const glm::dvec3> directions);

}  // namespace terrane::accuracy
