#include "client/app/hud_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "client/render/readable_units.h"

namespace terrane {
namespace {

std::string networkText(const NetworkConditions& network) {
  if (!network.simulated()) return {};
  const std::string bandwidth = network.bytesPerSecond == 0 ? "" : ", " + bytesText(network.bytesPerSecond) + "/s";
  return fmt::format("simulated: {} ms{}", network.latency.count(), bandwidth);
}

}  // namespace

HudState hudStateOf(const ViewSession& session, const FrameTimes& times, const DrawStats& drawn,
                    std::vector<float>& frameMs) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const StreamStatus stream = session.streamStatus();
  frameMs = times.last(120);
  std::vector<float> sorted = frameMs;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  HudState state;
  const auto height = session.heightAboveGround();
  if (session.bodies().size() > 1) state.body = session.body().name;
  state.altitudeMeters = session.pose().altitudeMeters;
  state.groundKnown = height.has_value();
  state.groundMeters = height.value_or(0);
  state.longitudeDegrees = session.pose().longitude * kDegrees;
  state.latitudeDegrees = session.pose().latitude * kDegrees;
  state.headingDegrees = session.pose().heading * kDegrees;
  state.pitchDegrees = session.pose().pitch * kDegrees;
  state.frameMs = frameMs;
  state.medianMs = sorted.empty() ? 0 : static_cast<double>(sorted[sorted.size() / 2]);
  state.errorPixels = session.errorPixels;
  state.askedErrorPixels = session.errorPixels;
  state.tilesDrawn = drawn.tiles;
  state.triangles = drawn.triangles;
  state.samples = drawn.samples;
  state.tilesLoading = session.missing();
  state.tilesResident = stream.resident;
  state.bytesReceived = stream.bytesReceived;
  state.residentBytes = stream.residentBytes;
  state.gpuBytes = session.gpuBytes();
  state.rssBytes = residentSetBytes();
  state.placement = placementName(session.drawSettings.placement);
  state.transition = transitionName(session.drawSettings.transition);
  state.selfTest = selfTestText(session.selfTest());
  state.mode = "scripted";
  state.network = networkText(stream.network);
  state.link = stream.message;
  state.progress = session.progress();
  state.frozen = session.frozen;
  state.wireframe = session.drawSettings.wireframe;
  state.levelColors = session.drawSettings.levelColors;
  return state;
}

void describeSession(const ViewSession& session, const ViewOptions& options, RunStatistics& statistics) {
  statistics.rssBytes = residentSetBytes();
  statistics.gpuBytes = session.gpuBytes();
  statistics.errorPixels = session.errorPixels;
  statistics.placement = session.drawSettings.placement;
  statistics.transition = session.drawSettings.transition;
  statistics.selfTest = session.selfTest();
  statistics.stream = session.streamStatus();
  statistics.pose = session.pose();
  statistics.heightAboveGroundMeters = session.heightAboveGround().value_or(-1);
  statistics.widthPixels = session.camera().widthPixels;
  statistics.heightPixels = session.camera().heightPixels;
  statistics.server = options.serverUrl;
  statistics.scene = session.scene().name;
  statistics.body = session.body().name;
  statistics.bodies = session.bodies();
  for (const EffectCall& effect : session.effects()) statistics.effects.emplace_back(effectRow(effect.kind).name);
  statistics.constructed = constructionCounts();
}

}  // namespace terrane
