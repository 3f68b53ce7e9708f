#include "client/app/body_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/controls/camera_controls.h"
#include "common/tiling/tile_at.h"
#include "common/view/level_of_detail.h"

namespace terrane {
namespace {

constexpr int kLevelsAheadOfGround = 2;

}  // namespace

double BodyView::highestRadiusMeters() const {
  return info().selection.radiusMeters + std::max(0.0, info().selection.heights.maxMeters);
}

ResidentLookup BodyView::lookup() const {
  return [this](const FacePath& path) { return stream_.known(path, index_); };
}

void BodyView::changeLevelsOverTime(bool wanted) {
  if (wanted != std::exchange(overTime_, wanted)) transitions_ = LevelTransitions({.morph = wanted});
}

bool BodyView::choose(const Camera& from, double allowedPixels, double seconds) {
  wantedLower_.clear();
  return select(from, allowedPixels, seconds);
}

bool BodyView::chooseHigher(const Camera& from, double allowedPixels) {
  wantedLower_.insert(wantedLower_.end(), selection_.wanted.begin(), selection_.wanted.end());
  return select(from, allowedPixels, 0);
}

bool BodyView::select(const Camera& from, double allowedPixels, double seconds) {
  hidden_ = false;
  SelectionSettings settings;
  settings.errorPixels = allowedPixels;
  const ResidentLookup known = lookup();
  selection_ = selectTiles(from, info().selection, known, settings);
  std::vector<DrawnTile> next = transitions_.advance(
      selection_.draw, seconds,
      [this](const FacePath& path) {
        return path.level() > 0 && stream_.resident(path, index_) != nullptr &&
               stream_.resident(path.parent(), index_) != nullptr;
      },
      [&](const FacePath& path) { return tileMayBeSeen(path, from, info().selection, known); });
  const bool changed = next != drawn_;
  drawn_ = std::move(next);
  return changed || !transitions_.settled();
}

bool BodyView::hide() {
  hidden_ = true;
  selection_ = {};
  wantedLower_.clear();
  selection_.complete = true;
  transitions_ = LevelTransitions({.morph = overTime_});
  transitions_.advance(
      {}, 0, [](const FacePath&) { return false; }, [](const FacePath&) { return false; });
  return !std::exchange(drawn_, {}).empty();
}

std::optional<TileStream::Ground> BodyView::groundBelow(const ViewPose& pose) const {
  return stream_.groundBelow(directionOf(pose.longitude, pose.latitude), index_);
}

double BodyView::altitudeAboveDrawn(const ViewPose& viewed) const {
  const auto ground = groundBelow(viewed);
  const auto surface = stream_.drawnHeightBelow(directionOf(viewed.longitude, viewed.latitude), drawn_, index_);
  // A camera under the ground was asked for.
  if (!ground || !surface || viewed.altitudeMeters <= ground->heightMeters) return viewed.altitudeMeters;
  return std::max(viewed.altitudeMeters, *surface + 0.5 * (viewed.altitudeMeters - ground->heightMeters));
}

// The tiles under the camera, down to the level that its height calls for, whether it looks there or not: the ground's
// height comes from them.
std::vector<WantedTile> BodyView::groundChain(const Camera& from, const ViewPose& pose, double allowedPixels) const {
  const SelectionBody& body = info().selection;
  const glm::dvec3 direction = directionOf(pose.longitude, pose.latitude);
  const auto ground = groundBelow(pose);
  const double height =
      std::max(pose.altitudeMeters - (ground ? ground->heightMeters : 0.0), kLowestHeightAboveGroundMeters);
  const double allowedMeters = allowedPixels * height / pixelsPerRadian(from);
  std::vector<WantedTile> chain;
  for (int level = 0; level <= body.maxLevel; ++level) {
    const double error = body.geometricErrorMeters[static_cast<std::size_t>(level)];
    const bool last = error <= allowedMeters || level == body.maxLevel;
    chain.push_back({tileAt(body.scheme, direction, level), error * pixelsPerRadian(from) / height, last});
    if (last) break;
  }
  return chain;
}

bool BodyView::request(const Camera& from, double allowedPixels, const std::optional<GroundCall>& ground, bool ahead) {
  std::vector<WantedTile> wanted = selection_.wanted;
  std::unordered_set<FacePath> named;
  named.reserve(wanted.size() * 2);
  for (const WantedTile& tile : wanted) named.insert(tile.path);
  const auto add = [&](const std::vector<WantedTile>& more) {
    for (const WantedTile& tile : more)
      if (named.insert(tile.path).second) wanted.push_back(tile);
  };
  add(wantedLower_);
  std::vector<WantedTile> chain;
  if (ground) chain = groundChain(from, ground->pose, allowedPixels);
  const bool groundKnown = !ground || stream_.resident(chain.back().path, index_) != nullptr;
  if (ground && ground->first && !groundKnown) {
    const auto known = groundBelow(ground->pose);
    const int finest = (known ? known->level : 0) + kLevelsAheadOfGround;
    std::erase_if(wanted,
                  [&](const WantedTile& tile) { return tile.path.level() > finest && named.erase(tile.path) != 0; });
  }
  add(chain);
  std::stable_sort(wanted.begin(), wanted.end(),
                   [](const WantedTile& a, const WantedTile& b) { return a.path.level() < b.path.level(); });
  wantedCount_ = wanted.size();
  missing_ = static_cast<std::size_t>(std::count_if(wanted.begin(), wanted.end(), [&](const WantedTile& tile) {
    return stream_.resident(tile.path, index_) == nullptr;
  }));
  if (ahead && !hidden_ && (groundKnown || !ground->first)) addBesidePicture(from, allowedPixels, named, wanted);
  stream_.want(wanted, index_, ViewOfTiles{from, allowedPixels});
  return groundKnown;
}

void BodyView::addBesidePicture(const Camera& from, double allowedPixels, std::unordered_set<FacePath>& known,
                                std::vector<WantedTile>& wanted) const {
  const SelectionSettings settings{.errorPixels = allowedPixels};
  const TileSelection wide = selectTiles(widened(from, kShareAhead), info().selection, lookup(), settings);
  for (WantedTile tile : wide.wanted) {
    tile.beside = true;
    if (known.insert(tile.path).second) wanted.push_back(tile);
  }
}

std::vector<FacePath> BodyView::drawnPaths() const {
  std::vector<FacePath> paths;
  paths.reserve(drawn_.size());
  for (const DrawnTile& tile : drawn_) paths.push_back(tile.path);
  return paths;
}

BodyPicture BodyView::picture(const Camera& from) const {
  const SelectionBody& body = info().selection;
  return {index_, from, drawn_, body.radiusMeters, highestRadiusMeters(), body.occluderRadiusMeters, body.scheme};
}

}  // namespace terrane
