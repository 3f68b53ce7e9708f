#include "common/view/tile_borders.h"

#include <algorithm>
#include <array>

namespace terrane {
namespace {

/// The two edges that meet in each corner, by Side.
constexpr std::array<std::array<Side, 2>, 4> kEdgesOfCorner{
    {{Side::UMin, Side::VMin}, {Side::UMax, Side::VMin}, {Side::UMin, Side::VMax}, {Side::UMax, Side::VMax}}};

/// Collects what is around an edge or a corner.
struct Around {
  bool coarser = false, finer = false;
  float largest;

  void see(const DrawnCut& cut, const FacePath& path, Side side) {
    switch (beyond(cut, path, side)) {
      case Beyond::Nothing:
        return;
      case Beyond::Coarser:
        coarser = true;
        return;
      case Beyond::Finer:
        finer = true;
        return;
      case Beyond::Equal:
        largest = std::max(largest, cut.own(*path.neighbour(side)));
        return;
    }
  }
  float value() const { return coarser ? 1.0f : finer ? 0.0f : largest; }
};

}  // namespace

void DrawnCut::insert(const FacePath& path, float own) {
  own_[path] = own;
  for (int level = 0; level < path.level(); ++level) ++descendants_[path.ancestor(level)];
}

void DrawnCut::erase(const FacePath& path) {
  if (own_.erase(path) == 0) return;
  for (int level = 0; level < path.level(); ++level) {
    const auto above = descendants_.find(path.ancestor(level));
    if (--above->second == 0) descendants_.erase(above);
  }
}

void DrawnCut::clear() {
  own_.clear();
  descendants_.clear();
}

std::optional<FacePath> DrawnCut::leafOver(const FacePath& path) const {
  for (int level = path.level(); level >= 0; --level)
    if (contains(path.ancestor(level))) return path.ancestor(level);
  return std::nullopt;
}

std::vector<FacePath> DrawnCut::tiles() const {
  std::vector<FacePath> sorted;
  sorted.reserve(own_.size());
  for (const auto& [path, value] : own_) sorted.push_back(path);
  std::ranges::sort(sorted, [](const FacePath& a, const FacePath& b) {
    return a.level() != b.level() ? a.level() < b.level() : a < b;
  });
  return sorted;
}

Beyond beyond(const DrawnCut& cut, const FacePath& path, Side side) {
  const std::optional<FacePath> neighbour = path.neighbour(side);
  if (!neighbour) return Beyond::Nothing;
  if (cut.contains(*neighbour)) return Beyond::Equal;
  if (cut.isRefined(*neighbour)) return Beyond::Finer;
  return cut.leafOver(*neighbour) ? Beyond::Coarser : Beyond::Nothing;
}

TileMorph morphOf(const DrawnCut& cut, const FacePath& path) {
  TileMorph morph;
  morph.own = cut.own(path);
  for (int edge = 0; edge < kEdgeCount; ++edge) {
    Around around{.largest = morph.own};
    around.see(cut, path, static_cast<Side>(edge));
    morph.sides[static_cast<std::size_t>(edge)] = around.value();
    if (around.coarser) morph.coarserEdges = static_cast<std::uint8_t>(morph.coarserEdges | (1u << edge));
  }
  for (int corner = kEdgeCount; corner < kSideCount; ++corner) {
    Around around{.largest = morph.own};
    around.see(cut, path, static_cast<Side>(corner));
    for (const Side edge : kEdgesOfCorner[static_cast<std::size_t>(corner - kEdgeCount)]) around.see(cut, path, edge);
    morph.sides[static_cast<std::size_t>(corner)] = around.value();
  }
  return morph;
}

}  // namespace terrane
