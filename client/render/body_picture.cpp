#include "client/render/body_picture.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace terrane {
namespace {

constexpr double kReachMargin = 1 + 0x1p-8;

constexpr int kPixelsAround = 2;

struct Span {
  int first = 0, count = 0;
};

/// Along one axis of the picture: from where the planes touch the sphere that hold the camera and the other axis.
Span spanOf(double aside, double ahead, double radius, double pixelsPerSlope, int pixels) {
  const double spread = radius * std::sqrt(aside * aside + (ahead - radius) * (ahead + radius));
  const double scale = pixelsPerSlope / ((ahead - radius) * (ahead + radius));
  const auto pixel = [&](double slope) {
    return static_cast<int>(std::clamp(std::floor(slope * scale + 0.5 * pixels), -1.0 * kPixelsAround, 1.0 * pixels));
  };
  const int first = std::max(pixel(aside * ahead - spread) - kPixelsAround, 0);
  const int last = std::min(pixel(aside * ahead + spread) + kPixelsAround, pixels - 1);
  return {first, std::max(last - first + 1, 0)};
}

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

PixelRectangle spherePixels(const Camera& camera, double radiusMeters) noexcept {
  const glm::dvec3 centre = viewRotation(camera) * -camera.positionBody;
  const double ahead = -centre.z;
  if (!(ahead > radiusMeters)) return {0, 0, camera.widthPixels, camera.heightPixels};
  const Span across = spanOf(centre.x, ahead, radiusMeters, pixelsPerRadian(camera), camera.widthPixels);
  const Span up = spanOf(centre.y, ahead, radiusMeters, pixelsPerRadian(camera), camera.heightPixels);
  return {across.first, up.first, across.count, up.count};
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
