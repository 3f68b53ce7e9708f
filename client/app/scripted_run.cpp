#include "client/app/scripted_run.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "client/app/explain.h"
#include "client/app/flight_plan.h"
#include "client/app/hud_state.h"
#include "client/app/run_statistics.h"
#include "client/app/view_session.h"
#include "client/app/whole_body_pose.h"
#include "client/controls/frame_budget.h"
#include "client/gl/image.h"
#include "client/render/hud.h"
#include "client/render/readable_units.h"
#include "common/command_line.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;
using Done = Result<bool>;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// What a point of the flight is measured against: where the run stood at the point before.
struct Mark {
  FrameTimes times;
  std::uint64_t bytes = 0, uncovered = 0, skirt = 0;
};

class ScriptedRun {
 public:
  ScriptedRun(const ViewOptions& options, Window& window, Clock::time_point start)
      : options_(options), window_(window), start_(start), budget_(options.frameBudgetMs, options.errorPixels) {}

  Done run();

 private:
  Done waitForScene();
  Result<FlightPlan> plan();
  Done flyPlan(const FlightPlan& plan);
  Done settle(const ViewSession::View& view, bool wholly);
  void waitUntil(Clock::time_point due);
  void drawFrame(const ViewSession::View& view);
  Done finishPoint(const PlannedFrame& frame, bool aboveGround);
  Done capture(const std::string& file);
  Done writeResults();
  Error notComplete(std::string_view what, double seconds) const;
  /// A window manager may have given the window another size than was asked; headless nobody does.
  std::array<int, 2> pictureSize() const {
    return options_.headless ? std::array{options_.widthPixels, options_.heightPixels} : window_.framebufferSize();
  }
  bool counting() const { return !options_.statsFile.empty(); }
  /// A flight that is over before a simulated network has brought anything would show nothing of it: frames come no
  /// faster than the seconds that they stand for.
  bool inRealTime() const { return options_.network.simulated() && !options_.settle; }

  const ViewOptions& options_;
  Window& window_;
  Clock::time_point start_;
  FrameBudget budget_;
  std::unique_ptr<ViewSession> session_;
  std::unique_ptr<Hud> hud_;
  RunStatistics statistics_;
  Mark mark_;
  DrawStats drawn_;
  Flight record_;
  bool sceneThere_ = false, firstFullView_ = false;
};

Error ScriptedRun::notComplete(std::string_view what, double seconds) const {
  const StreamStatus status = session_->streamStatus();
  std::string why = status.message;
  if (why.empty() && status.failed > 0) why = fmt::format("{} tiles failed", status.failed);
  if (why.empty()) why = "the server is slower than that";
  // A server that is not there, or has no scene, is the server's flag to name; a slow view is the limit's.
  const bool dead = status.link == LinkState::Offline || !sceneThere_ || status.bytesReceived == 0;
  return makeError(ErrorKind::Timeout, dead ? "--server" : "--time-limit",
                   fmt::format("{} after {:.3g} s: {}", what, seconds, why));
}

Done ScriptedRun::waitForScene() {
  const auto begin = Clock::now();
  for (;;) {
    const auto ready = session_->ready();
    if (!ready) return ready.error();
    if (*ready) {
      sceneThere_ = true;
      return true;
    }
    if (millisecondsSince(begin) > options_.timeLimitSeconds * 1000)
      return notComplete("no scene", options_.timeLimitSeconds);
    window_.wait(0.02);
  }
}

Result<FlightPlan> ScriptedRun::plan() {
  const ViewPose still = options_.camera.value_or(wholeBodyPose(
      session_->scene(), session_->body(), options_.verticalFieldOfView, options_.widthPixels, options_.heightPixels));
  const auto frames = static_cast<std::size_t>(options_.frames);
  if (options_.flight.empty())
    return planStill(still, options_.aboveGround, frames > 0 ? frames : counting() ? 8 : 1, options_.stepSeconds);
  const auto flight = flightOf(options_, still, session_->body().selection.radiusMeters);
  if (!flight) return flight.error();
  auto plan = frames > 0 && !options_.stepGiven ? Result<FlightPlan>(planFlightInFrames(*flight, frames))
                                                : planFlight(*flight, options_.stepSeconds, frames);
  if (plan && options_.aboveGround) plan->aboveGround = true;
  return plan;
}

