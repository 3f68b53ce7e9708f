#include "client/render/body_picture.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace terrane {
namespace {

constexpr double kReachMargin = 1 + 0x1p-8;

double power(const BodyPicture& picture) {
  const double distance = glm::length(picture.camera.positionBody);
  return (distance - picture.highestRadiusMeters) * (distance + picture.highestRadiusMeters);
}

}  // namespace

std::vector<BodyPicture> nearestFirst(std::span<const BodyPicture> bodies) {
  std::vector<BodyPicture> ordered(bodies.begin(), bodies.end());
  std::ranges::stable_sort(ordered, {}, power);
  return ordered;
}

std::vector<DrawnTile> asTheyAre(std::span<const FacePath> paths) {
  std::vector<DrawnTile> tiles;
  tiles.reserve(paths.size());
  for (const FacePath& path : paths) tiles.push_back({path, {}});
  return tiles;
}

std::vector<DrawnTile> asTheirParents(std::span<const DrawnTile> tiles) {
  std::vector<DrawnTile> parents;
  parents.reserve(tiles.size());
  for (const DrawnTile& tile : tiles) {
    TileMorph whole;
    if (tile.morph.own > 0) {
      whole.own = 1;
      whole.sides.fill(1);
    }
    parents.push_back({tile.path, whole});
  }
  return parents;
}

PassBody passBodyOf(const BodyPicture& picture, bool alone) {
  PassBody body{picture.body, picture.radiusMeters, picture.scheme};
  if (!alone) body.reachMeters = picture.highestRadiusMeters * kReachMargin;
  return body;
}

}  // namespace terrane
