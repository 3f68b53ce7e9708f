#include "client/render/tile_grains.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "common/numerics/double_float3.h"

namespace terrane {
namespace {

std::vector<GpuVertex> readVertices(const GpuTile& tile) {
  std::vector<GpuVertex> vertices(tile.vertexCount);
  tile.vertices.read(0, std::as_writable_bytes(std::span(vertices)));
  return vertices;
}

std::uint64_t serialOf(const GpuTile* tile) { return tile == nullptr ? 0 : tile->serial; }
glm::vec3 normalOf(const GpuVertex& v) { return glm::vec3(v.normal[0], v.normal[1], v.normal[2]) / 32767.0f; }
glm::vec3 colorOf(const GpuVertex& v) { return {v.color[0], v.color[1], v.color[2]}; }
glm::ivec3 offsetOf(const GpuVertex& v) { return {v.offset[0], v.offset[1], v.offset[2]}; }

std::int16_t toShort(float value) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 32767.0f));
}
std::uint8_t toByte(float value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f))); }

/// A triangle of the drawn mesh and where in it a point is.
struct InTriangle {
  std::array<glm::ivec2, 3> corners;
  std::array<double, 3> weights;
};

/// Empty if the point is outside, or the triangle is none. In grid coordinates: exact enough for both sides of an edge
/// to give the same surface.
std::optional<InTriangle> within(const std::array<glm::ivec2, 3>& corners, const glm::dvec2& at) {
  const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
  const glm::dvec2 a(corners[0]), b(corners[1]), c(corners[2]);
  const double area = cross(b - a, c - a);
  if (!(area > 0)) return std::nullopt;
  const double u = cross(b - at, c - at) / area, v = cross(c - at, a - at) / area, w = cross(a - at, b - at) / area;
  if (u < 0 || v < 0 || w < 0) return std::nullopt;
  return InTriangle{corners, {u, v, w}};
}

/// The triangle of the drawn mesh that a point of the grid lies in. Beside a coarser tile the triangles are stitched,
/// and that of the next cell may reach into this one.
InTriangle triangleAt(const TileGrid& grid, unsigned coarserEdges, const glm::dvec2& at) {
  const int last = grid.cells - 1;
  const glm::ivec2 cell(std::min(static_cast<int>(at.x), last), std::min(static_cast<int>(at.y), last));
  std::optional<InTriangle> found;
  const auto look = [&](const GridVertex& a, const GridVertex& b, const GridVertex& c) {
    if (found) return;
    std::array<glm::ivec2, 3> corners{};
    std::ranges::transform(std::array{a, b, c}, corners.begin(), [&](const GridVertex& corner) {
      const GridVertex drawn = grid.stitched(coarserEdges, corner);
      return glm::ivec2(drawn.i, drawn.j);
    });
    found = within(corners, at);
  };
  for (const glm::ivec2 step :
       {glm::ivec2(0, 0), {1, 0}, {0, 1}, {1, 1}, {-1, 0}, {0, -1}, {-1, 1}, {1, -1}, {-1, -1}}) {
    const int i = cell.x + step.x, j = cell.y + step.y;
    if (i >= 0 && j >= 0 && j < grid.cells && i < grid.rowEnd(j)) grid.eachTriangle(i, j, look);
    if (found) return *found;
  }
  // A point on an edge that rounding puts outside of both: any of its corners will do.
  return {{cell, cell, cell}, {1, 0, 0}};
}

}  // namespace

/// The two meshes that a tile is drawn between.
class TileGrains::Surface {
 public:
  explicit Surface(const TileDraw& draw) : draw_(draw), own_(readVertices(*draw.tile)) {
    if (draw.parent != nullptr) parents_ = readVertices(*draw.parent);
  }