// Waits until the view is there: wholly (nothing more is to come), or only complete.
Done ScriptedRun::settle(const ViewSession::View& view, bool wholly) {
  const auto begin = Clock::now();
  ViewSession::View waiting = view;
  waiting.ahead = false;
  waiting.seconds = 1e9;  // nobody sees it come: changes of level take no time
  for (;;) {
    const UpdateReport report = session_->update(waiting, kUnlimitedUpload);
    if (report.settled || (!wholly && report.complete)) return true;
    const double seconds = millisecondsSince(begin) / 1000;
    if (report.stuck || seconds > options_.timeLimitSeconds)
      return notComplete(fmt::format("the view is not complete, {} tiles are missing", session_->missing()), seconds);
    // Arrivals wake the loop; while they pour in there is no need to wait.
    if (!report.changed) window_.wait(0.02);
  }
}

void ScriptedRun::waitUntil(Clock::time_point due) {
  for (double ms = -millisecondsSince(due); ms > 0; ms = -millisecondsSince(due)) window_.wait(ms / 1000);
}

void ScriptedRun::drawFrame(const ViewSession::View& view) {
  const auto begin = Clock::now();
  const UpdateReport report = session_->update(view, options_.settle ? kUnlimitedUpload : UploadBudget{});
  drawn_ = session_->draw();
  session_->finish();
  const double milliseconds = millisecondsSince(begin);
  statistics_.frameTimes.add(milliseconds);
  mark_.times.add(milliseconds);
  session_->errorPixels = budget_.frame(milliseconds);
  if (report.complete && !firstFullView_) {
    firstFullView_ = true;
    statistics_.msToSettle = millisecondsSince(start_);
  }
  if (counting() && firstFullView_) {
    const CoverageCount count = session_->coverage();
    statistics_.uncoveredPixels += count.uncovered;
    statistics_.skirtPixels += count.skirt;
    mark_.uncovered += count.uncovered;
    mark_.skirt += count.skirt;
    ++statistics_.framesCounted;
  }
  if (hud_) {
    std::vector<float> frameMs;
    HudState state = hudStateOf(*session_, statistics_.frameTimes, drawn_, frameMs);
    state.askedErrorPixels = budget_.asked();
    state.firstViewComplete = firstFullView_;
    hud_->draw(state, true, view.widthPixels, view.heightPixels);
  }
}

Done ScriptedRun::capture(const std::string& file) {
  const auto [width, height] = pictureSize();
  const auto written = writePng(readFramebuffer(width, height), file);
  if (!written) return makeError(written.error().kind, "--capture", written.error().text());
  return true;
}

Done ScriptedRun::finishPoint(const PlannedFrame& frame, bool aboveGround) {
  PointStatistics point;
  point.name = lengthText(frame.pose.altitudeMeters);
  point.altitudeMeters = frame.pose.altitudeMeters;
  point.frames = mark_.times.count();
  point.medianMs = mark_.times.percentile(0.5);
  point.tilesDrawn = drawn_.tiles;
  const std::uint64_t bytes = session_->streamStatus().bytesReceived;
  point.bytesReceived = bytes - mark_.bytes;
  point.uncoveredPixels = mark_.uncovered;
  point.skirtPixels = mark_.skirt;
  if (options_.captureFile.find("%d") != std::string::npos) {
    point.capture = numberedFile(options_.captureFile, statistics_.points.size() + 1);
    if (const auto captured = capture(point.capture); !captured) return captured.error();
  }
  fmt::print("{:>10} above {}: {:>4} frames, median {:>6.1f} ms, {:>4} tiles, {:>9}, {} uncovered pixels{}{}\n",
             point.name, aboveGround ? "ground" : "sphere", point.frames, point.medianMs, point.tilesDrawn,
             bytesText(point.bytesReceived), counting() ? std::to_string(point.uncoveredPixels) : "not counted",
             point.capture.empty() ? "" : "  ", point.capture);
  std::fflush(stdout);
  statistics_.points.push_back(std::move(point));
  mark_ = Mark{};
  mark_.bytes = bytes;
  return true;
}

