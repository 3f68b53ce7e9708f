#include "client/app/view_session.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <glm/geometric.hpp>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "client/app/body_view.h"
#include "client/controls/camera_controls.h"
#include "common/command_line.h"
#include "common/view/body_frames.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;

// Small enough that one batch does not overrun a frame's time by much.
constexpr std::size_t kUploadBatchBytes = 512u << 10;
/// From higher up other tiles are wanted. That begins to change what is drawn and not where its surface is, so once is
/// enough, but for a tile that comes into view under the camera.
constexpr int kMostRises = 3;
/// Another body becomes the anchor once the camera is so much nearer to it: one that hovers half way between two does
/// not change over and over.
constexpr double kNearerToAnchor = 0.8;

/// Decoding many tiles leaves tens of megabytes free in the heap; nobody needs them while the view stands still.
void returnFreedMemory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

void warn(const std::string& text) { complain("terrane-view", "warning: " + text); }

/// The chosen body first, then the others that keep clear of all before them: those of a scene that gives them no
/// places are looked at one by one.
std::vector<std::size_t> bodiesInView(const SceneInfo& scene, std::size_t chosen) {
  std::vector<std::size_t> inView{chosen};
  const auto outer = [](const SelectionBody& body) {
    return body.radiusMeters + std::max(0.0, body.heights.maxMeters);
  };
  for (std::size_t candidate = 0; candidate < scene.bodies.size(); ++candidate) {
    const BodyInfo& body = scene.bodies[candidate];
    const bool clear = std::ranges::all_of(inView, [&](std::size_t other) {
      const BodyInfo& there = scene.bodies[other];
      return glm::length(body.positionScene - there.positionScene) > outer(body.selection) + outer(there.selection);
    });
    if (clear) inView.push_back(candidate);
  }
  return inView;
}

}  // namespace

struct ViewSession::State {
  ViewOptions options;
  std::unique_ptr<TileStream> stream;
  std::unique_ptr<TileRenderer> renderer;
  std::vector<BodyView> views;  ///< as the stream has selected them
  std::size_t anchor = 0;       ///< whose frame camera and pose are in
  Camera camera;
  ViewPose pose;
  bool firstUpdate = true, wasSettled = false;
  std::unordered_map<FacePath, TilePtr> kept;  ///< only to explain: otherwise a mesh is dropped once it is on the GPU

  const SceneInfo* checkedScene = nullptr;
  std::unordered_set<std::string> namedEffects;

  void nameUnknownEffects();
  bool takeArrivals(const UploadBudget& budget);
  BodyView& anchorView() { return views[anchor]; }
  const BodyView& anchorView() const { return views[anchor]; }
  ViewPose resolved(const View& view) const;
  Camera cameraOver(const BodyView& view) const;
  bool chooseOfOthers(double allowedPixels, double seconds);
  void changeAnchor(std::size_t to);
  UpdateReport requestOf(const View& view, double allowedPixels, bool arrived, bool still);
  void evict();
  std::vector<BodyPicture> pictures() const;
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
  const std::vector<std::size_t> inView = bodiesInView(*scene, body);
  s.stream->selectBodies(inView);
  for (std::size_t which = 0; which < inView.size(); ++which) s.views.emplace_back(*s.stream, which);
  drawSettings.placement = s.options.placement.value_or(s.renderer->selfTest().chosen);
  drawSettings.transition = s.options.transition;
  drawSettings.wireframe = s.options.wireframe;
  drawSettings.levelColors = s.options.levelColors;
  drawSettings.samples = s.options.samples.value_or(s.renderer->samplesByDefault());
  return true;
}

const SceneInfo& ViewSession::scene() const { return *state_->stream->scene(); }
const BodyInfo& ViewSession::body() const { return state_->anchorView().info(); }

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
    const std::vector<ArrivedTile> arrived = stream->takeDecoded(std::min(kUploadBatchBytes, budget.bytes - bytes));
    if (arrived.empty()) break;
    for (const ArrivedTile& tile : arrived) {
      const std::size_t gpuBytes = renderer->upload(tile.tile, tile.body);
      stream->markResident(tile, gpuBytes);
      if (options.explain && tile.body == anchor) kept.insert_or_assign(tile.tile->metadata.path, tile.tile);
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
  if (const auto ground = anchorView().groundBelow(result)) result.altitudeMeters += ground->heightMeters;
  return result;
}

