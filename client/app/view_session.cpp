#include "client/app/view_session.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "client/controls/camera_controls.h"
#include "common/command_line.h"
#include "common/tiling/tile_at.h"
#include "common/view/level_of_detail.h"
#include "common/view/level_transitions.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;

// Small enough that one batch does not overrun a frame's time by much.
constexpr std::size_t kUploadBatchBytes = 512u << 10;
constexpr int kLevelsAheadOfGround = 2;
/// From higher up other tiles are wanted. That begins to change what is drawn and not where its surface is, so once is
/// enough, but for a tile that comes into view under the camera.
constexpr int kMostRises = 3;

/// Decoding many tiles leaves tens of megabytes free in the heap; nobody needs them while the view stands still.
void returnFreedMemory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

void warn(const std::string& text) { complain("terrane-view", "warning: " + text); }

}  // namespace

struct ViewSession::State {
  ViewOptions options;
  std::unique_ptr<TileStream> stream;
  std::unique_ptr<TileRenderer> renderer;
  Camera camera;
  ViewPose pose;
  TileSelection selection;
  LevelTransitions transitions;
  bool overTime = true;  ///< what transitions was made for
  std::vector<DrawnTile> drawn;
  std::size_t missing = 0, wantedCount = 0;
  bool firstUpdate = true, wasSettled = false;
  std::unordered_map<FacePath, TilePtr> kept;  ///< only to explain: otherwise a mesh is dropped once it is on the GPU

  const SceneInfo* checkedScene = nullptr;
  std::unordered_set<std::string> namedEffects;

  void nameUnknownEffects();
  bool takeArrivals(const UploadBudget& budget);
  ViewPose resolved(const View& view) const;
  double altitudeAboveDrawn(const ViewPose& viewed) const;
  std::vector<WantedTile> groundChain(double allowedPixels) const;
  bool requestTiles(double allowedPixels, const std::vector<WantedTile>& lower, bool groundFirst, bool ahead);
  void addBesidePicture(double allowedPixels, std::unordered_set<FacePath>& known,
                        std::vector<WantedTile>& wanted) const;
  void changeLevelsOverTime(bool wanted);
  bool chooseTiles(const Camera& from, double allowedPixels, double seconds);
};

ViewSession::ViewSession(std::unique_ptr<State> state) : state_(std::move(state)) {}
ViewSession::~ViewSession() = default;

Result<std::unique_ptr<ViewSession>> ViewSession::open(const ViewOptions& options, std::function<void()> wake) {
  StreamOptions streamOptions;
  streamOptions.serverUrl = options.serverUrl;
  streamOptions.residentBudgetBytes = options.memoryBudgetBytes;
  streamOptions.cacheFile = options.cacheFile;
  streamOptions.cacheBudgetBytes = options.cacheBudgetBytes;
  streamOptions.network = options.network;
  streamOptions.decodeThreads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 4u));
  auto stream = TileStream::open(streamOptions, wake);
  if (!stream && !options.cacheFile.empty() && stream.error().field == options.cacheFile) {
    if (!options.cacheIsDefault) return makeError(stream.error().kind, "--cache", stream.error().text());
    warn(stream.error().text() + "; going on without a disk cache");
    streamOptions.cacheFile.clear();
    stream = TileStream::open(std::move(streamOptions), std::move(wake));
  }
  if (!stream) return stream.error();
  auto state = std::make_unique<State>();
  state->options = options;
  state->stream = std::move(*stream);
  auto session = std::unique_ptr<ViewSession>(new ViewSession(std::move(state)));
  session->errorPixels = options.errorPixels;
  return session;
}

Result<bool> ViewSession::ready() {
  State& s = *state_;
  const SceneInfo* scene = s.stream->scene();
  if (scene == nullptr) return false;
  if (s.renderer) return true;
  s.nameUnknownEffects();
  if (scene->bodies.empty()) return makeError(ErrorKind::Unsupported, "--server", "its scene has no body");
  const auto found = std::find_if(scene->bodies.begin(), scene->bodies.end(),
                                  [&](const BodyInfo& body) { return body.name == s.options.body; });
  if (!s.options.body.empty() && found == scene->bodies.end()) {
    std::string names;
    for (const BodyInfo& body : scene->bodies) names += (names.empty() ? "" : ", ") + body.name;
    return makeError(ErrorKind::InvalidArgument, "--body",
                     fmt::format("the scene \"{}\" has no \"{}\": it has {}", scene->name, s.options.body, names));
  }
  const std::size_t body = s.options.body.empty() ? 0 : static_cast<std::size_t>(found - scene->bodies.begin());
  const SelectionBody& viewed = scene->bodies[body].selection;
  auto renderer =
      TileRenderer::create(effects(), {.bodyRadiusMeters = viewed.radiusMeters, .bodyScheme = viewed.scheme});
  if (!renderer) return renderer.error();
  s.renderer = std::move(*renderer);
  s.stream->selectBody(body);
  drawSettings.placement = s.options.placement.value_or(s.renderer->selfTest().chosen);
  drawSettings.transition = s.options.transition;
  drawSettings.samples = s.options.samples.value_or(s.renderer->samplesByDefault());
  return true;
}