Done ScriptedRun::flyPlan(const FlightPlan& plan) {
  const bool capturesPoints = options_.captureFile.find("%d") != std::string::npos;
  Clock::time_point lastBegin = Clock::now();
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const PlannedFrame& frame = plan.frames[i];
    const auto [width, height] = pictureSize();
    const double seconds = i == 0 ? 0 : frame.seconds - plan.frames[i - 1].seconds;
    const ViewSession::View view{frame.pose, plan.aboveGround, width, height, seconds, !options_.settle};
    // A flight begins with a full view, so that what it shows does not depend on how fast the first tiles came.
    if (options_.settle || (i == 0 && plan.points > 0))
      if (const Done settled = settle(view, options_.settle); !settled) return settled.error();
    if (i > 0 && inRealTime())
      waitUntil(lastBegin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
    lastBegin = Clock::now();
    drawFrame(view);
    record_.points.push_back({frame.seconds, session_->pose()});
    if (frame.point >= 0)
      if (const Done finished = finishPoint(frame, plan.aboveGround); !finished) return finished.error();
    if (i + 1 == plan.frames.size() && !options_.captureFile.empty() && !capturesPoints)
      if (const Done captured = capture(options_.captureFile); !captured) return captured.error();
    window_.swap();
    window_.poll();
    if (!options_.headless && window_.shouldClose()) break;
  }
  return true;
}

Done ScriptedRun::writeResults() {
  if (!options_.statsFile.empty()) {
    describeSession(*session_, options_, statistics_);
    statistics_.drawn = drawn_;
    const auto written = writeTextFile(statisticsJson(statistics_), options_.statsFile, "--stats");
    if (!written) return written.error();
  }
  if (!options_.recordFile.empty()) {
    const auto written = writeTextFile(writeFlight(record_), options_.recordFile, "--record");
    if (!written) return written.error();
  }
  return true;
}

Done ScriptedRun::run() {
  auto session = ViewSession::open(options_, &Window::wake);
  if (!session) return session.error();
  session_ = std::move(*session);
  if (const Done scene = waitForScene(); !scene) return scene.error();
  const auto planned = plan();
  if (!planned) return planned.error();
  if (options_.explain) {
    const PlannedFrame& first = planned->frames.front();
    const ViewSession::View view{first.pose, planned->aboveGround, options_.widthPixels, options_.heightPixels, 0};
    if (const Done settled = settle(view, true); !settled) return settled.error();
    fmt::print("{}", explainEffects(*session_));
    return true;
  }
  if (options_.hud) {
    auto hud = Hud::create(1);
    if (!hud) return hud.error();
    hud_ = std::move(*hud);
  }
  const Done flown = flyPlan(*planned);
  // What was measured up to a failure is worth having too.
  const Done written = writeResults();
  if (!flown) return flown.error();
  if (!written) return written.error();
  const StreamStatus status = session_->streamStatus();
  if (!status.message.empty()) fmt::print("note: {}\n", status.message);
  return true;
}

}  // namespace

int runScripted(const ViewOptions& options, Window& window, Clock::time_point start) {
  ScriptedRun run(options, window, start);
  const Done done = run.run();
  if (done) return kExitDone;
  complain("terrane-view", done.error().text());
  return exitStatus(done.error());
}

}  // namespace terrane
