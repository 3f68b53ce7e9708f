#include "common/view/tile_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>

#include "common/view/frustum.h"
#include "common/view/horizon.h"
#include "common/view/level_of_detail.h"

namespace terrane {
namespace {

constexpr int kNone = -1;

/// A tile that was looked at. Nodes of one level are contiguous, the four children of one tile too.
struct Node {
  FacePath path;
  HeightRange subtreeHeights;  ///< the tile's if it is resident, else those of the nearest resident ancestor, else the body's
  HeightRange ownHeights;      ///< likewise; for a tile that is not resident no bound, but where its ground will about be
  double errorPixels = 0;
  bool visible = false;
  bool resident = false;
  bool drawn = false;          ///< present in the drawn tree: a leaf of it or above one
  bool drawnRefined = false;
  int firstChild = kNone;      ///< set if the wanted tree refines it
  int firstNeighbour = kNone;  ///< of kSideCount entries in neighbours_, if the wanted tree refines it
};

/// Both heights bound the tile, so their intersection does. Empty only if one of them is wrong: then the tile's own word counts.
HeightRange intersection(const HeightRange& own, const HeightRange& inherited) noexcept {
  const HeightRange both{std::max(own.minMeters, inherited.minMeters), std::min(own.maxMeters, inherited.maxMeters)};
  return both.minMeters <= both.maxMeters ? both : own;
}

/// The wanted tree is grown level by level; the drawn tree is then cut out of it: it can only be coarser, for it refines under the
/// same conditions and one more.
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
    growWantedTree();
    cutDrawnTree();
    return result();
  }

 private:
  void addNode(const FacePath& path, const HeightRange& inheritedSubtree, const HeightRange& inheritedOwn) {
    Node node;
    node.path = path;
    node.subtreeHeights = inheritedSubtree;
    node.ownHeights = inheritedOwn;
    bool ownHeightsKnown = false;
    if (const ResidentTile* tile = resident_ ? resident_(path) : nullptr; tile != nullptr) {
      node.resident = true;
      node.subtreeHeights = intersection(tile->subtreeHeights, inheritedSubtree);
      ownHeightsKnown = tile->ownHeights.has_value();
      node.ownHeights = tile->ownHeights.value_or(node.subtreeHeights);
    }
    node.visible = mayBeSeen(boundsOf(path, node.subtreeHeights));
    if (node.visible) {
      const TileBounds own = boundsOf(path, node.ownHeights);
      node.errorPixels = screenSpaceErrorPixels(errorMeters(path.level()), own.box, camera_);
      // A tile that has no reason to be refined is seen by its own mesh or not at all.
      if (ownHeightsKnown && !(node.errorPixels > settings_.errorPixels && path.level() < body_.maxLevel)) node.visible = mayBeSeen(own);
      visibleCount_ += node.visible ? 1 : 0;
    }
    nodes_.push_back(node);
  }

  TileBounds boundsOf(const FacePath& path, const HeightRange& heights) const {
    return tileBounds(path, body_.radiusMeters, heights, body_.occluderRadiusMeters);
  }

  bool mayBeSeen(const TileBounds& bounds) const {
    return (!settings_.horizonCulling || !horizon_.hides(bounds.horizonPoint)) &&
           (!settings_.frustumCulling || frustum_.mayContain(bounds.hull));
  }

  double errorMeters(int level) const {
    const auto& errors = body_.geometricErrorMeters;
    return errors.empty() ? 0.0 : errors[std::min(static_cast<std::size_t>(level), errors.size() - 1)];
  }

  void growWantedTree() {
    for (int face = 0; face < faceCount(body_.scheme); ++face)
      addNode(FacePath::wholeFace(body_.scheme, face), body_.heights, body_.heights);
    levelStart_ = {0, static_cast<int>(nodes_.size())};
    for (int level = 0; level < body_.maxLevel && levelStart_[level] < levelStart_[level + 1]; ++level) {
      indexLevel(level);
      for (const int index : candidates(level)) {
        if (visibleCount_ + 4 > settings_.maxTiles) break;
        const std::array<int, kSideCount> around = neighbours(index);
        if (std::any_of(around.begin(), around.end(), [](int n) { return n == kCoarser; })) continue;
        refine(index, around);
      }
      levelStart_.push_back(static_cast<int>(nodes_.size()));
    }
  }