const SceneInfo& ViewSession::scene() const { return *state_->stream->scene(); }
const BodyInfo& ViewSession::body() const { return *state_->stream->body(); }

std::vector<EffectCall> ViewSession::effects() const {
  std::vector<EffectCall> calls = scene().effects;
  const std::vector<EffectKind>& without = state_->options.without;
  std::erase_if(calls, [&](const EffectCall& call) { return std::ranges::find(without, call.kind) != without.end(); });
  return calls;
}

// Once for each effect, whichever scene names it.
void ViewSession::State::nameUnknownEffects() {
  const SceneInfo* scene = stream->scene();
  if (scene == std::exchange(checkedScene, scene)) return;
  for (const std::string& name : scene->unknownEffects)
    if (namedEffects.insert(name).second)
      warn("the scene has the effect " + quotedForMessage(name) +
           ", which this viewer does not know: going on without");
}

// Uploads what is decoded until the frame's share of bytes or time is used up.
bool ViewSession::State::takeArrivals(const UploadBudget& budget) {
  const auto start = Clock::now();
  std::size_t bytes = 0;
  bool any = false;
  while (bytes < budget.bytes) {
    const std::vector<TilePtr> arrived = stream->takeDecoded(std::min(kUploadBatchBytes, budget.bytes - bytes));
    if (arrived.empty()) break;
    for (const TilePtr& tile : arrived) {
      const std::size_t gpuBytes = renderer->upload(tile);
      stream->markResident(tile, gpuBytes);
      if (options.explain) kept.insert_or_assign(tile->metadata.path, tile);
      bytes += std::max<std::size_t>(gpuBytes, 1);
    }
    any = true;
    if (std::chrono::duration<double, std::milli>(Clock::now() - start).count() > budget.milliseconds) break;
  }
  return any;
}

ViewPose ViewSession::State::resolved(const View& view) const {
  ViewPose result = view.pose;
  if (!view.aboveGround) return result;
  if (const auto ground = stream->groundBelow(directionOf(result.longitude, result.latitude)))
    result.altitudeMeters += ground->heightMeters;
  return result;
}

// Under the drawn ground there is nothing to see. It may be higher than the finest ground that is known, from which
// poses count, as long as it is coarse: a fine tile has come and has not grown in yet. Then the camera stays above it
// by half its height above that ground, and sinks as the drawn ground does.
double ViewSession::State::altitudeAboveDrawn(const ViewPose& viewed) const {
  const glm::dvec3 direction = directionOf(viewed.longitude, viewed.latitude);
  const auto ground = stream->groundBelow(direction);
  const auto surface = stream->drawnHeightBelow(direction, drawn);
  // A camera under the ground was asked for.
  if (!ground || !surface || viewed.altitudeMeters <= ground->heightMeters) return viewed.altitudeMeters;
  return std::max(viewed.altitudeMeters, *surface + 0.5 * (viewed.altitudeMeters - ground->heightMeters));
}

// The tiles under the camera, down to the level that its height calls for, whether it looks there or not: the ground's
// height comes from them.
std::vector<WantedTile> ViewSession::State::groundChain(double allowedPixels) const {
  const SelectionBody& body = stream->body()->selection;
  const glm::dvec3 direction = directionOf(pose.longitude, pose.latitude);
  const auto ground = stream->groundBelow(direction);
  const double height =
      std::max(pose.altitudeMeters - (ground ? ground->heightMeters : 0.0), kLowestHeightAboveGroundMeters);
  const double allowedMeters = allowedPixels * height / pixelsPerRadian(camera);
  std::vector<WantedTile> chain;
  for (int level = 0; level <= body.maxLevel; ++level) {
    const double error = body.geometricErrorMeters[static_cast<std::size_t>(level)];
    const bool last = error <= allowedMeters || level == body.maxLevel;
    chain.push_back({tileAt(body.scheme, direction, level), error * pixelsPerRadian(camera) / height, last});
    if (last) break;
  }
  return chain;
}

