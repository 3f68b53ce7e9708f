// What a stream still knows of tiles that it dropped, and what that must not change.

#include <gtest/gtest.h>

#include "client/tiles/tile_stream.h"
#include "proto/tile_url.h"
#include "tests/unit/client/small_world.h"

namespace terrane {
namespace {

using namespace terrane::testing;

const FacePath kTile = path("cube/2/31");

std::string target(const FacePath& tile, const std::string& revision = kRevision) {
  return tileTarget({revision, "moon", tile});
}

/// Keeps nothing but what was wanted just now.
StreamOptions forgetful(const std::string& url) {
  StreamOptions options = quickOptions(url);
  options.residentBudgetBytes = 1;
  return options;
}

TEST(EvictedTile, IsKnownButNotResident) {
  SmallWorld world;
  world.start();
  SmallViewer viewer(forgetful(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(kTile)));
  EXPECT_EQ(viewer.stream().known(kTile), viewer.stream().resident(kTile));
  ASSERT_TRUE(viewer.settle(chain(path("cube/4"))));
  EXPECT_FALSE(viewer.uploaded.contains(kTile));
  EXPECT_FALSE(viewer.stream().resident(kTile));
  ASSERT_TRUE(viewer.stream().known(kTile));
  EXPECT_FALSE(viewer.stream().known(kTile)->drawable);
  EXPECT_EQ(viewer.stream().known(kTile)->subtreeHeights.maxMeters, 100);
  EXPECT_EQ(viewer.stream().status().resident, 1u);
}

TEST(EvictedTile, IsFetchedAgainWhenItIsWantedAgain) {
  SmallWorld world;
  world.start();
  SmallViewer viewer(forgetful(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(kTile)));
  ASSERT_TRUE(viewer.settle(chain(path("cube/4"))));
  EXPECT_EQ(world.asked(target(kTile)), 1);
  ASSERT_TRUE(viewer.settle(chain(kTile)));
  EXPECT_EQ(world.asked(target(kTile)), 2);
  ASSERT_TRUE(viewer.stream().resident(kTile));
  EXPECT_TRUE(viewer.stream().known(kTile)->drawable);
}

TEST(EvictedTile, IsForgottenWhenTheServerMovesToANewRevision) {
  SmallWorld world;
  world.start();
  SmallViewer viewer(forgetful(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(kTile)));
  ASSERT_TRUE(viewer.settle(chain(path("cube/4"))));
  ASSERT_TRUE(viewer.stream().known(kTile));
  world.setRevision(kNextRevision);
  ASSERT_TRUE(viewer.settle(chain(path("cube/4/0"))));
  ASSERT_EQ(viewer.stream().scene()->bodies[0].revision, kNextRevision);
  EXPECT_FALSE(viewer.stream().known(kTile)) << "its heights may be others now";
  EXPECT_TRUE(viewer.stream().resident(path("cube/4/0")));
}

TEST(EvictedTile, IsForgottenWithItsBody) {
  SmallWorld world;
  world.start();
  SmallViewer viewer(forgetful(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(kTile)));
  ASSERT_TRUE(viewer.settle(chain(path("cube/4"))));
  ASSERT_TRUE(viewer.stream().known(kTile));
  viewer.stream().selectBody(1);
  EXPECT_FALSE(viewer.stream().known(kTile));
}

}  // namespace
}  // namespace terrane