  Ends at(const glm::dvec2& cells) const {
    const TileMetadata& tile = draw_.tile->metadata;
    const TileGrid grid{tile.path.scheme(), tile.cellsPerEdge};
    const InTriangle triangle = triangleAt(grid, draw_.coarserEdges, cells);
    const double step = stepMeters(tile.stepExponent);
    Ends ends;
    glm::dvec3 offset(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const GridVertex corner{triangle.corners[k].x, triangle.corners[k].y};
      const GpuVertex& vertex = own_[static_cast<std::size_t>(grid.index(corner))];
      const auto weight = static_cast<float>(triangle.weights[k]);
      offset += glm::dvec3(offsetOf(vertex)) * triangle.weights[k];
      ends.normal[0] += weight * normalOf(vertex);
      ends.color[0] += weight * colorOf(vertex);
      ends.weight[k] = weight;
      ends.borders[k] = static_cast<std::uint8_t>(grid.borders(corner));
      if (draw_.parent == nullptr) continue;
      const ParentVertices to = draw_.grid.parentVertices(corner);
      const GpuVertex &first = parents_[static_cast<std::size_t>(to.first)],
                      &second = parents_[static_cast<std::size_t>(to.second)];
      const glm::ivec3 way = draw_.grid.parentMinusOwn + offsetOf(first) + offsetOf(second) - offsetOf(vertex);
      ends.way[k] = glm::vec3(glm::dvec3(way) * (triangle.weights[k] * step));
      ends.normal[1] += 0.5f * weight * (normalOf(first) + normalOf(second));
      ends.color[1] += 0.5f * weight * (colorOf(first) + colorOf(second));
    }
    ends.own = (glm::dvec3(tile.origin) + offset) * step;
    return ends;
  }

 private:
  const TileDraw& draw_;
  std::vector<GpuVertex> own_, parents_;
};

TileGrains::TileGrains(const GrainField& field, const TileDraw& draw)
    : tile_(draw.tile->serial),
      parent_(serialOf(draw.parent)),
      coarserEdges_(draw.coarserEdges),
      level_(draw.tile->metadata.path.level()) {
  const FacePath& path = draw.tile->metadata.path;
  for (int classLevel = field.coarsestClass(); classLevel <= std::min(field.finestClass(), level_ - kFinestClassBelow);
       ++classLevel) {
    const std::size_t first = grains_.size();
    field.collect(path, classLevel, grains_);
    if (grains_.size() == first) continue;
    runs_.push_back({grainMesh(level_, classLevel), static_cast<float>(field.largestMeters(classLevel)), first,
                     grains_.size() - first});
  }
  if (grains_.empty()) return;
  const Surface surface(draw);
  ends_.reserve(grains_.size());
  for (const Grain& grain : grains_) ends_.push_back(surface.at(grain.cells));
  instances_.resize(grains_.size());
  roots_.resize(grains_.size());
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    GrainInstance& instance = instances_[i];
    for (std::size_t c = 0; c < 4; ++c) instance.turn[c] = toShort(grains_[i].turn[c]);
    instance.variant = static_cast<std::uint16_t>(grains_[i].variant);
    instance.shade = toByte(grains_[i].shade * 127.5f);
    instance.flattening = toByte(grains_[i].flattening * 255.0f);
  }
  byBorders_.fill(-1.0f);
  moveTo(draw.byBorders);
}

bool TileGrains::fits(const TileDraw& draw) const noexcept {
  // One that was made to morph serves a tile that stands still, too.
  return tile_ == draw.tile->serial && (draw.parent == nullptr || parent_ == draw.parent->serial) &&
         coarserEdges_ == draw.coarserEdges;
}

void TileGrains::moveTo(const MorphByBorders& byBorders) {
  if (byBorders == byBorders_) return;
  byBorders_ = byBorders;
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    const Grain& grain = grains_[i];
    const Ends& ends = ends_[i];
    glm::dvec3 root = ends.own;
    float morph = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float value = byBorders[ends.borders[k]];
      root += glm::dvec3(ends.way[k]) * static_cast<double>(value);
      morph += ends.weight[k] * value;
    }
    morph = std::clamp(morph, 0.0f, 1.0f);
    const int below = level_ - grain.classLevel;
    const bool grows = below == kFinestClassBelow;
    const bool refines = below > kFinestClassBelow && (below - kFinestClassBelow) % 2 == 0 &&
                         grainMesh(level_, grain.classLevel) != grainMesh(level_ - 1, grain.classLevel);
    GrainInstance& instance = instances_[i];
    const DoubleFloat3 split = fromDouble(root);
    roots_[i] = root;
    instance.radiusMeters = 0.5f * grain.diameterMeters * (grows ? 1 - morph : 1.0f);
    instance.centerMeters = instance.radiusMeters * grain.flattening * grain.centerHeight;
    instance.detail = toByte(255.0f * (refines ? 1 - morph : 1.0f));
    const glm::vec3 normal = glm::normalize(glm::mix(ends.normal[0], ends.normal[1], morph)),
                    color = glm::mix(ends.color[0], ends.color[1], morph);
    for (int c = 0; c < 3; ++c) {
      const auto at = static_cast<std::size_t>(c);
      instance.rootHigh[at] = split.hi[c];
      instance.rootLow[at] = split.lo[c];
      instance.normal[at] = toShort(normal[c]);
      instance.color[at] = toByte(color[c]);
    }
  }
}

}  // namespace terrane
