#include "client/render/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "client/render/tile_renderer.h"

namespace terrane {
namespace {

/// Does a ray from the camera meet a sphere around the body's centre? With the camera's height over that sphere as its
/// own quantity: |c|^2 - r^2 = h (2 r + h) keeps its digits a millimetre above it.
class SphereTest {
 public:
  SphereTest(const Camera& camera, double radiusMeters) : camera_(camera.positionBody) {
    // The reference radius is what position and altitude imply; its rounding (2^-52 of it) is far below a pixel.
    const double referenceRadius = glm::length(camera_) - camera.altitudeMeters;
    const double heightMeters = camera.altitudeMeters + (referenceRadius - radiusMeters);
    inside_ = heightMeters <= 0;
    tangentSquared_ = heightMeters * (2 * radiusMeters + heightMeters);
  }

  bool meets(const glm::dvec3& direction) const {
    if (inside_) return true;
    const double towards = -glm::dot(camera_, direction);
    return towards > 0 && towards * towards >= tangentSquared_ * glm::dot(direction, direction);
  }

 private:
  glm::dvec3 camera_;
  double tangentSquared_ = 0;  ///< squared distance to the sphere's horizon
  bool inside_ = false;
};

}  // namespace

CoverageCount countCoveragePixels(std::span<const LowestSphere> spheres, std::span<const std::uint8_t> pixels) {
  std::vector<SphereTest> tests;
  for (const LowestSphere& sphere : spheres) tests.emplace_back(sphere.camera, sphere.radiusMeters);
  const Camera& camera = spheres.front().camera;
  const double halfHeight = std::tan(0.5 * camera.verticalFieldOfView);
  const double perPixel = 2 * halfHeight / camera.heightPixels;
  CoverageCount count;
  std::size_t index = 0;
  for (int row = 0; row < camera.heightPixels; ++row) {
    const double y = (row + 0.5 - 0.5 * camera.heightPixels) * perPixel;
    const glm::dvec3 rowDirection = camera.up * y - camera.backward;
    for (int column = 0; column < camera.widthPixels; ++column, ++index) {
      if (pixels[index] == kCoverageSurface) continue;
      if (pixels[index] != kCoverageNone) {
        ++count.skirt;
        continue;
      }
      const double x = (column + 0.5 - 0.5 * camera.widthPixels) * perPixel;
      const glm::dvec3 direction = rowDirection + camera.right * x;
      if (std::ranges::any_of(tests, [&](const SphereTest& test) { return test.meets(direction); })) ++count.uncovered;
    }
  }
  return count;
}

CoverageCount countCoveragePixels(const Camera& camera, std::span<const std::uint8_t> pixels,
                                  double lowestRadiusMeters) {
  return countCoveragePixels(std::array{LowestSphere{camera, lowestRadiusMeters}}, pixels);
}

}  // namespace terrane
