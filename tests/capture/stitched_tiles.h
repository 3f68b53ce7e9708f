#pragma once
// How tests draw a set of tiles without skirts. What touches a coarser tile is its parent's.

#include <cstdint>
#include <span>
#include <vector>

#include "common/view/drawn_tile.h"

namespace terrane {

/// A settled set: every tile its own surface, but for edges and corners that touch a coarser one. paths: no tile with
/// its own ancestor, 2:1 balanced over edges and corners.
std::vector<DrawnTile> stitchedTiles(std::span<const FacePath> paths);
/// The same in the middle of transitions: every tile, edge and corner between equals at a random value of its own,
/// which all that share it agree on; 0 towards finer tiles.
std::vector<DrawnTile> tilesOnTheirWay(std::span<const FacePath> paths, std::uint64_t seed);

/// One value everywhere.
inline TileMorph morphedBy(float morph) {
  TileMorph all{morph, {}, 0};
  all.sides.fill(morph);
  return all;
}

}  // namespace terrane
