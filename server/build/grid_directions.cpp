#include "server/build/grid_directions.h"

#include <cmath>
#include <cstdint>
#include <span>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"

namespace terrane {
namespace {

/// tan(s pi/4) on the cells + 1 grid lines of a tile that starts at `first`, in units of 2^-gridLevel of a face.
void lineTangents(std::uint64_t first, int cellsPerEdge, int gridLevel, std::vector<double>& out) {
  const double scale = std::ldexp(1.0, -gridLevel);
  const std::int64_t half = std::int64_t{1} << gridLevel;
  out.resize(static_cast<std::size_t>(cellsPerEdge) + 1);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::int64_t line = static_cast<std::int64_t>(first + i);
    out[i] = tanQuarterPi(static_cast<double>(2 * line - half) * scale);
  }
}

int levelsOf(int cellsPerEdge) noexcept {
  int levels = 0;
  while ((1 << levels) < cellsPerEdge) ++levels;
  return levels;
}

void resize(GridDirections& directions, std::size_t count) {
  directions.x.resize(count);
  directions.y.resize(count);
  directions.z.resize(count);
}

/// The last `count` of them.
DirectionSpans lastOf(GridDirections& directions, std::size_t count) {
  return {std::span(directions.x).last(count), std::span(directions.y).last(count),
          std::span(directions.z).last(count)};
}

/// Two tangents for each line of the grid serve all its vertices.
void cubeGridDirections(const FacePath& path, int cellsPerEdge, GridDirections& out) {
  thread_local std::vector<double> tangentsU, tangentsV;
  const int gridLevel = path.level() + levelsOf(cellsPerEdge);
  const auto cells = static_cast<std::uint64_t>(cellsPerEdge);
  lineTangents(path.column() * cells, cellsPerEdge, gridLevel, tangentsU);
  lineTangents(path.row() * cells, cellsPerEdge, gridLevel, tangentsV);

  const std::size_t side = tangentsU.size();
  resize(out, side * side);
  const FaceAxes axes = cubeFaceAxes(path.face());
  const double* alongU = tangentsU.data();
  for (std::size_t j = 0; j < side; ++j) {
    // The operations of cubeDirection, in its order: the bits of a shared vertex must not depend on the face it is
    // computed from.
    const glm::dvec3 ofRow = axes.v * tangentsV[j];
    double *x = out.x.data() + j * side, *y = out.y.data() + j * side, *z = out.z.data() + j * side;
    for (std::size_t i = 0; i < side; ++i) {
      const double a = alongU[i];
      const double px = (axes.normal.x + axes.u.x * a) + ofRow.x;
      const double py = (axes.normal.y + axes.u.y * a) + ofRow.y;
      const double pz = (axes.normal.z + axes.u.z * a) + ofRow.z;
      const double norm = std::sqrt((px * px + py * py) + pz * pz);
      x[i] = px / norm;
      y[i] = py / norm;
      z[i] = pz / norm;
    }
  }
}

/// VMin towards +u, UMax towards +v, VMax towards -u, UMin towards -v.
void appendCubeEdge(const FacePath& path, int skirtEdge, int cellsPerEdge, GridDirections& out) {
  const int gridLevel = path.level() + levelsOf(cellsPerEdge);
  const auto last = static_cast<std::uint64_t>(cellsPerEdge);
  for (std::uint64_t k = 0; k <= last; ++k) {
    const std::uint64_t u = skirtEdge == 0 ? k : skirtEdge == 1 ? last : skirtEdge == 2 ? last - k : 0;
    const std::uint64_t v = skirtEdge == 0 ? 0 : skirtEdge == 1 ? k : skirtEdge == 2 ? last : last - k;
    const glm::dvec3 direction =
        cubeGridDirection(path.face(), gridLevel, path.column() * last + u, path.row() * last + v);
    out.x.push_back(direction.x);
    out.y.push_back(direction.y);
    out.z.push_back(direction.z);
  }
}

}  // namespace

void gridDirections(const FacePath& path, int cellsPerEdge, GridDirections& out) {
  if (path.scheme() == Scheme::Cube) return cubeGridDirections(path, cellsPerEdge, out);
  const auto count = static_cast<std::size_t>(triangleGridSize(cellsPerEdge));
  resize(out, count);
  icoGridDirections(kIcoMap, path, cellsPerEdge, lastOf(out, count));
}

void appendEdgeDirections(const FacePath& path, int skirtEdge, int cellsPerEdge, GridDirections& out) {
  if (path.scheme() == Scheme::Cube) return appendCubeEdge(path, skirtEdge, cellsPerEdge, out);
  const auto count = static_cast<std::size_t>(cellsPerEdge) + 1;
  resize(out, out.x.size() + count);
  icoEdgeDirections(kIcoMap, path, skirtEdge, cellsPerEdge, lastOf(out, count));
}

}  // namespace terrane
