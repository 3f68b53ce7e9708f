#include "common/view/tile_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <unordered_set>

#include "common/tiling/tile_neighbours.h"
#include "common/view/frustum.h"
#include "common/view/horizon.h"
#include "common/view/level_of_detail.h"

namespace terrane {
namespace {

constexpr int kNone = -1;
/// How many levels below the last known tile are asked for on a guess. Each level guessed loads more that is then not
/// seen: over the moon, asking level by level takes 15 rounds and loads 2.0 times what the view needs; three guesses
/// take 7 rounds and load 2.1 times, all levels at once 4 rounds and 3.2 times (selection_brute_force_test prints
/// both).
constexpr int kMostGuesses = 3;

/// A tile that was looked at. Nodes of one level are contiguous, the four children of one tile too.
struct Node {
  FacePath path;
  HeightRange subtreeHeights;  ///< the tile's if it is known, else those of the nearest known ancestor, else the body's
  HeightRange ownHeights;      ///< likewise; for a tile that is not known no bound, but where its ground will about be
  double errorPixels = 0;
  int guesses = 0;  ///< how many levels above it, itself included, nothing is known of
  bool known = false;
  bool drawable = false;
  bool visible = false;
  bool needed = false;  ///< visible, and so is a leaf of the wanted tree below it, as far as is known
  bool drawn = false;   ///< in the drawn tree: a leaf of it or above one
  bool drawnRefined = false;
  int parent = kNone;
  int firstChild = kNone;      ///< set if the wanted tree refines it
  int firstNeighbour = kNone;  ///< of TileList::kMost entries in neighbours_, if the wanted tree refines it
};

/// Both heights bound the tile, so their intersection does. Empty only if one of them is wrong: then the tile's own
/// word counts.
HeightRange intersection(const HeightRange& own, const HeightRange& inherited) noexcept {
  const HeightRange both{std::max(own.minMeters, inherited.minMeters), std::min(own.maxMeters, inherited.maxMeters)};
  return both.minMeters <= both.maxMeters ? both : own;
}

double errorMetersOf(const SelectionBody& body, int level) {
  const auto& errors = body.geometricErrorMeters;
  return errors.empty() ? 0.0 : errors[std::min(static_cast<std::size_t>(level), errors.size() - 1)];
}

/// The wanted tree is grown level by level; the drawn tree is then cut out of it: it can only be coarser, for it
/// refines under the same conditions and one more.
class Selector {
 public:
  Selector(const Camera& camera, const SelectionBody& body, const ResidentLookup& resident,
           const SelectionSettings& settings)
      : camera_(camera),
        body_(body),
        resident_(resident),
        settings_(settings),
        frustum_(camera),
        horizon_(camera.positionBody, body.radiusMeters, camera.altitudeMeters, body.occluderRadiusMeters) {}

  TileSelection run() {
    // A tile that must be refined makes its coarser neighbours refine first. Each round adds to the forced tiles, and a
    // level forces only the one above it, so there are no more rounds than levels.
    do {
      startOver();
    } while (!growWantedTree());
    markNeeded();
    cutDrawnTree();
    return result();
  }

 private:
  /// By the order of tilesAround.
  using Neighbours = std::array<int, TileList::kMost>;

  void addRoot(int face) {
    Node node;
    node.path = FacePath::wholeFace(body_.scheme, face);
    node.subtreeHeights = node.ownHeights = body_.heights;
    addNode(node);
  }

  void addChild(int parentIndex, int digit) {
    const Node& parent = at(parentIndex);
    Node node;
    node.path = parent.path.child(digit);
    node.parent = parentIndex;
    node.subtreeHeights = parent.subtreeHeights;
    node.ownHeights = parent.ownHeights;
    node.guesses = parent.guesses;
    addNode(node);
  }

