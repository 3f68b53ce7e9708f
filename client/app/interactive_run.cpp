#include "client/app/interactive_run.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "client/app/flight_plan.h"
#include "client/app/flight_recorder.h"
#include "client/app/hud_state.h"
#include "client/app/run_statistics.h"
#include "client/app/view_session.h"
#include "client/app/whole_body_pose.h"
#include "client/app/window_input.h"
#include "client/controls/camera_controls.h"
#include "client/controls/frame_budget.h"
#include "client/gl/image.h"
#include "client/render/hud.h"
#include "common/command_line.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;
using Done = Result<bool>;

// How long the loop may sleep when nothing moves: arrivals and events wake it, so this only bounds how late a message
// is.
/// After a pause a change of level would otherwise be over before it was seen.
constexpr double kLongestMorphStepSeconds = 0.1;
constexpr double kSleepSettledSeconds = 5, kSleepLoadingSeconds = 0.25;
constexpr double kNoticeSeconds = 4;
constexpr int kPlacementCount = static_cast<int>(Placement::Float32) + 1;

double secondsBetween(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

class InteractiveRun {
 public:
  InteractiveRun(const ViewOptions& options, Window& window, Clock::time_point start)
      : options_(options),
        window_(window),
        start_(start),
        budget_(options.frameBudgetMs, options.errorPixels),
        input_(window.handle()) {}

  Done run();

 private:
  Done connect();
  Done begin();
  void step();
  ViewSession::View viewNow(double seconds);
  void obey(ViewCommand command);
  void screenshot();
  void drawFrame(Clock::time_point begin);
  void drawOverlay();
  void drawConnecting();
  void sleep(const UpdateReport& report);
  void notice(std::string text);
  Done writeResults();

  const ViewOptions& options_;
  Window& window_;
  Clock::time_point start_;
  FrameBudget budget_;
  WindowInput input_;
  std::unique_ptr<ViewSession> session_;
  std::unique_ptr<Hud> hud_;
  CameraControls controls_{ViewPose{}};
  std::optional<Flight> flight_;
  double flightSeconds_ = 0;
  bool handsOn_ = false;  // the person has taken over: --above-ground no longer moves the camera
  FlightRecorder recorder_;
  RunStatistics statistics_;
  DrawStats drawn_;
  bool firstFullView_ = false, showFigures_ = true, redraw_ = true, quit_ = false, slept_ = false;
  std::string notice_, shownLink_;
  std::size_t shownMissing_ = 0;
  Clock::time_point noticeUntil_{}, lastStep_ = Clock::now();
};

Done InteractiveRun::run() {
  auto session = ViewSession::open(options_, &Window::wake);
  if (!session) return session.error();
  session_ = std::move(*session);
  auto hud = Hud::create(1);
  if (!hud) return hud.error();
  hud_ = std::move(*hud);
  if (const Done connected = connect(); !connected) return connected.error();
  if (quit_ || window_.shouldClose()) return true;
  if (const Done begun = begin(); !begun) return begun.error();
  while (!quit_ && !window_.shouldClose()) step();
  return writeResults();
}

// The window is there and says what it waits for until the scene is.
Done InteractiveRun::connect() {
  for (;;) {
    const auto ready = session_->ready();
    if (!ready) return ready.error();
    if (*ready || quit_ || window_.shouldClose()) return true;
    drawConnecting();
    window_.swap();
    window_.wait(kSleepLoadingSeconds);
    for (const ViewCommand command : input_.takeCommands())
      if (command == ViewCommand::Quit) quit_ = true;
  }
}

void InteractiveRun::drawConnecting() {
  const auto [width, height] = window_.framebufferSize();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  HudState state;
  state.progress = 0;
  state.link = session_->streamStatus().message;
  hud_->draw(state, false, width, height);
}

Done InteractiveRun::begin() {
  const auto [width, height] = window_.framebufferSize();
  const ViewPose whole =
      wholeBodyPose(session_->scene(), session_->body(), options_.verticalFieldOfView, width, height);
  const ViewPose home = options_.camera.value_or(whole);
  controls_ = CameraControls(home);
  if (!options_.flight.empty()) {
    auto flight = flightOf(options_, home, session_->body().selection.radiusMeters);
    if (!flight) return flight.error();
    flight_ = std::move(*flight);
    if (options_.aboveGround) flight_->aboveGround = true;
  }
  return true;
}

ViewSession::View InteractiveRun::viewNow(double seconds) {
  const auto [width, height] = window_.framebufferSize();
  ViewSession::View view;
  view.ahead = true;
  view.widthPixels = std::max(width, 16);
  view.heightPixels = std::max(height, 16);
  view.seconds = std::min(seconds, kLongestMorphStepSeconds);
  const ControlInput input = input_.take(slept_ ? std::min(seconds, 1.0 / 60) : seconds);
  const bool hands =
      input.primaryButton || input.secondaryButton || input.wheelSteps != 0 || input.move != glm::dvec3(0.0);
  if (hands && flight_) {
    flight_.reset();
    notice("flight left");
  }
  if (hands && !handsOn_) {
    handsOn_ = true;
    controls_.setPose(session_->pose());  // wherever the ground or the flight has brought the camera
  }
  if (flight_) {
    if (firstFullView_) flightSeconds_ += std::min(seconds, 0.1);
    view.pose = poseAt(*flight_, flight_->points.front().seconds + flightSeconds_);
    view.aboveGround = flight_->aboveGround;
    return view;
  }
  if (!handsOn_) {
    view.pose = controls_.pose();
    view.aboveGround = options_.aboveGround;
    return view;
  }
  const ControlView shape{session_->body().selection.radiusMeters, options_.verticalFieldOfView, view.widthPixels,
                          view.heightPixels, session_->largestRadiusMeters()};
  if (session_->anchorNearest()) controls_.moveOver(session_->pose());
  view.pose = controls_.advance(input, shape,
                                [this](const glm::dvec3& direction) { return session_->groundHeight(direction); });
  return view;
}

void InteractiveRun::notice(std::string text) {
  notice_ = std::move(text);
  noticeUntil_ = Clock::now() + std::chrono::milliseconds(static_cast<int>(kNoticeSeconds * 1000));
  redraw_ = true;
}

void InteractiveRun::obey(ViewCommand command) {
  DrawSettings& draw = session_->drawSettings;
  redraw_ = true;
  switch (command) {
    case ViewCommand::ToggleHud:
      showFigures_ = !showFigures_;
      break;
    case ViewCommand::ToggleWireframe:
      draw.wireframe = !draw.wireframe;
      break;
    case ViewCommand::ToggleLevelColors:
      draw.levelColors = !draw.levelColors;
      break;
    case ViewCommand::ToggleFreeze:
      session_->frozen = !session_->frozen;
      break;
    case ViewCommand::LessDetail:
      budget_.setAsked(std::min(budget_.asked() * 1.25, 100.0));
      break;
    case ViewCommand::MoreDetail:
      budget_.setAsked(std::max(budget_.asked() / 1.25, 0.1));
      break;
    case ViewCommand::Screenshot:
      screenshot();
      break;
    case ViewCommand::ToggleMode:
      if (!handsOn_) controls_.setPose(session_->pose());
      handsOn_ = true;
      flight_.reset();
      controls_.toggleMode();
      break;
    case ViewCommand::Home:
      flight_.reset();
      handsOn_ = false;
      session_->anchorFirst();
      controls_.goHome();
      break;
    case ViewCommand::NextPlacement:
      draw.placement = static_cast<Placement>((static_cast<int>(draw.placement) + 1) % kPlacementCount);
      break;
    case ViewCommand::NextTransition:
      draw.transition = static_cast<Transition>((static_cast<int>(draw.transition) + 1) % kTransitionCount);
      break;
    case ViewCommand::Quit:
      quit_ = true;
      break;
  }
  session_->errorPixels = budget_.errorPixels();
}

// The scene alone, without the overlay, under the next free number in the working directory.
void InteractiveRun::screenshot() {
  const auto [width, height] = window_.framebufferSize();
  session_->draw();
  std::string file;
  for (int number = 1; file.empty() || std::filesystem::exists(file); ++number)
    file = fmt::format("terrane-{:04}.png", number);
  const auto written = writePng(readFramebuffer(width, height), file);
  notice(written ? "wrote " + file : "no screenshot: " + written.error().text());
}

void InteractiveRun::step() {
  const auto begin = Clock::now();
  const double seconds = secondsBetween(lastStep_, begin);
  lastStep_ = begin;
  for (const ViewCommand command : input_.takeCommands()) obey(command);
  const UpdateReport report = session_->update(viewNow(seconds), UploadBudget{});
  if (report.complete && !firstFullView_) {
    firstFullView_ = redraw_ = true;
    statistics_.msToSettle = secondsBetween(start_, begin) * 1000;
  }
  if (!notice_.empty() && begin > noticeUntil_) {
    notice_.clear();
    redraw_ = true;
  }
  std::string link = session_->streamStatus().message;
  if (link != shownLink_ || session_->missing() != shownMissing_) redraw_ = true;
  shownLink_ = std::move(link);
  shownMissing_ = session_->missing();
  const bool damaged = input_.takeDamage();
  if (report.changed || redraw_ || damaged || !budget_.steady() || !firstFullView_) drawFrame(begin);
  sleep(report);
}

void InteractiveRun::drawFrame(Clock::time_point begin) {
  redraw_ = false;
  drawn_ = session_->draw();
  const bool measured = !options_.statsFile.empty();
  if (measured || options_.frameBudgetMs > 0) session_->finish();
  const double milliseconds = secondsBetween(begin, Clock::now()) * 1000;
  statistics_.frameTimes.add(milliseconds);
  session_->errorPixels = budget_.frame(milliseconds);
  if (measured && firstFullView_) {
    const CoverageCount count = session_->coverage();
    statistics_.uncoveredPixels += count.uncovered;
    statistics_.skirtPixels += count.skirt;
    ++statistics_.framesCounted;
  }
  if (!options_.recordFile.empty()) recorder_.add(secondsBetween(start_, begin), session_->poseOverFirst());
  drawOverlay();
  window_.swap();
}

void InteractiveRun::drawOverlay() {
  std::vector<float> frameMs;
  HudState state = hudStateOf(*session_, statistics_.frameTimes, drawn_, frameMs);
  state.askedErrorPixels = budget_.asked();
  state.speedMetersPerSecond = controls_.speedMetersPerSecond();
  state.mode = flight_ ? "flight" : controlModeName(controls_.mode());
  state.notice = notice_;
  state.firstViewComplete = firstFullView_;
  const auto [width, height] = window_.framebufferSize();
  hud_->draw(state, showFigures_, width, height);
}

void InteractiveRun::sleep(const UpdateReport& report) {
  const bool flying =
      flight_ && firstFullView_ && flightSeconds_ < flight_->durationSeconds() - flight_->points.front().seconds;
  const bool active = flying || controls_.moving() || input_.held() || redraw_ || !budget_.steady();
  slept_ = !active;
  if (active) return window_.poll();
  double seconds = report.settled ? kSleepSettledSeconds : kSleepLoadingSeconds;
  if (!notice_.empty()) seconds = std::min(seconds, 0.5);
  window_.wait(seconds);
}

Done InteractiveRun::writeResults() {
  if (!options_.statsFile.empty()) {
    describeSession(*session_, options_, statistics_);
    statistics_.drawn = drawn_;
    const auto written = writeTextFile(statisticsJson(statistics_), options_.statsFile, "--stats");
    if (!written) return written.error();
  }
  if (!options_.recordFile.empty() && !recorder_.flight().points.empty()) {
    const auto written = writeTextFile(writeFlight(recorder_.flight()), options_.recordFile, "--record");
    if (!written) return written.error();
  }
  return true;
}

}  // namespace

int runInteractive(const ViewOptions& options, Window& window, Clock::time_point start) {
  InteractiveRun run(options, window, start);
  const Done done = run.run();
  if (done) return kExitDone;
  complain("terrane-view", done.error().text());
  return exitStatus(done.error());
}

}  // namespace terrane
