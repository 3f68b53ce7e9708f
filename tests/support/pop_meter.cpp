#include "tests/support/pop_meter.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <unordered_set>

#include "common/view/level_transitions.h"
#include "proto/resident_tile.h"
#include "tests/support/require.h"

namespace terrane {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
/// Where the demo goes down; the sun stands low enough for relief to show.
constexpr double kLongitude = -16.4018 * kDegree, kLatitude = 21.6039 * kDegree;
constexpr double kErrorPixels = 2;
constexpr int kStrongDifference = 8;  // of 255

/// A straight part of the walk, 12 s each.
struct Leg {
  double headingDegrees, walkMeters, heightMeters, pitchDegrees;  ///< height and pitch at its beginning
};
constexpr double kLegSeconds = 12;
constexpr std::array<Leg, 6> kLegs{{{20, 60, 2, -12},
                                    {55, 60, 2, -8},
                                    {10, 60, 1.5, -20},
                                    {-40, 60, 2, -12},
                                    {-60, 40, 0.6, -25},
                                    {-30, 0, 0.2, -20}}};

Flight walk(double radiusMeters) {
  Flight flight;
  flight.aboveGround = true;
  double longitude = kLongitude, latitude = kLatitude, seconds = 0;
  for (const Leg& leg : kLegs) {
    const double heading = leg.headingDegrees * kDegree;
    flight.points.push_back({seconds, {longitude, latitude, leg.heightMeters, heading, leg.pitchDegrees * kDegree}});
    longitude += leg.walkMeters * std::sin(heading) / (radiusMeters * std::cos(latitude));
    latitude += leg.walkMeters * std::cos(heading) / radiusMeters;
    seconds += kLegSeconds;
  }
  return flight;
}

Flight flightOf(PopFlight flight, double radiusMeters) {
  return flight == PopFlight::Walk ? walk(radiusMeters)
                                   : require(builtInFlight("descent", kLongitude, kLatitude, radiusMeters));
}

/// Tiles that have nothing in common with a set.
class Cover {
 public:
  explicit Cover(const std::vector<DrawnTile>& tiles) {
    for (const DrawnTile& tile : tiles) {
      tiles_.insert(tile.path);
      for (int level = 0; level < tile.path.level(); ++level) above_.insert(tile.path.ancestor(level));
    }
  }
  bool overlaps(const FacePath& path) const {
    if (above_.contains(path)) return true;
    for (int level = 0; level <= path.level(); ++level)
      if (tiles_.contains(path.ancestor(level))) return true;
    return false;
  }

 private:
  std::unordered_set<FacePath> tiles_, above_;
};

/// tiles, and those of others where it has nothing.
std::vector<DrawnTile> completed(const std::vector<DrawnTile>& tiles, const std::vector<DrawnTile>& others) {
  const Cover cover(tiles);
  std::vector<DrawnTile> both = tiles;
  for (const DrawnTile& other : others)
    if (!cover.overlaps(other.path)) both.push_back(other);
  std::ranges::sort(both, {}, &DrawnTile::path);
  return both;
}

double strongPerMillion(const Image& a, const Image& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.rgb[i + c] - b.rgb[i + c]));
    count += most > kStrongDifference ? 1u : 0u;
  }
  return 3e6 * static_cast<double>(count) / static_cast<double>(a.rgb.size());
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

std::string_view popFlightName(PopFlight flight) noexcept {
  return flight == PopFlight::Walk ? "ground walk" : "descent";
}

PopMeter::PopMeter(TileSource& moon, PopFlight flight, Transition transition, int widthPixels, int heightPixels)
    : moon_(moon),
      flight_(flightOf(flight, moon.selection().radiusMeters)),
      widthPixels_(widthPixels),
      heightPixels_(heightPixels),
      renderer_(
          require(TileRenderer::create(shippedScene("moon").effects, {.bodyRadiusMeters = moon.selection().radiusMeters,
                                                                      .bodyScheme = moon.selection().scheme}))),
      target_(require(RenderTarget::create(widthPixels, heightPixels))) {
  settings_.transition = transition;
}

Camera PopMeter::cameraAt(int frame) const {
  return moon_.cameraAboveGround(poseAt(flight_, frame * kPopFrameSeconds), widthPixels_, heightPixels_);
}

void PopMeter::load(const FacePath& path) {
  if (isThere(path)) return;
  const auto tile = moon_.tile(path);
  renderer_->upload(tile);
  resident_.emplace(path, residentTile(*tile, moon_.selection().radiusMeters));
}

