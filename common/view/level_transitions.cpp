#include "common/view/level_transitions.h"

#include <algorithm>
#include <unordered_set>

namespace terrane {

/// The wanted cut, with how deep it goes below each tile above it.
class LevelTransitions::Wanted {
 public:
  explicit Wanted(std::span<const FacePath> tiles) : tiles_(tiles.begin(), tiles.end()) {
    for (const FacePath& tile : tiles_) {
      leaves_.insert(tile);
      // Above a tile that knows of one as deep, all know.
      for (int level = tile.level() - 1; level >= 0; --level) {
        int& deepest = deepestBelow_[tile.ancestor(level)];
        if (deepest >= tile.level()) break;
        deepest = tile.level();
      }
    }
  }

  const std::vector<FacePath>& tiles() const { return tiles_; }
  bool contains(const FacePath& path) const { return leaves_.contains(path); }
  bool refines(const FacePath& path) const { return deepestBelow_.contains(path); }
  /// A wanted tile that is a true ancestor, or -1.
  int coarserLevel(const FacePath& path) const {
    for (int level = path.level() - 1; level >= 0; --level) {
      const FacePath ancestor = path.ancestor(level);
      if (leaves_.contains(ancestor)) return level;
      if (refines(ancestor)) break;  // so nothing above it is wanted itself
    }
    return -1;
  }
  bool overlaps(const FacePath& path) const { return contains(path) || refines(path) || coarserLevel(path) >= 0; }
  /// How many levels a drawn tile is away from what is wanted in its place.
  int levelsAway(const FacePath& path) const {
    if (const auto below = deepestBelow_.find(path); below != deepestBelow_.end()) return below->second - path.level();
    const int coarser = coarserLevel(path);
    return coarser >= 0 ? path.level() - coarser : 0;
  }

