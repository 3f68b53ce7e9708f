#include "server/build/grid_directions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"

namespace terrane {
namespace {

/// tan(s pi/4) on the cells + 1 grid lines from `first` on, in units of 2^-gridLevel of a face.
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

struct CubeLines {
  const FaceAxes& axes;
  DirectionSpans out;

  /// The operations of cubeDirection, in its order: the bits of a shared vertex must not depend on the face it is
  /// computed from.
  void direct(std::size_t vertex, double tangentU, double tangentV) const {
    const double px = (axes.normal.x + axes.u.x * tangentU) + axes.v.x * tangentV;
    const double py = (axes.normal.y + axes.u.y * tangentU) + axes.v.y * tangentV;
    const double pz = (axes.normal.z + axes.u.z * tangentU) + axes.v.z * tangentV;
    const double norm = std::sqrt((px * px + py * py) + pz * pz);
    out.x[vertex] = px / norm;
    out.y[vertex] = py / norm;
    out.z[vertex] = pz / norm;
  }
};

/// Two tangents for each line of the grid serve all its vertices.
void cubeGridDirections(const FacePath& path, int cellsPerEdge, GridDirections& out) {
  thread_local std::vector<double> tangentsU, tangentsV;
  const int gridLevel = path.level() + levelsOf(cellsPerEdge);
  const auto cells = static_cast<std::uint64_t>(cellsPerEdge);
  lineTangents(path.column() * cells, cellsPerEdge, gridLevel, tangentsU);
  lineTangents(path.row() * cells, cellsPerEdge, gridLevel, tangentsV);
  const std::size_t side = tangentsU.size();
  resize(out, side * side);
  const CubeLines lines{cubeFaceAxes(path.face()), lastOf(out, side * side)};
  for (std::size_t j = 0; j < side; ++j)
    for (std::size_t i = 0; i < side; ++i) lines.direct(j * side + i, tangentsU[i], tangentsV[j]);
}

/// VMin towards +u, UMax towards +v, VMax towards -u, UMin towards -v.
void appendCubeEdge(const FacePath& path, int skirtEdge, int cellsPerEdge, GridDirections& out) {
  thread_local std::vector<double> along, beside;
  const int gridLevel = path.level() + levelsOf(cellsPerEdge);
  const auto cells = static_cast<std::uint64_t>(cellsPerEdge);
  const bool alongU = skirtEdge % 2 == 0, atFarSide = skirtEdge == 1 || skirtEdge == 2;
  lineTangents((alongU ? path.column() : path.row()) * cells, cellsPerEdge, gridLevel, along);
  lineTangents((alongU ? path.row() : path.column()) * cells + (atFarSide ? cells : 0), 0, gridLevel, beside);
  if (skirtEdge >= 2) std::reverse(along.begin(), along.end());
  resize(out, out.x.size() + along.size());
  const CubeLines lines{cubeFaceAxes(path.face()), lastOf(out, along.size())};
  for (std::size_t k = 0; k < along.size(); ++k)
    lines.direct(k, alongU ? along[k] : beside[0], alongU ? beside[0] : along[k]);
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