  /// Tiles of a level whose error is too large. Worst first, so that the bound on the work cuts where it shows least.
  std::vector<int> candidates(int level) const {
    std::vector<int> wanted;
    for (int i = levelStart_[level]; i < levelStart_[level + 1]; ++i)
      if (at(i).visible && at(i).errorPixels > settings_.errorPixels) wanted.push_back(i);
    std::stable_sort(wanted.begin(), wanted.end(), [&](int a, int b) { return at(a).errorPixels > at(b).errorPixels; });
    return wanted;
  }

  void refine(int index, const std::array<int, kSideCount>& around) {
    node(index).firstNeighbour = static_cast<int>(neighbours_.size());
    neighbours_.insert(neighbours_.end(), around.begin(), around.end());
    node(index).firstChild = static_cast<int>(nodes_.size());
    const Node parent = at(index);
    for (int digit = 0; digit < 4; ++digit) addNode(parent.path.child(digit), parent.subtreeHeights, parent.ownHeights);
  }

  void indexLevel(int level) {
    previousLevel_.swap(currentLevel_);
    currentLevel_.clear();
    for (int i = levelStart_[level]; i < levelStart_[level + 1]; ++i) currentLevel_.emplace(at(i).path, i);
  }

  /// The nodes around a node: an index, kCoarser if a coarser tile of the wanted tree lies there, or kNone where nothing does (beyond a
  /// cube corner, or where a culled tile was not looked into).
  std::array<int, kSideCount> neighbours(int index) const {
    std::array<int, kSideCount> around{};
    for (int side = 0; side < kSideCount; ++side) {
      int& found = around[static_cast<std::size_t>(side)];
      found = kNone;
      const std::optional<FacePath> path = at(index).path.neighbour(static_cast<Side>(side));
      if (!path) continue;
      if (const auto same = currentLevel_.find(*path); same != currentLevel_.end()) {
        found = same->second;
      } else if (path->level() > 0) {
        // One level up is as coarse as it can be: the tree is balanced so far.
        const auto above = previousLevel_.find(path->parent());
        if (above != previousLevel_.end() && at(above->second).visible) found = kCoarser;
      }
    }
    return around;
  }

  void cutDrawnTree() {
    for (int i = 0; i < levelStart_[1]; ++i) {
      node(i).drawn = at(i).visible && at(i).resident;
      rootsMissing_ = rootsMissing_ || (at(i).visible && !at(i).resident);
    }
    // Nodes are in order of level, so all of a level is decided before the next.
    for (Node& parent : nodes_) {
      if (!parent.drawn || parent.firstChild == kNone || !mayRefineDrawn(parent)) continue;
      parent.drawnRefined = true;
      for (int i = parent.firstChild; i < parent.firstChild + 4; ++i) node(i).drawn = at(i).visible;
    }
  }

  bool mayRefineDrawn(const Node& parent) const {
    for (int i = parent.firstChild; i < parent.firstChild + 4; ++i)
      if (at(i).visible && !at(i).resident) return false;
    for (int i = parent.firstNeighbour; i < parent.firstNeighbour + kSideCount; ++i) {
      const int neighbour = neighbours_[static_cast<std::size_t>(i)];
      // Visible but not drawn: a coarser tile stands for it. (A face whose root is missing holds the others back too, or all
      // would fall back to the coarsest levels when it comes.)
      if (neighbour != kNone && at(neighbour).visible && !at(neighbour).drawn) return false;
    }
    return true;
  }

  TileSelection result() const {
    TileSelection selection;
    selection.rootsMissing = rootsMissing_;
    selection.complete = !rootsMissing_;
    for (const Node& tile : nodes_) {
      if (!tile.visible) continue;
      const bool wantedLeaf = tile.firstChild == kNone;
      const bool drawnLeaf = tile.drawn && !tile.drawnRefined;
      selection.wanted.push_back(WantedTile{tile.path, tile.errorPixels, wantedLeaf});
      if (drawnLeaf) selection.draw.push_back(tile.path);
      if (drawnLeaf != wantedLeaf) selection.complete = false;
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
  int visibleCount_ = 0;
  bool rootsMissing_ = false;
};

}  // namespace

TileSelection selectTiles(const Camera& camera, const SelectionBody& body, const ResidentLookup& resident,
                          const SelectionSettings& settings) {
  const glm::dvec3& p = camera.positionBody;
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return {};
  return Selector(camera, body, resident, settings).run();
}

}  // namespace terrane
