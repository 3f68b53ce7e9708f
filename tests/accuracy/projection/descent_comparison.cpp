#include "tests/accuracy/projection/descent_comparison.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_set>

namespace terrane::accuracy {
namespace {

constexpr int kColumns = 48, kRows = 27;
constexpr double kNotDrawn = std::numeric_limits<double>::quiet_NaN();

/// Points of a picture: where the rays of a grid of pixels meet a sphere through the ground below the camera. Both
/// schemes are looked at there, whether or not the ground itself would hide the point.
struct Points {
  std::vector<double> x, y, z;         ///< unit directions from the body's centre
  std::vector<double> pixelsPerMeter;  ///< that a metre of height covers there
  std::vector<double> groundRadiusMeters;

  glm::dvec3 direction(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

void addPoint(const Camera& camera, const glm::dvec3& ray, double sphereMeters, Points& points) {
  const double along = -glm::dot(camera.positionBody, ray);
  const double nearest = glm::length(camera.positionBody + along * ray);
  if (along <= 0 || nearest >= sphereMeters) return;
  // Where the camera is close to the sphere its distance is a difference: by the product of sum and difference.
  const double distance = along - std::sqrt((sphereMeters - nearest) * (sphereMeters + nearest));
  if (distance <= 0) return;
  const glm::dvec3 direction = glm::normalize(camera.positionBody + distance * ray);
  points.x.push_back(direction.x);
  points.y.push_back(direction.y);
  points.z.push_back(direction.z);
  points.pixelsPerMeter.push_back(glm::length(glm::cross(direction, ray)) * pixelsPerRadian(camera) / distance);
}

Points pointsOf(const Camera& camera, const HeightField& moon, double radiusMeters) {
  const glm::dvec3 down = glm::normalize(camera.positionBody);
  SurfaceSamples samples;
  moon.evaluate({&down.x, &down.y, &down.z, 1, 1}, kFinestWavelengthMeters, samples);
  const double sphereMeters = radiusMeters + samples.heightMeters.front();
  Points points;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double right = ((column + 0.5) / kColumns - 0.5) * camera.widthPixels / pixelsPerRadian(camera);
      const double up = ((row + 0.5) / kRows - 0.5) * camera.heightPixels / pixelsPerRadian(camera);
      addPoint(camera, glm::normalize(right * camera.right + up * camera.up - camera.backward), sphereMeters, points);
    }
  }
  moon.evaluate({points.x.data(), points.y.data(), points.z.data(), 1, points.x.size()}, kFinestWavelengthMeters,
                samples);
  for (const double height : samples.heightMeters) points.groundRadiusMeters.push_back(radiusMeters + height);
  return points;
}

std::vector<double> errorsPixels(DescentTiles& tiles, const std::vector<FacePath>& draw, const Points& points) {
  const std::unordered_set<FacePath> drawn(draw.begin(), draw.end());
  std::vector<double> errors(points.x.size(), kNotDrawn);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const FacePath finest = tileAt(tiles.scheme(), points.direction(i), FacePath::kMaxLevel);
    for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
      const FacePath path = finest.ancestor(level);
      if (!drawn.contains(path)) continue;
      const double radius =
          meshRadiusMeters(path, tiles.tile(path), tiles.builder().info().cellsPerEdge, points.direction(i));
      errors[i] = std::fabs(radius - points.groundRadiusMeters[i]) * points.pixelsPerMeter[i];
      break;
    }
  }
  return errors;
}

}  // namespace

Outcome& Outcome::operator+=(const Outcome& other) {
  fetched += other.fetched;
  errorPixelsSum += other.errorPixelsSum;
  worstErrorPixels = std::max(worstErrorPixels, other.worstErrorPixels);
  points += other.points;
  return *this;
}

SchemeOutcomes& SchemeOutcomes::operator+=(const SchemeOutcomes& other) {
  for (std::size_t e = 0; e < byError.size(); ++e)
    for (std::size_t s = 0; s < kSchemes; ++s) byError[e][s] += other.byError[e][s];
  return *this;
}

SchemeOutcomes compareDescents(const std::vector<Camera>& cameras, const HeightField& moon,
                               const std::array<DescentTiles*, kSchemes>& sources) {
  SchemeOutcomes outcomes;
  std::array<std::array<std::unordered_set<FacePath>, kSchemes>, kErrorPixels.size()> fetched;
  const double radiusMeters = sources[0]->builder().body().radiusMeters;
  for (const Camera& camera : cameras) {
    const Points points = pointsOf(camera, moon, radiusMeters);
    for (std::size_t e = 0; e < kErrorPixels.size(); ++e) {
      std::array<std::vector<double>, kSchemes> errors;
      for (std::size_t s = 0; s < kSchemes; ++s) {
        const TileSelection selection = sources[s]->settle(camera, kErrorPixels[e]);
        for (const WantedTile& wanted : selection.wanted)
          if (fetched[e][s].insert(wanted.path).second)
            outcomes.byError[e][s].fetched += sources[s]->tile(wanted.path).amounts;
        errors[s] = errorsPixels(*sources[s], selection.draw, points);
      }
      for (std::size_t i = 0; i < points.x.size(); ++i) {
        if (std::isnan(errors[0][i]) || std::isnan(errors[1][i])) continue;
        for (std::size_t s = 0; s < kSchemes; ++s) outcomes.byError[e][s] += Outcome{{}, errors[s][i], errors[s][i], 1};
      }
    }
  }
  for (DescentTiles* source : sources) source->forget();
  return outcomes;
}

std::optional<double> bytesForError(const SchemeOutcomes& outcomes, std::size_t scheme, double meanErrorPixels) {
  const Outcome &fine = outcomes.byError[0][scheme], &coarse = outcomes.byError[1][scheme];
  const auto fineBytes = static_cast<double>(fine.fetched.bytes),
             coarseBytes = static_cast<double>(coarse.fetched.bytes);
  const double errorStep = std::log(coarse.meanErrorPixels() / fine.meanErrorPixels());
  const double asked = std::log(meanErrorPixels / fine.meanErrorPixels());
  if (coarseBytes >= fineBytes || errorStep <= 0 || std::fabs(asked) > errorStep * (1 + 1e-12)) return std::nullopt;
  return fineBytes * std::exp(std::log(coarseBytes / fineBytes) * asked / errorStep);
}

}  // namespace terrane::accuracy