  void addNode(Node node) {
    const ResidentTile* tile = resident_ ? resident_(node.path) : nullptr;
    if (tile != nullptr) {
      node.known = true;
      node.guesses = 0;
      node.drawable = tile->drawable;
      node.subtreeHeights = intersection(tile->subtreeHeights, node.subtreeHeights);
      node.ownHeights = tile->ownHeights.value_or(node.subtreeHeights);
    }
    if (!node.known) ++node.guesses;
    // The first unknown tile below a known one decides what may be drawn. Those below it are only asked for ahead of
    // time.
    node.visible = mayBeSeen(boundsOf(node.path, node.guesses > 1 ? node.ownHeights : node.subtreeHeights));
    if (node.visible) judge(node, tile);
    visibleCount_ += node.visible ? 1 : 0;
    nodes_.push_back(node);
  }

  void judge(Node& node, const ResidentTile* tile) const {
    const double error = errorMetersOf(body_, node.path.level());
    if (!node.known) {
      // An ancestor's heights span more than this tile's: a camera between them would seem to touch the ground
      // everywhere.
      const double middle = 0.5 * (node.ownHeights.minMeters + node.ownHeights.maxMeters);
      node.errorPixels = screenSpaceErrorPixels(error, boundsOf(node.path, {middle, middle}).box, camera_);
      return;
    }
    const TileBounds own = boundsOf(node.path, node.ownHeights);
    node.errorPixels = screenSpaceErrorPixels(error, own.box, camera_);
    // A tile that has no reason to be refined is seen by its own mesh or not at all.
    if (tile->ownHeights && !wantsChildren(node)) node.visible = mayBeSeen(own) && aQuarterMayBeSeen(node.path, *tile);
  }

  bool aQuarterMayBeSeen(const FacePath& path, const ResidentTile& tile) const {
    if (!tile.quarterHeights || path.level() >= FacePath::kMaxLevel) return true;
    for (int digit = 0; digit < 4; ++digit) {
      const HeightRange& heights = (*tile.quarterHeights)[static_cast<std::size_t>(digit)];
      if (mayBeSeen(tileQuarterBounds(path, digit, body_.radiusMeters, heights, body_.occluderRadiusMeters)))
        return true;
    }
    return false;
  }

  bool wantsChildren(const Node& node) const {
    return node.path.level() < body_.maxLevel &&
           ((node.errorPixels > settings_.errorPixels && node.guesses <= kMostGuesses) ||
            (!forced_.empty() && forced_.contains(node.path)));
  }

  void startOver() {
    nodes_.clear();
    neighbours_.clear();
    levelStart_.clear();
    currentLevel_.clear();
    previousLevel_.clear();
    visibleCount_ = 0;
  }

  TileBounds boundsOf(const FacePath& path, const HeightRange& heights) const {
    return tileBounds(path, body_.radiusMeters, heights, body_.occluderRadiusMeters);
  }

  bool mayBeSeen(const TileBounds& bounds) const {
    return (!settings_.horizonCulling || !horizon_.hides(bounds.horizonPoint)) &&
           (!settings_.frustumCulling || frustum_.mayContain(bounds.hull));
  }

  /// False if tiles were forced that this round had already passed: then it must be done again.
  bool growWantedTree() {
    const std::size_t forcedBefore = forced_.size();
    for (int face = 0; face < faceCount(body_.scheme); ++face) addRoot(face);
    levelStart_ = {0, static_cast<int>(nodes_.size())};
    for (int level = 0; level < body_.maxLevel && levelStart_[level] < levelStart_[level + 1]; ++level) {
      indexLevel(level);
      for (const int index : candidates(level)) {
        if (visibleCount_ + 4 > settings_.maxTiles) break;
        const Neighbours around = neighbours(index);
        if (std::any_of(around.begin(), around.end(), [](int n) { return n == kCoarser; })) {
          forceCoarserNeighbours(index, around);
        } else {
          refine(index, around);
        }
      }
      levelStart_.push_back(static_cast<int>(nodes_.size()));
    }
    return forced_.size() == forcedBefore;
  }

  void forceCoarserNeighbours(int index, const Neighbours& around) {
    const TileList tiles = tilesAround(at(index).path);
    for (std::size_t i = 0; i < tiles.tiles().size(); ++i)
      if (around[i] == kCoarser) forced_.insert(tiles.tiles()[i].parent());
  }

