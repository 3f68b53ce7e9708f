#pragma once
// What the tiles of a drawn set have to agree on: from which tiles are drawn, and how far each is morphed towards its
// parent, the morph of every edge and corner. Pure functions, thread-safe.
//
// A border is drawn as the coarser of the two tiles has it: morph 1 on the finer side, 0 on the coarser. Between equals
// it is the larger of their two values, so that both give the same; where nothing is drawn beyond, the tile's own. A
// corner follows the same rule over all tiles around it. So tiles that share a vertex place it alike, whatever their
// values, as long as the set is 2:1 balanced over edges and corners.

#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/view/drawn_tile.h"

namespace terrane {

/// Disjoint tiles with their own morph, and the tiles above them.
class DrawnCut {
 public:
  /// Precondition: neither it nor an ancestor or a descendant of it is in the cut.
  void insert(const FacePath& path, float own);
  void erase(const FacePath& path);
  void clear();

  bool contains(const FacePath& path) const { return own_.contains(path); }
  /// Some tile below it is in the cut.
  bool isRefined(const FacePath& path) const { return descendants_.contains(path); }
  /// The tile of the cut that is path or an ancestor of it; empty if there is none.
  std::optional<FacePath> leafOver(const FacePath& path) const;
  float own(const FacePath& path) const { return own_.at(path); }
  void setOwn(const FacePath& path, float value) { own_.at(path) = value; }
  /// Coarsest first, then by path: an order that depends on nothing else. A copy: the cut may change meanwhile.
  std::vector<FacePath> tiles() const { return sorted_; }
  std::size_t size() const { return own_.size(); }

 private:
  std::unordered_map<FacePath, float> own_;
  std::vector<FacePath> sorted_;
  std::unordered_map<FacePath, int> descendants_;  ///< how many of the cut's tiles are below
};

/// What is drawn where a tile of some level lies.
enum class DrawnThere : std::uint8_t { Nothing, Coarser, Equal, Finer };
DrawnThere drawnAt(const DrawnCut& cut, const FacePath& path);

TileMorph morphOf(const DrawnCut& cut, const FacePath& path);

}  // namespace terrane
