#include "server/build/skirt.h"

#include <algorithm>
#include <cmath>

#include "common/numerics/strict_math.h"

namespace terrane {
namespace {

double dot(const glm::dvec3& p, const glm::dvec3& q) noexcept { return (p.x * q.x + p.y * q.y) + p.z * q.z; }
glm::dvec3 cross(const glm::dvec3& p, const glm::dvec3& q) noexcept {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

/// Where the line from a to b passes under direction d, all in one plane with the centre: its distance from there.
double chordRadius(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& d) noexcept {
  const glm::dvec3 along = b - a, normal = cross(a, b);
  // (a + t along) x d = 0, measured along the plane's normal.
  const double t = -dot(cross(a, d), normal) / dot(cross(along, d), normal);
  return dot(a + along * t, d);
}

class SkirtBuilder {
 public:
  SkirtBuilder(const SkirtInput& tile, SkirtScratch& scratch, std::vector<double>& lowest)
      : tile_(tile),
        scratch_(scratch),
        lowest_(lowest),
        edges_(tile.topology.edgeCount()),
        cells_(static_cast<std::size_t>(tile.topology.cellsPerEdge)) {}

  void run() {
    lowest_.clear();
    for (const std::uint32_t anchor : tile_.topology.skirtAnchors) lowest_.push_back(tile_.heightMeters[anchor]);
    if (tile_.path.level() > 0) lowerToCoarserEdges();
    if (static_cast<std::size_t>(tile_.path.level()) + 1 < tile_.levels.size()) lowerToFinerEdges();
    shareCorners();
    const double margin = tile_.levels[static_cast<std::size_t>(tile_.path.level())].skirtMarginMeters;
    for (double& height : lowest_) height -= margin;
  }

 private:
  /// Two edges' skirts end in one point below a corner.
  void shareCorners() {
    for (std::size_t edge = 0; edge < edges_; ++edge) {
      double &end = lowest(edge, cells_), &start = lowest((edge + 1) % edges_, 0);
      end = start = std::min(end, start);
    }
  }

  double& lowest(std::size_t edge, std::size_t k) { return lowest_[edge * (cells_ + 1) + k]; }

  glm::dvec3 anchorDirection(std::size_t edge, std::size_t k) const {
    const std::uint32_t anchor = tile_.topology.skirtAnchors[edge * (cells_ + 1) + k];
    return {tile_.directions.x[anchor], tile_.directions.y[anchor], tile_.directions.z[anchor]};
  }

  /// Edge by edge: a batch that runs around the tile would be as wide as the tile everywhere. Each edge ends where the
  /// next one starts.
  void evaluate(std::size_t samplesPerEdge, int level) {
    const GridDirections& d = scratch_.directions;
    samplesPerEdge_ = samplesPerEdge;
    scratch_.heightMeters.clear();
    for (std::size_t edge = 0; edge < edges_; ++edge) {
      const std::size_t at = edge * (samplesPerEdge + 1);
      SampleBatch batch{d.x.data() + at, d.y.data() + at, d.z.data() + at, 1, samplesPerEdge};
      batch.grid = GridPlace{tile_.path, static_cast<int>(samplesPerEdge), static_cast<int>(edge)};
      batch.toleranceMeters = tile_.levels[static_cast<std::size_t>(tile_.path.level())].toleranceMeters;
      tile_.field.evaluate(batch, tile_.levels[static_cast<std::size_t>(level)].minWavelengthMeters, scratch_.samples);
      scratch_.heightMeters.insert(scratch_.heightMeters.end(), scratch_.samples.heightMeters.begin(),
                                   scratch_.samples.heightMeters.end());
    }
  }
  double evaluated(std::size_t edge, std::size_t k) const {
    return scratch_.heightMeters[(edge * samplesPerEdge_ + k) % scratch_.heightMeters.size()];
  }

  void startDirections() {
    scratch_.directions.x.clear();
    scratch_.directions.y.clear();
    scratch_.directions.z.clear();
  }
  void addDirection(const glm::dvec3& direction) {
    scratch_.directions.x.push_back(direction.x);
    scratch_.directions.y.push_back(direction.y);
    scratch_.directions.z.push_back(direction.z);
  }

  /// A coarser neighbour has every other vertex of this edge, and straight lines between.
  void lowerToCoarserEdges() {
    startDirections();
    for (std::size_t edge = 0; edge < edges_; ++edge)
      for (std::size_t k = 0; k <= cells_; k += 2) addDirection(anchorDirection(edge, k));
    evaluate(cells_ / 2, tile_.path.level() - 1);
    for (std::size_t edge = 0; edge < edges_; ++edge) {
      const auto coarse = [&](std::size_t k) { return evaluated(edge, k); };
      for (std::size_t k = 0; k <= cells_; k += 2) lower(edge, k, coarse(k / 2));
      for (std::size_t k = 1; k < cells_; k += 2) {
        const glm::dvec3 a = anchorDirection(edge, k - 1) * (tile_.radiusMeters + coarse(k / 2));
        const glm::dvec3 b = anchorDirection(edge, k + 1) * (tile_.radiusMeters + coarse(k / 2 + 1));
        lower(edge, k, chordRadius(a, b, anchorDirection(edge, k)) - tile_.radiusMeters);
      }
    }
  }

  /// A finer neighbour has a vertex at each of this edge's, and one between each two: both ends go below that one.
  void lowerToFinerEdges() {
    startDirections();
    for (std::size_t edge = 0; edge < edges_; ++edge)
      appendEdgeDirections(tile_.path, static_cast<int>(edge), 2 * tile_.topology.cellsPerEdge, scratch_.directions);
    evaluate(2 * cells_, tile_.path.level() + 1);
    for (std::size_t edge = 0; edge < edges_; ++edge) {
      for (std::size_t q = 0; q <= 2 * cells_; ++q) {
        lower(edge, q / 2, evaluated(edge, q));
        lower(edge, (q + 1) / 2, evaluated(edge, q));
      }
    }
  }

  void lower(std::size_t edge, std::size_t k, double height) { lowest(edge, k) = std::min(lowest(edge, k), height); }

  const SkirtInput& tile_;
  SkirtScratch& scratch_;
  std::vector<double>& lowest_;
  std::size_t edges_, cells_, samplesPerEdge_ = 0;
};

}  // namespace

void skirtHeights(const SkirtInput& tile, SkirtScratch& scratch, std::vector<double>& out) {
  SkirtBuilder(tile, scratch, out).run();
}

}  // namespace terrane