  /// Tiles of a level whose error is too large. Worst first, so that the bound on the work cuts where it shows least.
  std::vector<int> candidates(int level) const {
    std::vector<int> wanted;
    for (int i = levelStart_[level]; i < levelStart_[level + 1]; ++i)
      if (at(i).visible && wantsChildren(at(i))) wanted.push_back(i);
    std::stable_sort(wanted.begin(), wanted.end(), [&](int a, int b) { return at(a).errorPixels > at(b).errorPixels; });
    return wanted;
  }

  void refine(int index, const Neighbours& around) {
    node(index).firstNeighbour = static_cast<int>(neighbours_.size());
    neighbours_.insert(neighbours_.end(), around.begin(), around.end());
    node(index).firstChild = static_cast<int>(nodes_.size());
    for (int digit = 0; digit < 4; ++digit) addChild(index, digit);
  }

  void indexLevel(int level) {
    previousLevel_.swap(currentLevel_);
    currentLevel_.clear();
    for (int i = levelStart_[level]; i < levelStart_[level + 1]; ++i) currentLevel_.emplace(at(i).path, i);
  }

  /// The nodes around a node: an index, kCoarser if a coarser tile of the wanted tree lies there, or kNone where
  /// nothing does (where a culled tile was not looked into, and at the end of the list).
  Neighbours neighbours(int index) const {
    Neighbours around;
    around.fill(kNone);
    const TileList tiles = tilesAround(at(index).path);
    for (std::size_t i = 0; i < tiles.tiles().size(); ++i) {
      const FacePath& path = tiles.tiles()[i];
      if (const auto same = currentLevel_.find(path); same != currentLevel_.end()) {
        around[i] = same->second;
      } else if (path.level() > 0) {
        // One level up is as coarse as it can be: the tree is balanced so far.
        const auto above = previousLevel_.find(path.parent());
        if (above != previousLevel_.end() && at(above->second).visible) around[i] = kCoarser;
      }
    }
    return around;
  }

  /// A known tile whose children are all out of view need not be there. (Of an unknown one's children there are only
  /// guesses.)
  void markNeeded() {
    for (auto tile = nodes_.rbegin(); tile != nodes_.rend(); ++tile) {
      tile->needed = tile->visible;
      if (!tile->visible || !tile->known || tile->firstChild == kNone) continue;
      tile->needed = false;
      for (int i = tile->firstChild; i < tile->firstChild + 4; ++i) tile->needed = tile->needed || at(i).needed;
    }
  }

  void cutDrawnTree() {
    for (int i = 0; i < levelStart_[1]; ++i) {
      node(i).drawn = at(i).needed && at(i).drawable;
      rootsMissing_ = rootsMissing_ || isMissingRoot(at(i));
    }
    // Nodes are in order of level, so all of a level is decided before the next.
    for (Node& parent : nodes_) {
      if (!parent.drawn || parent.firstChild == kNone || !mayRefineDrawn(parent)) continue;
      parent.drawnRefined = true;
      for (int i = parent.firstChild; i < parent.firstChild + 4; ++i) node(i).drawn = at(i).needed;
    }
  }

  bool mayRefineDrawn(const Node& parent) const {
    for (int i = parent.firstChild; i < parent.firstChild + 4; ++i)
      if (at(i).needed && !at(i).drawable) return false;
    for (int i = parent.firstNeighbour; i < parent.firstNeighbour + static_cast<int>(TileList::kMost); ++i) {
      const int index = neighbours_[static_cast<std::size_t>(i)];
      if (index == kNone) continue;
      const Node& neighbour = at(index);
      // A face whose root is missing holds the others back too, or all would fall back to the coarsest levels when it
      // comes.
      if (neighbour.parent == kNone ? isMissingRoot(neighbour) : isDrawnLeaf(at(neighbour.parent))) return false;
    }
    return true;
  }

  static bool isDrawnLeaf(const Node& tile) { return tile.drawn && !tile.drawnRefined; }
  static bool isMissingRoot(const Node& tile) { return tile.needed && !tile.drawable; }

