#include "common/view/tile_borders.h"

#include <algorithm>

namespace terrane {
namespace {

/// What is around an edge or a corner.
struct Around {
  bool coarser = false, finer = false;
  float largest = 0;  ///< morph of an equal

  void add(const DrawnCut& cut, const FacePath& tile) {
    switch (drawnAt(cut, tile)) {
      case DrawnThere::Nothing:
        return;
      case DrawnThere::Coarser:
        coarser = true;
        return;
      case DrawnThere::Finer:
        finer = true;
        return;
      case DrawnThere::Equal:
        largest = std::max(largest, cut.own(tile));
        return;
    }
  }
  /// Of a tile whose own morph this is.
  float value(float own) const { return coarser ? 1.0f : finer ? 0.0f : std::max(own, largest); }
};

/// Coarsest first.
bool comesBefore(const FacePath& a, const FacePath& b) {
  return a.level() != b.level() ? a.level() < b.level() : a < b;
}

}  // namespace

void DrawnCut::insert(const FacePath& path, float own) {
  own_[path] = own;
  sorted_.insert(std::ranges::lower_bound(sorted_, path, comesBefore), path);
  for (int level = 0; level < path.level(); ++level) ++descendants_[path.ancestor(level)];
}

void DrawnCut::erase(const FacePath& path) {
  if (own_.erase(path) == 0) return;
  sorted_.erase(std::ranges::lower_bound(sorted_, path, comesBefore));
  for (int level = 0; level < path.level(); ++level) {
    const auto above = descendants_.find(path.ancestor(level));
    if (--above->second == 0) descendants_.erase(above);
  }
}

void DrawnCut::clear() {
  own_.clear();
  sorted_.clear();
  descendants_.clear();
}

std::optional<FacePath> DrawnCut::leafOver(const FacePath& path) const {
  for (int level = path.level(); level >= 0; --level) {
    const FacePath ancestor = path.ancestor(level);
    if (contains(ancestor)) return ancestor;
    if (isRefined(ancestor)) break;  // so nothing above it is in the cut
  }
  return std::nullopt;
}

DrawnThere drawnAt(const DrawnCut& cut, const FacePath& path) {
  if (cut.contains(path)) return DrawnThere::Equal;
  if (cut.isRefined(path)) return DrawnThere::Finer;
  return cut.leafOver(path) ? DrawnThere::Coarser : DrawnThere::Nothing;
}

TileMorph morphOf(const DrawnCut& cut, const FacePath& path) {
  TileMorph morph;
  morph.own = cut.own(path);
  morph.sides.fill(morph.own);  // those that a triangle lacks never differ
  const int edges = edgeCount(path.scheme());
  for (int edge = 0; edge < edges; ++edge) {
    Around around;
    around.add(cut, tileBeyondEdge(path, edge));
    const float value = around.value(morph.own);
    morph.sides[static_cast<std::size_t>(edge)] = value;
    // Between equals too: else a split beyond, which makes the border a coarser tile's, would turn the diagonals there.
    if (value == 1) morph.coarserEdges = static_cast<std::uint8_t>(morph.coarserEdges | (1u << edge));
  }
  for (int corner = 0; corner < edges; ++corner) {
    Around around;
    for (const FacePath& tile : tilesAtCorner(path, corner)) around.add(cut, tile);
    morph.sides[static_cast<std::size_t>(kMostEdges + corner)] = around.value(morph.own);
  }
  return morph;
}

}  // namespace terrane
