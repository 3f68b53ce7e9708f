#pragma once
// From what selection wants drawn to what is drawn: every change of level is a morph that begins and ends in a picture
// without a change. A tile is replaced by its children only while it is its own surface, all around; they begin as that
// very surface, fully morphed, and grow into their own. Children are replaced by their parent only when they have
// become its surface, all around. So nothing pops, be it the camera that moved or a tile that came late, and what is
// drawn is always closed: 2:1 balanced, with borders that both sides compute alike (tile_borders.h).
//
// What is drawn lags behind what is wanted, by secondsPerLevel for a level, and less for each where many are missing.
// Tiles that enter the view come in at once, as what they are to be. Where the rules cannot be kept (the camera
// jumped), everything is drawn as wanted at once: that is a pop, and counted.
//
// One thread. Deterministic: what is drawn follows from the calls alone.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/view/tile_borders.h"

namespace terrane {

struct TransitionSettings {
  double secondsPerLevel = 0.4;
  bool morph = true;  ///< off: what is wanted is drawn at once, for comparison
};

struct TransitionCounts {
  std::uint64_t splits = 0, merges = 0;
  std::uint64_t entered = 0, left = 0;
  std::uint64_t hurried = 0;  ///< splits and merges that could not wait, at the rim of the view
  std::uint64_t jumps = 0;    ///< all at once, visibly
  bool operator==(const TransitionCounts&) const = default;
};

class LevelTransitions {
 public:
  explicit LevelTransitions(TransitionSettings settings = {}) : settings_(settings) {}

  using Question = std::function<bool(const FacePath&)>;
  /// A frame: wanted is 2:1 balanced, disjoint and drawable (TileSelection::draw); seconds since the frame before, 0
  /// for the first. canMorph: the tile's mesh and its parent's are there. mayBeSeen: the tile may be in view; asked for
  /// parts of a wanted tile that are not drawn yet, while others are in its children.
  std::vector<DrawnTile> advance(std::span<const FacePath> wanted, double seconds, const Question& canMorph,
                                 const Question& mayBeSeen);

  /// What is drawn is what was wanted, each as its own surface: the next call changes nothing.
  bool settled() const noexcept { return settled_; }
  const TransitionCounts& counts() const noexcept { return counts_; }

 private:
  class Wanted;
  void leaveAndEnter(const Wanted& wanted, const Question& canMorph, const Question& mayBeSeen);
  bool fillGaps(const FacePath& above, const Question& canMorph, const Question& mayBeSeen);
  bool enterFiner(const FacePath& path, const Question& canMorph, const Question& mayBeSeen);
  bool muchFinerBeside(const FacePath& path) const;
  void enter(const FacePath& path);
  std::optional<FacePath> coarserBeside(const FacePath& path) const;
  void hurry(const Wanted& wanted, const Question& canMorph);
  void split(const Wanted& wanted, const Question& canMorph);
  void splitAtOnce(const FacePath& path, const Wanted& wanted, const Question& canMorph);
  void merge(const Wanted& wanted);
  void mergeAtOnce(const FacePath& parent);
  void fade(const Wanted& wanted, double seconds, const Question& canMorph);
  bool mayMerge(const FacePath& parent) const;
  bool isReadyToMerge(const FacePath& parent) const;
  void jump(const Wanted& wanted);
  void settleAtOnce(const Wanted& wanted);

  TransitionSettings settings_;
  TransitionCounts counts_;
  DrawnCut cut_;
  bool settled_ = false;
};

}  // namespace terrane