  TileSelection result() const {
    TileSelection selection;
    selection.rootsMissing = rootsMissing_;
    selection.complete = !rootsMissing_;
    for (const Node& tile : nodes_) {
      if (!tile.needed) continue;
      const bool wantedLeaf = tile.firstChild == kNone;
      selection.wanted.push_back(WantedTile{tile.path, tile.errorPixels, wantedLeaf});
      if (isDrawnLeaf(tile)) selection.draw.push_back(tile.path);
      if (isDrawnLeaf(tile) != wantedLeaf) selection.complete = false;
    }
    std::stable_sort(selection.wanted.begin(), selection.wanted.end(), [](const WantedTile& a, const WantedTile& b) {
      if (a.path.level() != b.path.level()) return a.path.level() < b.path.level();
      return a.screenErrorPixels > b.screenErrorPixels;
    });
    return selection;
  }

  static constexpr int kCoarser = -2;

  Node& node(int index) { return nodes_[static_cast<std::size_t>(index)]; }
  const Node& at(int index) const { return nodes_[static_cast<std::size_t>(index)]; }

  const Camera& camera_;
  const SelectionBody& body_;
  const ResidentLookup& resident_;
  const SelectionSettings& settings_;
  Frustum frustum_;
  Horizon horizon_;
  std::vector<Node> nodes_;
  std::vector<int> neighbours_;
  std::vector<int> levelStart_;  ///< levelStart_[l] .. levelStart_[l + 1]: the nodes of level l
  std::unordered_map<FacePath, int> currentLevel_, previousLevel_;
  std::unordered_set<FacePath> forced_;  ///< refined only so that a finer neighbour may be
  int visibleCount_ = 0;
  bool rootsMissing_ = false;
};

/// What bounds the ground of a tile, by what is known.
HeightRange knownHeights(const FacePath& path, const SelectionBody& body, const ResidentLookup& resident) {
  if (const ResidentTile* tile = resident(path)) return tile->ownHeights.value_or(tile->subtreeHeights);
  for (int level = path.level() - 1; level >= 0; --level) {
    const ResidentTile* above = resident(path.ancestor(level));
    if (above == nullptr) continue;
    if (level + 1 < path.level() || !above->quarterHeights) return above->subtreeHeights;
    // Where the tile is missing, its parent's mesh is what would be seen there, give or take what the edges of the
    // tiles around are finer.
    const double error = errorMetersOf(body, level);
    const HeightRange& quarter = (*above->quarterHeights)[static_cast<std::size_t>(path.digit(level))];
    return {quarter.minMeters - error, quarter.maxMeters + error};
  }
  return body.heights;
}

}  // namespace

TileSelection selectTiles(const Camera& camera, const SelectionBody& body, const ResidentLookup& resident,
                          const SelectionSettings& settings) {
  const glm::dvec3& p = camera.positionBody;
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return {};
  if (!std::isfinite(pixelsPerRadian(camera))) return {};  // no order among errors that are NaN
  return Selector(camera, body, resident, settings).run();
}

bool tileMayBeSeen(const FacePath& path, const Camera& camera, const SelectionBody& body,
                   const ResidentLookup& resident) {
  const HeightRange heights = knownHeights(path, body, resident);
  const TileBounds bounds = tileBounds(path, body.radiusMeters, heights, body.occluderRadiusMeters);
  return Frustum(camera).mayContain(bounds.hull) &&
         !Horizon(camera.positionBody, body.radiusMeters, camera.altitudeMeters, body.occluderRadiusMeters)
              .hides(bounds.horizonPoint);
}

double tileErrorPixels(const FacePath& path, const Camera& camera, const SelectionBody& body,
                       const ResidentLookup& resident) {
  const TileBounds bounds =
      tileBounds(path, body.radiusMeters, knownHeights(path, body, resident), body.occluderRadiusMeters);
  return screenSpaceErrorPixels(errorMetersOf(body, path.level()), bounds.box, camera);
}

}  // namespace terrane
