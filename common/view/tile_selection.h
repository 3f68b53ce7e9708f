#pragma once
// Which tiles to draw and which to ask for, as one pure function of (camera, resident tiles, settings). Hysteresis has
// no place here: it governs requests and residency (client/tiles). Thread-safe.
//
// Tiles are visited level by level from the six faces. A tile is refined when its screen-space error is too large, it
// has children, all its visible children are resident (for the drawn set), and no neighbour over an edge or corner
// would end up more than one level coarser (the drawn set is 2:1 balanced). Tiles outside the frustum or below the
// horizon are skipped.
//
// Children of a known tile are culled by its proven subtree heights, so nothing visible is ever left out. Below a tile
// that is not known yet, selection guesses from the nearest known ancestor's ground: so that a chain of ancestors can
// be asked for in one go, without asking for all that might be there. As tiles arrive, guesses give way to proofs.

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "common/tiling/face_path.h"
#include "common/tiling/tile_bounds.h"
#include "common/view/camera.h"

namespace terrane {

/// What selection needs to know of a body; filled from scene.json.
struct SelectionBody {
  Scheme scheme = Scheme::Cube;
  double radiusMeters = 0;
  int maxLevel = 0;
  HeightRange heights;              ///< proven range of the whole body
  double occluderRadiusMeters = 0;  ///< lowestSurfaceRadiusMeters(...)
  /// geometricErrorMeters[level], 0..maxLevel, strictly decreasing: how far a tile's mesh may be from the finest
  /// surface.
  std::vector<double> geometricErrorMeters;
};

/// What is known of a tile that was there at some time. subtreeHeights also bounds every descendant; it is proven, and
/// therefore wide. A tile that is to be drawn itself is culled by ownHeights, its mesh's, where that is given. A client
/// that drops a mesh does well to remember these few bytes (with drawable = false): the tile is then not asked for
/// again only to learn that it is out of view.
struct ResidentTile {
  HeightRange subtreeHeights;
  std::optional<HeightRange> ownHeights = std::nullopt;
  /// Of its mesh over each child's footprint: a tile that is drawn itself is left out if none of the four is in view.
  std::optional<std::array<HeightRange, 4>> quarterHeights = std::nullopt;
  bool drawable = true;
};
/// Returns null for a tile that nothing is known of. Called from the calling thread only.
using ResidentLookup = std::function<const ResidentTile*(const FacePath&)>;

struct SelectionSettings {
  double errorPixels = 2.0;
  bool frustumCulling = true;
  bool horizonCulling = true;
  int maxTiles = 4000;  ///< a bound on the work; the coarsest come first, so what is cut is the finest
};

struct WantedTile {
  FacePath path;
  double screenErrorPixels = 0;
  bool leaf = false;    ///< to be drawn once all is there; otherwise an ancestor
  bool beside = false;  ///< beside the picture: after all that is in it. Selection itself asks for no such tile
};

struct TileSelection {
  std::vector<FacePath> draw;      ///< resident, disjoint, covers all that is visible as far as the roots are resident
  std::vector<WantedTile> wanted;  ///< ancestors and leaves as if everything were resident, coarsest first
  bool complete = false;           ///< draw equals the leaves of wanted
  bool rootsMissing = false;       ///< some visible face has no resident tile at all: nothing can be drawn there yet
};

/// Whether the tile's ground may be in view: by its own mesh, or, if nothing is known of it, by its parent's over its
/// footprint (which is what shows in its place), or else by what the nearest tile above says of all below it.
bool tileMayBeSeen(const FacePath& path, const Camera& camera, const SelectionBody& body,
                   const ResidentLookup& resident);

/// A tile's screen-space error by what is known of its heights, as selection judges it once the tile is known.
double tileErrorPixels(const FacePath& path, const Camera& camera, const SelectionBody& body,
                       const ResidentLookup& resident);

/// From a camera that is nowhere (a position or field of view that is not finite): nothing, and not complete.
TileSelection selectTiles(const Camera& camera, const SelectionBody& body, const ResidentLookup& resident,
                          const SelectionSettings& settings);

}  // namespace terrane