 private:
  std::vector<FacePath> tiles_;
  std::unordered_set<FacePath> leaves_;
  std::unordered_map<FacePath, int> deepestBelow_;
};

namespace {

template <class Predicate>
bool everySideOf(const TileMorph& morph, Predicate holds) {
  return std::ranges::all_of(morph.sides, holds);
}

/// The tiles around one, at its own level.
template <class Function>
void forEachNeighbour(const FacePath& path, const Function& function) {
  for (const FacePath& tile : tilesAround(path)) function(tile);
}

}  // namespace

std::vector<DrawnTile> LevelTransitions::advance(std::span<const FacePath> wantedTiles, double seconds,
                                                 const Question& canMorph, const Question& mayBeSeen) {
  const Wanted wanted(wantedTiles);
  if (!settings_.morph) {
    settleAtOnce(wanted);
  } else {
    leaveAndEnter(wanted, canMorph, mayBeSeen);
    split(wanted, canMorph);
    merge(wanted);
    fade(wanted, seconds, canMorph);
    hurry(wanted, canMorph);
  }
  std::vector<DrawnTile> drawn;
  settled_ = true;
  for (const FacePath& path : cut_.tiles()) {
    drawn.push_back({path, morphOf(cut_, path)});
    settled_ = settled_ && wanted.contains(path) && drawn.back().morph.own == 0;
  }
  return drawn;
}

void LevelTransitions::settleAtOnce(const Wanted& wanted) {
  cut_.clear();
  for (const FacePath& path : wanted.tiles()) cut_.insert(path, 0);
}

void LevelTransitions::jump(const Wanted& wanted) {
  settleAtOnce(wanted);
  ++counts_.jumps;
}

void LevelTransitions::leaveAndEnter(const Wanted& wanted, const Question& canMorph, const Question& mayBeSeen) {
  for (const FacePath& path : cut_.tiles()) {
    if (wanted.overlaps(path)) continue;
    cut_.erase(path);
    ++counts_.left;
  }
  for (const FacePath& path : wanted.tiles()) {
    if (cut_.leafOver(path)) continue;
    if (!cut_.isRefined(path)) {
      if (!enterFiner(path, canMorph, mayBeSeen)) enter(path);
      ++counts_.entered;
    } else if (!fillGaps(path, canMorph, mayBeSeen)) {
      mergeAtOnce(path);
      ++counts_.hurried;
    }
  }
}

/// A tile that is wanted whole is drawn by some of its descendants, the others having been out of view: those that now
/// may be seen come in. False if one of them is not there.
bool LevelTransitions::fillGaps(const FacePath& above, const Question& canMorph, const Question& mayBeSeen) {
  for (int digit = 0; digit < 4; ++digit) {
    const FacePath child = above.child(digit);
    if (cut_.contains(child)) continue;
    if (cut_.isRefined(child)) {
      if (!fillGaps(child, canMorph, mayBeSeen)) return false;
    } else if (mayBeSeen(child)) {
      if (!canMorph(child)) return false;
      cut_.insert(child, 0);
      ++counts_.entered;
    }
  }
  return true;
}

/// A tile beside others that are drawn two levels finer, or more, comes in by its children, as fine as they ask for.
/// False if it has no such neighbours, or a child that may be seen is not there.
bool LevelTransitions::enterFiner(const FacePath& path, const Question& canMorph, const Question& mayBeSeen) {
  if (!muchFinerBeside(path)) return false;
  for (int digit = 0; digit < 4; ++digit)
    if (mayBeSeen(path.child(digit)) && !canMorph(path.child(digit))) return false;
  for (int digit = 0; digit < 4; ++digit) {
    const FacePath child = path.child(digit);
    if (mayBeSeen(child) && !enterFiner(child, canMorph, mayBeSeen)) cut_.insert(child, 0);
  }
  return true;
}

/// Whether a tile that touches this one is two or more levels finer.
bool LevelTransitions::muchFinerBeside(const FacePath& path) const {
  bool found = false;
  for (int digit = 0; digit < 4 && !found; ++digit)
    forEachNeighbour(path.child(digit), [&](const FacePath& neighbour) {
      found = found || (neighbour.parent() != path && cut_.isRefined(neighbour));
    });
  return found;
}

/// A tile comes in as it is wanted, or coarser where what is drawn beside it is not that far yet.
void LevelTransitions::enter(const FacePath& path) {
  for (FacePath entering = path; !cut_.isRefined(entering); entering = entering.parent()) {
    if (coarserBeside(entering)) continue;
    cut_.insert(entering, 0);
    return;
  }
  cut_.insert(path, 0);
}

/// A tile of the cut beside this one that is more than a level coarser.
std::optional<FacePath> LevelTransitions::coarserBeside(const FacePath& path) const {
  std::optional<FacePath> found;
  forEachNeighbour(path, [&](const FacePath& neighbour) {
    const auto leaf = cut_.leafOver(neighbour);
    if (leaf && leaf->level() < path.level() - 1) found = leaf;
  });
  return found;
}

/// Tiles have come in beside others that are not yet as they are to be, and are now too fine or too coarse for them:
/// those change at once. That is at the rim of the view, where tiles come in.
void LevelTransitions::hurry(const Wanted& wanted, const Question& canMorph) {
  for (bool again = true; again;) {
    again = false;
    for (const FacePath& path : cut_.tiles()) {
      const std::optional<FacePath> coarse = coarserBeside(path);
      if (!coarse) continue;
      if (wanted.coarserLevel(path) >= 0) {
        mergeAtOnce(path.parent());
      } else if (wanted.refines(*coarse)) {
        splitAtOnce(*coarse, wanted, canMorph);
      } else {
        return jump(wanted);
      }
      ++counts_.hurried;
      again = true;
      break;
    }
  }
}

void LevelTransitions::mergeAtOnce(const FacePath& parent) {
  for (const FacePath& path : cut_.tiles())
    if (path.level() > parent.level() && path.ancestor(parent.level()) == parent) cut_.erase(path);
  cut_.insert(parent, 0);
}

void LevelTransitions::splitAtOnce(const FacePath& path, const Wanted& wanted, const Question& canMorph) {
  cut_.erase(path);
  for (int digit = 0; digit < 4; ++digit) {
    const FacePath child = path.child(digit);
    if (wanted.overlaps(child)) cut_.insert(child, canMorph(child) ? 1.0f : 0.0f);
  }
}

void LevelTransitions::split(const Wanted& wanted, const Question& canMorph) {
  // Decided before any is carried out: a split changes nothing for the others, whose sides towards it are 0 already.
  std::vector<FacePath> ready;
  for (const FacePath& path : cut_.tiles()) {
    if (!wanted.refines(path) || cut_.own(path) != 0) continue;
    if (everySideOf(morphOf(cut_, path), [](float side) { return side == 0; })) ready.push_back(path);
  }
  for (const FacePath& path : ready) {
    splitAtOnce(path, wanted, canMorph);
    ++counts_.splits;
  }
}

/// Merged now, the parent would not be too coarse for what is beside it, and nothing of it is finer than its children.
bool LevelTransitions::mayMerge(const FacePath& parent) const {
  for (int digit = 0; digit < 4; ++digit) {
    const FacePath child = parent.child(digit);
    if (cut_.isRefined(child)) return false;
    if (!cut_.contains(child)) continue;
    bool finerBeside = false;
    forEachNeighbour(child, [&](const FacePath& neighbour) { finerBeside = finerBeside || cut_.isRefined(neighbour); });
    if (finerBeside) return false;
  }
  return true;
}

bool LevelTransitions::isReadyToMerge(const FacePath& parent) const {
  for (int digit = 0; digit < 4; ++digit) {
    const FacePath child = parent.child(digit);
    if (!cut_.contains(child)) continue;
    const TileMorph morph = morphOf(cut_, child);
    if (morph.own != 1 || !everySideOf(morph, [](float side) { return side == 1; })) return false;
  }
  // The parent's equals must be their own surface: a border between equals is the larger of the two.
  bool equalsAreWhole = true;
  forEachNeighbour(parent, [&](const FacePath& neighbour) {
    equalsAreWhole = equalsAreWhole && (!cut_.contains(neighbour) || cut_.own(neighbour) == 0);
  });
  return equalsAreWhole;
}

void LevelTransitions::merge(const Wanted& wanted) {
  std::unordered_set<FacePath> seen;
  for (const FacePath& path : cut_.tiles()) {
    if (path.level() == 0 || wanted.coarserLevel(path) < 0 || !seen.insert(path.parent()).second) continue;
    const FacePath parent = path.parent();
    if (!mayMerge(parent) || !isReadyToMerge(parent)) continue;
    mergeAtOnce(parent);
    ++counts_.merges;
  }
}

void LevelTransitions::fade(const Wanted& wanted, double seconds, const Question& canMorph) {
  for (const FacePath& path : cut_.tiles()) {
    const bool merging = path.level() > 0 && wanted.coarserLevel(path) >= 0 && mayMerge(path.parent());
    const float goal = merging ? 1.0f : 0.0f, now = cut_.own(path);
    if (now == goal) continue;
    // Many levels to go: each takes less.
    const double step = seconds / settings_.secondsPerLevel * (1 + wanted.levelsAway(path));
    const auto next = static_cast<float>(goal > now ? std::min(1.0, static_cast<double>(now) + step)
                                                    : std::max(0.0, static_cast<double>(now) - step));
    cut_.setOwn(path, canMorph(path) ? next : goal);
  }
}

}  // namespace terrane
