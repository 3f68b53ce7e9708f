#include "server/build/tile_revision.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace terrane {
namespace {

constexpr std::array<std::uint8_t, 3> kProbe{1, 2, 3}, kOtherProbe{1, 2, 4};

Body moon() {
  Body body;
  body.name = "moon";
  body.radiusMeters = 1'737'400.0;
  return body;
}

TEST(TileRevision, ChangesWithAllThatShapesABodysBytes) {
  std::set<std::string> revisions{tileRevision(moon(), "field 1", {}, kProbe)};
  Body larger = moon();
  larger.radiusMeters = std::nextafter(larger.radiusMeters, 1e9);
  WireSettings cells, speed, normals;
  cells.cellsPerEdge = 32;
  speed.draco.speed = 5;
  normals.draco.normalBits = 10;
  revisions.insert(tileRevision(moon(), "field 2", {}, kProbe));
  revisions.insert(tileRevision(moon(), "field 1", {}, kOtherProbe));
  revisions.insert(tileRevision(larger, "field 1", {}, kProbe));
  for (const WireSettings& wire : {cells, speed, normals})
    revisions.insert(tileRevision(moon(), "field 1", wire, kProbe));
  EXPECT_EQ(revisions.size(), 7u);
  for (const std::string& revision : revisions) {
    EXPECT_EQ(revision.size(), 16u);
    EXPECT_EQ(revision.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

TEST(TileRevision, IgnoresWhatShapesNoByte) {
  Body renamed = moon();
  renamed.name = "luna";
  EXPECT_EQ(tileRevision(renamed, "field 1", {}, kProbe), tileRevision(moon(), "field 1", {}, kProbe));
}

}  // namespace
}  // namespace terrane
