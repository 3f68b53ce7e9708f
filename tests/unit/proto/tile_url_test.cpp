#include "proto/tile_url.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace terrane::test {
namespace {

const std::string kRevision = "0123456789abcdef";

std::string refusedField(std::string_view target) {
  const auto route = parseTarget(target);
  return route ? "accepted" : route.error().field;
}
ErrorKind refusal(std::string_view target) {
  const auto route = parseTarget(target);
  return route ? ErrorKind::Internal : route.error().kind;
}
std::string tile(std::string_view tail) { return "/v1/" + kRevision + "/moon/" + std::string(tail); }

TEST(TileUrl, EveryTileAddressReadsBackAsItself) {
  constexpr unsigned kSeed = 20261122;
  std::mt19937_64 random(kSeed);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  for (int i = 0; i < 20000; ++i) {
    TileAddress address;
    for (std::uint64_t n = 8 + below(57); n > 0; --n) address.revision += "0123456789abcdef"[below(16)];
    for (std::uint64_t n = 1 + below(32); n > 0; --n)
      address.body += "abcdefghijklmnopqrstuvwxyz0123456789-"[below(37)];
    const Scheme scheme = below(2) == 0 ? Scheme::Cube : Scheme::Ico;
    address.path = FacePath::wholeFace(scheme, static_cast<int>(below(static_cast<std::uint64_t>(faceCount(scheme)))));
    for (std::uint64_t n = below(FacePath::kMaxLevel + 1); n > 0; --n)
      address.path = address.path.child(static_cast<int>(below(4)));

    const std::string target = tileTarget(address);
    const auto route = parseTarget(target);
    ASSERT_TRUE(route.has_value()) << "seed " << kSeed << ": " << target << ": " << route.error().text();
    const auto* back = std::get_if<TileAddress>(&*route);
    ASSERT_NE(back, nullptr) << target;
    EXPECT_EQ(back->revision, address.revision);
    EXPECT_EQ(back->body, address.body);
    EXPECT_EQ(back->path, address.path);
  }
}

TEST(TileUrl, FixedRoutesAreFound) {
  EXPECT_TRUE(std::holds_alternative<RootPage>(*parseTarget("/")));
  EXPECT_TRUE(std::holds_alternative<HealthCheck>(*parseTarget("/healthz")));
  EXPECT_TRUE(std::holds_alternative<ReadyCheck>(*parseTarget("/readyz")));
  EXPECT_TRUE(std::holds_alternative<Metrics>(*parseTarget("/metrics")));
  EXPECT_TRUE(std::holds_alternative<SceneDocument>(*parseTarget(kSceneTarget)));
}

TEST(TileUrl, DoubledSlashesReadAsOne) {
  EXPECT_TRUE(std::holds_alternative<RootPage>(*parseTarget("//")));
  EXPECT_TRUE(std::holds_alternative<SceneDocument>(*parseTarget("//v1///scene.json")));
  const auto route = parseTarget("//v1//" + kRevision + "//moon/cube//2///0312.glb");
  ASSERT_TRUE(route.has_value()) << route.error().text();
  EXPECT_EQ(std::get<TileAddress>(*route).path.text(), "cube/2/0312");
}

TEST(TileUrl, QueryAndAbsoluteFormNameTheSameRoute) {
  EXPECT_TRUE(std::holds_alternative<SceneDocument>(*parseTarget("/v1/scene.json?session=1/2//3%20")));
  EXPECT_TRUE(std::holds_alternative<SceneDocument>(*parseTarget("http://host.example:8080/v1/scene.json")));
  EXPECT_TRUE(std::holds_alternative<RootPage>(*parseTarget("http://host.example")));
  EXPECT_TRUE(std::holds_alternative<RootPage>(*parseTarget("https://host.example?x")));
}

TEST(TileUrl, EscapesOfUnreservedCharactersAreThoseCharacters) {
  const auto route = parseTarget("/%761/" + kRevision + "/m%6Fon/cub%65/%32/0%33.gl%62");
  ASSERT_TRUE(route.has_value()) << route.error().text();
  EXPECT_EQ(std::get<TileAddress>(*route).path.text(), "cube/2/03");
}

TEST(TileUrl, RefusalsNameThePartThatWasWrong) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {tile("cube/6.glb"), "face"},
      {tile("cube/06.glb"), "face"},
      {tile("cube/+1.glb"), "face"},
      {tile("cube/-1.glb"), "face"},
      {tile("cube/.glb"), "face"},
      {tile("cube/2x/0.glb"), "face"},
      {tile("ico/20.glb"), "face"},
      {tile("cube/00/1.glb"), "face"},
      {tile("cube/0x1/1.glb"), "face"},
      {tile("cube/4294967296.glb"), "face"},
      {tile("cube/2/4.glb"), "digits"},
      {tile("cube/2/01a.glb"), "digits"},
      {tile("cube/2/.glb"), "digits"},
      {tile("cube/2/+.glb"), "digits"},
      {tile("cube/2/" + std::string(31, '0') + ".glb"), "digits"},
      {tile("cube/2/0.1.glb"), "digits"},
      {tile("sphere/2/0.glb"), "scheme"},
      {tile("Cube/2/0.glb"), "scheme"},
      {"/v1/" + kRevision + "/Moon/cube/2.glb", "body"},
      {"/v1/" + kRevision + "/" + std::string(33, 'a') + "/cube/2.glb", "body"},
      {"/v1/" + kRevision + "/mo_on/cube/2.glb", "body"},
      {"/v1/0123456/moon/cube/2.glb", "revision"},
      {"/v1/0123456G/moon/cube/2.glb", "revision"},
      {"/v1/0123456789ABCDEF/moon/cube/2.glb", "revision"},
      {"/v1/" + std::string(65, 'a') + "/moon/cube/2.glb", "revision"},
  };
  for (const auto& [target, field] : cases) {
    EXPECT_EQ(refusedField(target), field) << target;
    EXPECT_EQ(refusal(target), ErrorKind::InvalidArgument) << target;
  }
}

