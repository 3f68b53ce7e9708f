#pragma once
// One body of several in a picture. Plain values; thread-safe.

#include <limits>
#include <span>
#include <vector>

#include "common/view/camera.h"
#include "common/view/drawn_tile.h"

namespace terrane {

struct BodyPicture {
  std::size_t body = 0;  ///< as its tiles were uploaded
  Camera camera;         ///< the picture's, in this body's frame (common/view/body_frames.h)
  std::span<const DrawnTile> tiles;
  double radiusMeters = 0;         ///< of the reference sphere
  double highestRadiusMeters = 0;  ///< of a sphere that holds all of its ground; no two bodies' intersect
  double lowestRadiusMeters = 0;   ///< of a sphere that is all under its ground
  Scheme scheme = Scheme::Cube;
};

/// Nearest first: no body hides one that comes before it. For spheres that do not intersect that is the order of the
/// camera's power, distance^2 - radius^2, for the plane in which two powers are equal parts the two spheres.
std::vector<BodyPicture> nearestFirst(std::span<const BodyPicture> bodies);

/// Pixels of a picture, from its lower left corner.
struct PixelRectangle {
  int left = 0, bottom = 0, width = 0, height = 0;
};
/// Holds every pixel of a sphere around the camera's body, and two more around them; the whole picture for a sphere
/// that is not all ahead of the camera.
PixelRectangle spherePixels(const Camera& camera, double radiusMeters) noexcept;

/// Tiles as they are, between no levels.
std::vector<DrawnTile> asTheyAre(std::span<const FacePath> paths);
/// The same cut with the tiles that are in between as their parents' surfaces.
std::vector<DrawnTile> asTheirParents(std::span<const DrawnTile> tiles);

/// An effect's pass is told of the body that it is drawn on.
struct PassBody {
  std::size_t body = 0;
  double radiusMeters = 0;
  Scheme scheme = Scheme::Cube;
  /// Ground that is farther than this from the centre is another body's: infinite where there is no other.
  double reachMeters = std::numeric_limits<double>::infinity();
};
/// With room for what a float's depth leaves open where a body is a pixel across (2^-22 of its distance).
PassBody passBodyOf(const BodyPicture& picture, bool alone);

}  // namespace terrane
