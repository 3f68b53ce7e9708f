// Every scene that ships, as a client meets it: scene.json says which tiles there are, and whatever the scheme, tiles
// of the coarsest to the finest level are served under the names that follow and decode to what was asked for.

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <string>

#include "proto/gltf_tile.h"
#include "proto/tile_url.h"
#include "server/http/tile_service.h"
#include "server/scenes/scene_file.h"

namespace terrane {
namespace {

ServiceResponse ask(TileService& service, const std::string& target) {
  const auto answer = std::make_shared<std::promise<ServiceResponse>>();  // shared with the worker that gives it
  const auto ticket = service.handle({HttpMethod::Get, target, {}},
                                     [answer](ServiceResponse response) { answer->set_value(std::move(response)); });
  return answer->get_future().get();
}

/// At a face's corner, or in the middle of things.
FacePath tileDown(FacePath path, int level, int firstDigit) {
  while (path.level() < level) path = path.child((firstDigit + path.level()) % 4);
  return path;
}

class ServedScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Shipped, ServedScene, testing::ValuesIn(shippedScenes()), [](const auto& scene) {
  std::string name = scene.param;
  std::erase_if(name, [](char c) { return c == '-'; });
  return name;
});

TEST_P(ServedScene, GivesTheTilesThatSceneJsonPromises) {
  const Result<Scene> scene = loadScene(GetParam());
  ASSERT_TRUE(scene) << scene.error().text();
  TileService::Options options;
  options.threads = 1;
  TileService service(*scene, options);
  const ServiceResponse document = ask(service, std::string(kSceneTarget));
  const Result<SceneInfo> info = readSceneJson(document.body);
  ASSERT_TRUE(info) << info.error().text();
  for (const BodyInfo& body : info->bodies) {
    ASSERT_EQ(body.schemes.size(), 1u);
    const Scheme scheme = body.schemes.front();
    EXPECT_EQ(body.selection.scheme, scheme);
    for (int face = 0; face < faceCount(scheme); ++face) {
      for (const int level : {0, 1, 9, body.selection.maxLevel}) {
        const FacePath path = tileDown(FacePath::wholeFace(scheme, face), level, face);
        const ServiceResponse response = ask(service, tileTarget({body.revision, body.name, path}));
        ASSERT_EQ(response.status, 200) << path.text() << response.body;
        const Result<Tile> tile = decodeTile(response.tile->glb);
        ASSERT_TRUE(tile) << path.text() << tile.error().text();
        EXPECT_EQ(tile->metadata.path, path);
        EXPECT_EQ(tile->metadata.cellsPerEdge, body.cellsPerEdge);
        EXPECT_EQ(tile->mesh.vertexCount(),
                  gridVertexCount(scheme, body.cellsPerEdge) + skirtVertexCount(scheme, body.cellsPerEdge));
        EXPECT_EQ(tile->metadata.stepExponent, stepExponent(body.selection.radiusMeters, level, scheme));
      }
    }
    const FacePath tooDeep = tileDown(FacePath::wholeFace(scheme, 0), body.selection.maxLevel + 1, 0);
    EXPECT_EQ(ask(service, tileTarget({body.revision, body.name, tooDeep})).status,
              tooDeep.level() > FacePath::kMaxLevel ? 400 : 404);
  }
}

}  // namespace
}  // namespace terrane