Camera ViewSession::State::cameraOver(const BodyView& view) const {
  if (view.index() == anchor) return camera;
  return cameraOverOther(camera, anchorView().info().positionScene, view.info().positionScene,
                         view.info().selection.radiusMeters);
}

bool ViewSession::State::chooseOfOthers(double allowedPixels, double seconds) {
  bool changed = false;
  for (BodyView& view : views) {
    if (view.index() == anchor) continue;
    const Camera over = cameraOver(view);
    const bool tooSmall = diameterPixels(over, view.highestRadiusMeters()) < kLeastDiameterPixels;
    changed = (tooSmall ? view.hide() : view.choose(over, allowedPixels, seconds)) || changed;
  }
  return changed;
}

UpdateReport ViewSession::State::requestOf(const View& view, double allowedPixels, bool arrived, bool still) {
  bool groundKnown = true;
  for (BodyView& body : views) {
    std::optional<BodyView::GroundCall> ground;
    if (body.index() == anchor) ground = {pose, view.aboveGround};
    groundKnown = body.request(cameraOver(body), allowedPixels, ground, view.ahead) && groundKnown;
  }
  UpdateReport report;
  const bool complete = std::ranges::all_of(views, &BodyView::isComplete);
  report.complete = complete && (groundKnown || !view.aboveGround);
  const bool idle = stream->idle();
  report.settled = std::ranges::all_of(views, &BodyView::isSettled) && groundKnown && still && !arrived && idle;
  if (report.settled && !std::exchange(wasSettled, true)) returnFreedMemory();
  wasSettled = report.settled;
  const bool missing = std::ranges::any_of(views, [](const BodyView& body) { return body.missing() > 0; });
  report.stuck = !arrived && missing && idle && stream->status().failed > 0;
  return report;
}

void ViewSession::State::evict() {
  std::vector<std::vector<FacePath>> drawn;
  for (const BodyView& view : views) drawn.push_back(view.drawnPaths());
  const auto gone = stream->evictOfAll(drawn);
  for (std::size_t which = 0; which < gone.size(); ++which)
    for (const FacePath& path : gone[which]) renderer->remove(path, which);
}

UpdateReport ViewSession::update(const View& view, const UploadBudget& budget) {
  State& s = *state_;
  s.nameUnknownEffects();
  const bool arrived = s.takeArrivals(budget);
  BodyView& anchor = s.anchorView();
  const ViewPose viewed = s.resolved(view);
  ViewPose pose = viewed;
  const double altitudeBefore = s.pose.altitudeMeters;
  pose.altitudeMeters = anchor.altitudeAboveDrawn(viewed);
  const auto cameraOf = [&](const ViewPose& at) {
    return cameraFromPose(at, body().selection.radiusMeters, s.options.verticalFieldOfView, view.widthPixels,
                          view.heightPixels);
  };
  Camera camera = cameraOf(pose);
  bool levelsChanged = false;
  double altitudeDue = pose.altitudeMeters;  // above what is drawn now, not a frame ago
  if (!frozen) {
    for (BodyView& each : s.views) each.changeLevelsOverTime(drawSettings.transition != Transition::None);
    levelsChanged = anchor.choose(camera, errorPixels, view.seconds);
    for (int rises = 0; rises < kMostRises; ++rises) {
      altitudeDue = anchor.altitudeAboveDrawn(viewed);
      if (altitudeDue <= pose.altitudeMeters) break;
      pose.altitudeMeters = altitudeDue;
      camera = cameraOf(pose);
      levelsChanged = anchor.chooseHigher(camera, errorPixels) || levelsChanged;
    }
  }
  const bool moved = s.firstUpdate || camera.positionBody != s.camera.positionBody || camera.right != s.camera.right ||
                     camera.backward != s.camera.backward || camera.widthPixels != s.camera.widthPixels ||
                     camera.heightPixels != s.camera.heightPixels;
  s.camera = camera;
  s.pose = pose;
  s.firstUpdate = false;
  UpdateReport report;
  if (!frozen) {
    levelsChanged = s.chooseOfOthers(errorPixels, view.seconds) || levelsChanged;
    const bool still =
        pose.altitudeMeters == altitudeDue && (!view.aboveGround || pose.altitudeMeters == altitudeBefore);
    report = s.requestOf(view, errorPixels, arrived, still);
  }
  report.changed = moved || levelsChanged;
  s.evict();
  return report;
}

