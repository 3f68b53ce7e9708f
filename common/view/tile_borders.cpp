#include "common/view/tile_borders.h"

#include <algorithm>
#include <array>

namespace terrane {
namespace {

/// The two edges that meet in each corner, by Side.
constexpr std::array<std::array<Side, 2>, 4> kEdgesOfCorner{
    {{Side::UMin, Side::VMin}, {Side::UMax, Side::VMin}, {Side::UMin, Side::VMax}, {Side::UMax, Side::VMax}}};

/// What is around an edge or a corner.
struct Around {
  bool coarser = false, finer = false;
  float largest = 0;  ///< morph of an equal

  Around() = default;
  Around(const DrawnCut& cut, const FacePath& path, Side side) {
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
        largest = cut.own(*path.neighbour(side));
        return;
    }
  }
  Around with(const Around& other) const {
    Around both = *this;
    both.coarser = coarser || other.coarser;
    both.finer = finer || other.finer;
    both.largest = std::max(largest, other.largest);
    return both;
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
  std::array<Around, kSideCount> around;
  for (std::size_t side = 0; side < kSideCount; ++side) around[side] = Around(cut, path, static_cast<Side>(side));
  for (std::size_t edge = 0; edge < kEdgeCount; ++edge) {
    morph.sides[edge] = around[edge].value(morph.own);
    // Between equals too: else a split beyond, which makes the border a coarser tile's, would turn the diagonals there.
    if (morph.sides[edge] == 1) morph.coarserEdges = static_cast<std::uint8_t>(morph.coarserEdges | (1u << edge));
  }
  for (std::size_t corner = kEdgeCount; corner < kSideCount; ++corner) {
    const auto [one, other] = kEdgesOfCorner[corner - kEdgeCount];
    const Around all =
        around[corner].with(around[static_cast<std::size_t>(one)]).with(around[static_cast<std::size_t>(other)]);
    morph.sides[corner] = all.value(morph.own);
  }
  return morph;
}

}  // namespace terrane
