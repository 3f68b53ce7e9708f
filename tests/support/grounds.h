#pragma once
// Tests that hold for every ground on tiles of both schemes: INSTANTIATE_TEST_SUITE_P(Grounds, Suite, allGrounds(),
// nameOfGround).

#include <gtest/gtest.h>

#include <string>

#include "server/fields/midpoint_displacement.h"
#include "tests/support/moon_body.h"

namespace terrane::test {

struct Ground {
  Scheme scheme = Scheme::Cube;
  FieldKind field = FieldKind::Lunar;
  // NOLINTNEXTLINE(google-explicit-constructor): suites of the Moon alone are by scheme
  Ground(Scheme tiling, FieldKind kind = FieldKind::Lunar) : scheme(tiling), field(kind) {}
  operator Scheme() const { return scheme; }  // NOLINT(google-explicit-constructor)
};

inline auto allGrounds() {
  return testing::Values(Ground(Scheme::Cube), Ground(Scheme::Ico), Ground(Scheme::Cube, FieldKind::Midpoint),
                         Ground(Scheme::Ico, FieldKind::Midpoint));
}
inline constexpr auto nameOfGround = [](const auto& ground) {
  return std::string(schemeName(ground.param.scheme)) + "_" + std::string(fieldRow(ground.param.field).name);
};

/// Ground by midpoint displacement is as high as it may be.
inline Body bodyOf(const Ground& ground, double radiusMeters = kMoonRadiusMeters, std::uint64_t seed = 1969) {
  Body body = tiledBy(ground.scheme, testBody(ground.field, radiusMeters, seed));
  if (ground.field == FieldKind::Midpoint)
    body.fieldParameters["amplitude"] =
        mostAmplitudeMeters(radiusMeters, ground.scheme, body.fieldParameters["regularity"]);
  return body;
}

}  // namespace terrane::test