// Asks for the selection and the ground; true when the ground's finest wanted tile is there. groundFirst: the camera's
// own height depends on the ground, so until that is known no fine tile is asked for where the camera only seems to be.
// lower: what is wanted from the heights that the camera was held above. Asked for too, or what keeps the camera up
// would never come.
bool ViewSession::State::requestTiles(double allowedPixels, const std::vector<WantedTile>& lower, bool groundFirst,
                                      bool ahead) {
  std::vector<WantedTile> wanted = selection.wanted;
  const std::vector<WantedTile> chain = groundChain(allowedPixels);
  const bool groundKnown = stream->resident(chain.back().path) != nullptr;
  if (groundFirst && !groundKnown) {
    const auto ground = stream->groundBelow(directionOf(pose.longitude, pose.latitude));
    const int finest = (ground ? ground->level : 0) + kLevelsAheadOfGround;
    std::erase_if(wanted, [&](const WantedTile& tile) { return tile.path.level() > finest; });
  }
  std::unordered_set<FacePath> known;
  known.reserve(wanted.size() * 2);
  for (const WantedTile& tile : wanted) known.insert(tile.path);
  for (const auto* more : {&lower, &chain})
    for (const WantedTile& tile : *more)
      if (known.insert(tile.path).second) wanted.push_back(tile);
  std::stable_sort(wanted.begin(), wanted.end(),
                   [](const WantedTile& a, const WantedTile& b) { return a.path.level() < b.path.level(); });
  wantedCount = wanted.size();
  missing = static_cast<std::size_t>(std::count_if(
      wanted.begin(), wanted.end(), [&](const WantedTile& tile) { return stream->resident(tile.path) == nullptr; }));
  if (ahead && (groundKnown || !groundFirst)) addBesidePicture(allowedPixels, known, wanted);
  stream->want(wanted, ViewOfTiles{camera, allowedPixels});
  return groundKnown;
}

void ViewSession::State::addBesidePicture(double allowedPixels, std::unordered_set<FacePath>& known,
                                          std::vector<WantedTile>& wanted) const {
  const SelectionSettings settings{.errorPixels = allowedPixels};
  const TileSelection wide = selectTiles(
      widened(camera, kShareAhead), stream->body()->selection,
      [this](const FacePath& path) { return stream->known(path); }, settings);
  for (WantedTile tile : wide.wanted) {
    tile.beside = true;
    if (known.insert(tile.path).second) wanted.push_back(tile);
  }
}

void ViewSession::State::changeLevelsOverTime(bool wanted) {
  if (wanted != std::exchange(overTime, wanted)) transitions = LevelTransitions({.morph = wanted});
}

// What is wanted from there, and from what is wanted to what is drawn; true if that is another picture.
bool ViewSession::State::chooseTiles(const Camera& from, double allowedPixels, double seconds) {
  SelectionSettings settings;
  settings.errorPixels = allowedPixels;
  const auto known = [this](const FacePath& path) { return stream->known(path); };
  selection = selectTiles(from, stream->body()->selection, known, settings);
  std::vector<DrawnTile> next = transitions.advance(
      selection.draw, seconds,
      [this](const FacePath& path) {
        return path.level() > 0 && stream->resident(path) != nullptr && stream->resident(path.parent()) != nullptr;
      },
      [&](const FacePath& path) { return tileMayBeSeen(path, from, stream->body()->selection, known); });
  const bool changed = next != drawn;
  drawn = std::move(next);
  return changed || !transitions.settled();
}

UpdateReport ViewSession::update(const View& view, const UploadBudget& budget) {
  State& s = *state_;
  s.nameUnknownEffects();
  const bool arrived = s.takeArrivals(budget);
  const ViewPose viewed = s.resolved(view);
  ViewPose pose = viewed;
  const double altitudeBefore = s.pose.altitudeMeters;
  pose.altitudeMeters = s.altitudeAboveDrawn(viewed);
  const auto cameraOf = [&](const ViewPose& at) {
    return cameraFromPose(at, body().selection.radiusMeters, s.options.verticalFieldOfView, view.widthPixels,
                          view.heightPixels);
  };
  Camera camera = cameraOf(pose);
  bool levelsChanged = false;
  std::vector<WantedTile> lower;
  double altitudeDue = pose.altitudeMeters;  // above what is drawn now, not a frame ago
  if (!frozen) {
    s.changeLevelsOverTime(drawSettings.transition != Transition::None);
    levelsChanged = s.chooseTiles(camera, errorPixels, view.seconds);
    for (int rises = 0; rises < kMostRises; ++rises) {
      altitudeDue = s.altitudeAboveDrawn(viewed);
      if (altitudeDue <= pose.altitudeMeters) break;
      lower.insert(lower.end(), s.selection.wanted.begin(), s.selection.wanted.end());
      pose.altitudeMeters = altitudeDue;
      camera = cameraOf(pose);
      levelsChanged = s.chooseTiles(camera, errorPixels, 0) || levelsChanged;
    }
  }
  const bool moved = s.firstUpdate || camera.positionBody != s.camera.positionBody || camera.right != s.camera.right ||
                     camera.backward != s.camera.backward || camera.widthPixels != s.camera.widthPixels ||
                     camera.heightPixels != s.camera.heightPixels;
  s.camera = camera;
  s.pose = pose;
  s.firstUpdate = false;
  UpdateReport report;
  report.changed = moved || levelsChanged;
  if (!frozen) {
    const bool groundKnown = s.requestTiles(errorPixels, lower, view.aboveGround, view.ahead);
    report.complete = s.selection.complete && (groundKnown || !view.aboveGround);
    const bool still =
        pose.altitudeMeters == altitudeDue && (!view.aboveGround || pose.altitudeMeters == altitudeBefore);
    const bool idle = s.stream->idle();
    report.settled =
        s.selection.complete && s.transitions.settled() && groundKnown && still && !arrived && s.missing == 0 && idle;
    if (report.settled && !std::exchange(s.wasSettled, true)) returnFreedMemory();
    s.wasSettled = report.settled;
    report.stuck = !arrived && s.missing > 0 && idle && s.stream->status().failed > 0;
  }
  std::vector<FacePath> drawn;
  for (const DrawnTile& tile : s.drawn) drawn.push_back(tile.path);
  for (const FacePath& path : s.stream->evict(drawn)) s.renderer->remove(path);
  return report;
}