ResidentLookup PopMeter::lookup() const {
  return [this](const FacePath& path) -> const ResidentTile* {
    const auto found = resident_.find(path);
    return found == resident_.end() ? nullptr : &found->second;
  };
}

TileSelection PopMeter::select(const Camera& camera) const {
  return selectTiles(camera, moon_.selection(), lookup(), {.errorPixels = kErrorPixels});
}

/// As a viewer that has stood still for a moment: what lies beside the picture is there as well, for a turn to find.
void PopMeter::settle(const Camera& camera) {
  for (int face = 0; face < faceCount(moon_.selection().scheme); ++face)
    load(FacePath::wholeFace(moon_.selection().scheme, face));
  for (const Camera& from : {camera, widened(camera, kShareAhead)})
    for (TileSelection selection = select(from); !selection.complete; selection = select(from))
      for (const WantedTile& wanted : selection.wanted) load(wanted.path);
}

Image PopMeter::picture(const Camera& camera, const std::vector<DrawnTile>& tiles) {
  target_.bind();
  renderer_->draw(camera, tiles, settings_);
  Image image = readFramebuffer(widthPixels_, heightPixels_);
  RenderTarget::bindWindow();
  return image;
}

/// Tiles that entered the view were not in the picture before, and those that left it are not after: both are compared
/// as if they were there, so that what is measured is what changed for those that are in both.
void PopMeter::compare(const Camera& camera, const std::vector<DrawnTile>& before,
                       const std::vector<DrawnTile>& after) {
  const std::vector<DrawnTile> wholeBefore = completed(before, after), wholeAfter = completed(after, before);
  if (wholeBefore == wholeAfter) return;
  const Image first = picture(camera, wholeBefore), second = picture(camera, wholeAfter);
  ++pops_.changes;
  rms_.push_back(rmsDifference(first, second));
  pops_.worstRms = std::max(pops_.worstRms, rms_.back());
  pops_.worstPerMillion = std::max(pops_.worstPerMillion, strongPerMillion(first, second));
}

/// A few of the tiles that are missing: what is in the picture before what lies beside it, as the viewer asks.
void PopMeter::loadLate(const Camera& camera, const TileSelection& selection) {
  int arriving = popTilesPerFrame(moon_.selection().scheme);
  for (const auto& wanted : {selection.wanted, select(widened(camera, kShareAhead)).wanted})
    for (const WantedTile& tile : wanted) {
      if (isThere(tile.path)) continue;
      if (arriving-- == 0) return;
      load(tile.path);
    }
}

Pops PopMeter::fly(int frames, const std::function<void(const Moment&)>& eachFrame) {
  const int firstFrame = (kPopFlightFrames - frames) / 2;
  LevelTransitions transitions({.morph = settings_.transition != Transition::None});
  const auto canMorph = [this](const FacePath& path) {
    return path.level() > 0 && isThere(path) && isThere(path.parent());
  };
  settle(cameraAt(firstFrame));
  pops_ = {};
  rms_.clear();
  Moment now;
  for (int frame = 0; frame < frames; ++frame) {
    now.camera = cameraAt(firstFrame + frame);
    const TileSelection selection = select(now.camera);
    now.wanted = selection.draw;
    const auto mayBeSeen = [&](const FacePath& path) {
      return tileMayBeSeen(path, now.camera, moon_.selection(), lookup());
    };
    // All changes of the set happen in no time; then the morphs go on.
    const std::vector<DrawnTile> changed = transitions.advance(selection.draw, 0, canMorph, mayBeSeen);
    if (frame > 0 && changed != now.drawn) compare(now.camera, now.drawn, changed);
    now.drawn = transitions.advance(selection.draw, kPopFrameSeconds, canMorph, mayBeSeen);
    pops_.uncovered +=
        renderer_->countCoverage(now.camera, now.drawn, settings_, moon_.selection().occluderRadiusMeters).uncovered;
    pops_.tiles += now.drawn.size();
    if (eachFrame) eachFrame(now);
    loadLate(now.camera, selection);
  }
  pops_.hurried = transitions.counts().hurried;
  pops_.jumps = transitions.counts().jumps;
  pops_.frames = frames;
  pops_.medianRms = medianOf(rms_);
  return pops_;
}

DrawStats PopMeter::draw(const Moment& moment, Transition transition) {
  target_.bind();
  const DrawSettings settings{.transition = transition};
  const DrawStats stats = transition == Transition::None ? renderer_->draw(moment.camera, moment.wanted, settings)
                                                         : renderer_->draw(moment.camera, moment.drawn, settings);
  glFinish();
  RenderTarget::bindWindow();
  return stats;
}

}  // namespace terrane