TEST(TileUrl, HostileTargetsAreRefusedAsTargets) {
  std::vector<std::string> targets{"",
                                   "*",
                                   "v1/scene.json",
                                   "/../etc/passwd",
                                   "/v1/../scene.json",
                                   "/v1/./scene.json",
                                   "/%2e%2e/%2e%2e/etc/passwd",
                                   "/%00",
                                   "/v1/scene.json%00",
                                   "/v1/scene.json%0d%0aX:1",
                                   "/%",
                                   "/%2",
                                   "/%zz",
                                   "/%2fv1/scene.json",
                                   "/v1/scene.json#top",
                                   "/v1\\scene.json",
                                   "/v1/%7Fscene.json",
                                   "/ v1/scene.json",
                                   "/v1/scene.json?a b",
                                   tile("cube/ 1.glb"),
                                   tile("cube/%201.glb"),
                                   tile("cube/2/0\t1.glb"),
                                   tile("cube/2/..glb/..")};
  for (int c = 0; c < 256; ++c) {
    if (c > ' ' && c <= '~') continue;
    targets.push_back("/v1/scene.json" + std::string(1, static_cast<char>(c)));
    targets.push_back("/?" + std::string(1, static_cast<char>(c)));
  }
  for (const std::string& target : targets) {
    EXPECT_EQ(refusal(target), ErrorKind::InvalidArgument) << target;
    EXPECT_EQ(refusedField(target), "target") << target;
  }
}

TEST(TileUrl, OverlongTargetsAreTooLarge) {
  const std::string target = "/" + std::string(10 * 1024, 'a');
  EXPECT_EQ(refusal(target), ErrorKind::TooLarge);
  EXPECT_EQ(refusedField(target), "target");
  EXPECT_EQ(refusal("/?" + std::string(kMaxTargetBytes - 1, 'a')), ErrorKind::TooLarge);
  EXPECT_TRUE(parseTarget("/?" + std::string(kMaxTargetBytes - 2, 'a')).has_value());
}

TEST(TileUrl, OtherPathsAreNotFound) {
  for (const std::string target : {"/v1", "/v1/", "/v2/scene.json", "/healthz/", "/v1/scene.json/", "/v1/scene",
                                   "/a/b/c/d/e/f/g/h", "/v1/x.glb"}) {
    EXPECT_EQ(refusal(target), ErrorKind::NotFound) << target;
  }
  EXPECT_EQ(refusal(tile("cube/2/0312.png")), ErrorKind::NotFound);
  EXPECT_EQ(refusal(tile("cube/2/03/12.glb")), ErrorKind::NotFound);
  EXPECT_EQ(refusal(tile("cube/2/0312.glb/")), ErrorKind::NotFound);
}

}  // namespace
}  // namespace terrane::test
