#include "tests/accuracy/tile_build/tile_truth.h"

#include <algorithm>
#include <cmath>

namespace terrane::accuracy {
namespace {

ReferenceVector operator*(const ReferenceVector& a, long double s) { return {a.x * s, a.y * s, a.z * s}; }
ReferenceVector operator-(const ReferenceVector& a, const ReferenceVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
long double lengthOf(const ReferenceVector& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }
ReferenceVector cross(const ReferenceVector& a, const ReferenceVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The distance of unit vectors, times what it is to be seen over.
double tilt(const std::vector<float>& normals, std::size_t vertex, const ReferenceVector& normal, double cellMeters) {
  const ReferenceVector given{normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]};
  // Three equal positions have no normal: as wrong as one can be.
  const double away = static_cast<double>(lengthOf(given - normal * (1 / lengthOf(normal))));
  return cellMeters * (std::isfinite(away) ? away : 2.0);
}

bool inner(std::size_t vertex) {
  const std::size_t i = vertex % kSide, j = vertex / kSide;
  return i > 0 && j > 0 && i + 1 < kSide && j + 1 < kSide;
}

}  // namespace

Truth::Truth(const Place& place, std::size_t stride)
    : place_(place), directions_(referenceDirections(place.path, kCells)) {
  for (std::size_t j = 0; j < kSide; j += stride) {
    for (std::size_t i = 0; i < kSide; i += stride) vertices_.push_back(j * kSide + i);
  }
  for (const std::size_t vertex : vertices_)
    heightMeters_.push_back(referenceHeightMeters(place.octaves, position(vertex, 0)));
}

ReferenceVector Truth::position(std::size_t vertex, long double heightMeters) const {
  return directions_[vertex] * (static_cast<long double>(place_.radiusMeters) + heightMeters);
}

double Truth::directionErrorMeters(const Columns<double>& directions) const {
  long double worst = 0;
  for (const std::size_t v : vertices_) {
    const ReferenceVector given{directions.x[v], directions.y[v], directions.z[v]};
    worst = std::max(worst, lengthOf(given - directions_[v]) * static_cast<long double>(place_.radiusMeters));
  }
  return static_cast<double>(worst);
}

double Truth::heightErrorMeters(const std::vector<double>& heightMeters) const {
  long double worst = 0;
  for (std::size_t k = 0; k < vertices_.size(); ++k)
    worst = std::max(worst, std::fabs(static_cast<long double>(heightMeters[vertices_[k]]) - heightMeters_[k]));
  return static_cast<double>(worst);
}

double Truth::latticeErrorMeters(const std::vector<std::int64_t>& lattice,
                                 const std::vector<double>* heightMeters) const {
  const auto step = static_cast<long double>(stepMeters(kFinestExponent));
  long double worst = 0;
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const std::size_t v = vertices_[k];
    const auto height = heightMeters != nullptr ? static_cast<long double>((*heightMeters)[v]) : heightMeters_[k];
    const ReferenceVector at = position(v, height);
    const std::int64_t* point = &lattice[3 * v];
    const ReferenceVector given{static_cast<long double>(point[0]), static_cast<long double>(point[1]),
                                static_cast<long double>(point[2])};
    worst = std::max(worst, lengthOf(given * step - at));
  }
  return static_cast<double>(worst);
}

double Truth::gradientNormalErrorMeters(const std::vector<float>& normals, const Ground& ground) const {
  double worst = 0;
  for (const std::size_t v : vertices_) {
    const long double radial =
        1 + static_cast<long double>(ground.heightMeters[v]) / static_cast<long double>(place_.radiusMeters);
    const ReferenceVector gradient{ground.gradient.x[v], ground.gradient.y[v], ground.gradient.z[v]};
    worst = std::max(worst, tilt(normals, v, directions_[v] * radial - gradient, place_.cellMeters));
  }
  return worst;
}

double Truth::neighbourNormalErrorMeters(const std::vector<float>& normals,
                                         const std::vector<double>& heightMeters) const {
  const auto at = [&](std::size_t vertex) { return position(vertex, static_cast<long double>(heightMeters[vertex])); };
  double worst = 0;
  for (std::size_t v = 0; v < kVertices; ++v) {
    if (!inner(v)) continue;
    const ReferenceVector normal = cross(at(v + 1) - at(v - 1), at(v + kSide) - at(v - kSide));
    worst = std::max(worst, tilt(normals, v, normal, place_.cellMeters));
  }
  return worst;
}

}  // namespace terrane::accuracy