void ViewSession::State::changeAnchor(std::size_t to) {
  camera = cameraOver(views[to]);
  anchor = to;
  pose = poseFromCamera(camera);
}

bool ViewSession::anchorNearest() {
  State& s = *state_;
  std::size_t nearest = s.anchor;
  double least = kNearerToAnchor * s.camera.altitudeMeters;
  for (const BodyView& view : s.views) {
    const double altitude = s.cameraOver(view).altitudeMeters;
    if (view.index() == s.anchor || altitude >= least) continue;
    nearest = view.index();
    least = altitude;
  }
  if (nearest == s.anchor) return false;
  s.changeAnchor(nearest);
  return true;
}

void ViewSession::anchorFirst() {
  if (state_->anchor != 0) state_->changeAnchor(0);
}

std::vector<BodyPicture> ViewSession::State::pictures() const {
  std::vector<BodyPicture> bodies{anchorView().picture(camera)};
  for (const BodyView& view : views) {
    if (view.index() == anchor) continue;
    const Camera over = cameraOver(view);
    if (diameterPixels(over, view.highestRadiusMeters()) >= kLeastDiameterPixels) bodies.push_back(view.picture(over));
  }
  return bodies;
}

DrawStats ViewSession::draw() { return state_->renderer->draw(state_->pictures(), drawSettings); }

CoverageCount ViewSession::coverage() { return state_->renderer->countCoverage(state_->pictures(), drawSettings); }

void ViewSession::finish() { glFinish(); }

const ViewPose& ViewSession::pose() const noexcept { return state_->pose; }
const Camera& ViewSession::camera() const noexcept { return state_->camera; }

ViewPose ViewSession::poseOverFirst() const {
  ViewPose pose = state_->anchor == 0 ? state_->pose : poseFromCamera(state_->cameraOver(state_->views.front()));
  pose.roll = 0;
  return pose;
}

std::optional<double> ViewSession::groundHeight(const glm::dvec3& directionBody) const {
  const auto ground = state_->stream->groundBelow(directionBody, state_->anchor);
  return ground ? std::optional<double>(ground->heightMeters) : std::nullopt;
}

std::optional<double> ViewSession::heightAboveGround() const {
  const auto ground = groundHeight(directionOf(state_->pose.longitude, state_->pose.latitude));
  return ground ? std::optional<double>(state_->pose.altitudeMeters - *ground) : std::nullopt;
}

double ViewSession::progress() const noexcept {
  std::size_t wanted = 0;
  for (const BodyView& view : state_->views) wanted += view.wanted();
  return wanted == 0 ? 0 : 1 - static_cast<double>(missing()) / static_cast<double>(wanted);
}

std::size_t ViewSession::missing() const noexcept {
  std::size_t sum = 0;
  for (const BodyView& view : state_->views) sum += view.missing();
  return sum;
}

const std::vector<DrawnTile>& ViewSession::drawn() const noexcept { return state_->anchorView().drawn(); }

std::vector<BodyStatus> ViewSession::bodies() const {
  std::vector<BodyStatus> all;
  for (const BodyView& view : state_->views) {
    const Camera over = state_->cameraOver(view);
    all.push_back({view.info().name, over.altitudeMeters, diameterPixels(over, view.info().selection.radiusMeters),
                   view.drawn().size(), state_->stream->residentCount(view.index())});
  }
  return all;
}

double ViewSession::largestRadiusMeters() const {
  double largest = 0;
  for (const BodyView& view : state_->views) largest = std::max(largest, view.info().selection.radiusMeters);
  return largest;
}

StreamStatus ViewSession::streamStatus() const { return state_->stream->status(); }
const SelfTestReport& ViewSession::selfTest() const { return state_->renderer->selfTest(); }
std::size_t ViewSession::gpuBytes() const { return state_->renderer ? state_->renderer->gpuBytes() : 0; }

TilePtr ViewSession::keptTile(const FacePath& path) const {
  const auto found = state_->kept.find(path);
  return found == state_->kept.end() ? nullptr : found->second;
}

std::string selfTestText(const SelfTestReport& report) {
  const auto word = [](bool exact) { return exact ? "exact" : "WRONG"; };
  return fmt::format("integers {}, TwoSum {}, TwoProd {}", word(report.integerExact), word(report.twoSumExact),
                     word(report.twoProdExact));
}

}  // namespace terrane