DrawStats ViewSession::draw() { return state_->renderer->draw(state_->camera, state_->drawn, drawSettings); }

CoverageCount ViewSession::coverage() {
  return state_->renderer->countCoverage(state_->camera, state_->drawn, drawSettings,
                                         body().selection.occluderRadiusMeters);
}

void ViewSession::finish() { glFinish(); }

const ViewPose& ViewSession::pose() const noexcept { return state_->pose; }
const Camera& ViewSession::camera() const noexcept { return state_->camera; }

std::optional<double> ViewSession::groundHeight(const glm::dvec3& directionBody) const {
  const auto ground = state_->stream->groundBelow(directionBody);
  return ground ? std::optional<double>(ground->heightMeters) : std::nullopt;
}

std::optional<double> ViewSession::heightAboveGround() const {
  const auto ground = groundHeight(directionOf(state_->pose.longitude, state_->pose.latitude));
  return ground ? std::optional<double>(state_->pose.altitudeMeters - *ground) : std::nullopt;
}

double ViewSession::progress() const noexcept {
  return state_->wantedCount == 0 ? 0
                                  : 1 - static_cast<double>(state_->missing) / static_cast<double>(state_->wantedCount);
}

std::size_t ViewSession::missing() const noexcept { return state_->missing; }
const std::vector<DrawnTile>& ViewSession::drawn() const noexcept { return state_->drawn; }

StreamStatus ViewSession::streamStatus() const { return state_->stream->status(); }
const SelfTestReport& ViewSession::selfTest() const { return state_->renderer->selfTest(); }
std::size_t ViewSession::gpuBytes() const { return state_->renderer ? state_->renderer->gpuBytes() : 0; }

TilePtr ViewSession::keptTile(const FacePath& path) const {
  const auto found = state_->kept.find(path);
  return found == state_->kept.end() ? nullptr : found->second;
}

ViewPose wholeBodyPose(const SceneInfo& scene, const BodyInfo& body, double verticalFieldOfView, int widthPixels,
                       int heightPixels) {
  // The disc takes 85 % of the picture's shorter side: sin(half its angle) = R / (R + altitude).
  const double shorter = std::min(1.0, static_cast<double>(widthPixels) / heightPixels);
  const double halfAngle = 0.85 * std::atan(std::tan(verticalFieldOfView / 2) * shorter);
  ViewPose pose;
  pose.altitudeMeters = body.selection.radiusMeters * (1 / std::sin(halfAngle) - 1);
  pose.pitch = -std::numbers::pi / 2;
  for (const EffectCall& effect : scene.effects) {
    const auto longitude = effect.parameters.find("longitude"), latitude = effect.parameters.find("latitude");
    if (effect.kind != EffectKind::Sun || longitude == effect.parameters.end() || latitude == effect.parameters.end())
      continue;
    // West of where the sun stands overhead: there it is morning, and low light shows relief.
    pose.longitude = std::remainder(longitude->second - 62 * std::numbers::pi / 180, 2 * std::numbers::pi);
    pose.latitude = latitude->second;
  }
  return pose;
}

std::string selfTestText(const SelfTestReport& report) {
  const auto word = [](bool exact) { return exact ? "exact" : "WRONG"; };
  return fmt::format("integers {}, TwoSum {}, TwoProd {}", word(report.integerExact), word(report.twoSumExact),
                     word(report.twoProdExact));
}

}  // namespace terrane
