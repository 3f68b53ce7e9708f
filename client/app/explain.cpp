#include "client/app/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <utility>

#include "client/app/run_statistics.h"
#include "client/render/readable_units.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMeasuredFrames = 15;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Cost {
  double withMs = 0, withoutMs = 0;
  std::int64_t gpuBytes = 0;
};

// Frames with and without the effect, turn about, so that whatever else the machine does falls on both.
Result<Cost> measure(ViewSession& session, EffectKind kind) {
  const std::vector<EffectCall> all = session.effects();
  std::vector<EffectCall> others;
  std::copy_if(all.begin(), all.end(), std::back_inserter(others),
               [&](const EffectCall& call) { return call.kind != kind; });
  const RendererOptions options{.bodyRadiusMeters = session.body().selection.radiusMeters,
                                .bodyScheme = session.body().selection.scheme};
  auto with = TileRenderer::create(all, options);
  if (!with) return with.error();
  auto without = TileRenderer::create(others, options);
  if (!without) return without.error();
  for (const DrawnTile& drawn : session.drawn())
    for (int level = std::max(0, drawn.path.level() - 1); level <= drawn.path.level(); ++level)  // with its parent
      if (const TilePtr tile = session.keptTile(drawn.path.ancestor(level))) {
        (*with)->upload(tile);
        (*without)->upload(tile);
      }
  std::array<FrameTimes, 2> times;
  for (int frame = -1; frame < kMeasuredFrames; ++frame)
    for (const std::size_t side : {0u, 1u}) {
      TileRenderer& renderer = side == 0 ? **with : **without;
      const auto begin = Clock::now();
      renderer.draw(session.camera(), session.drawn(), session.drawSettings);
      session.finish();
      if (frame >= 0) times[side].add(millisecondsSince(begin));  // the first frame of each compiles
    }
  return Cost{times[0].percentile(0.5), times[1].percentile(0.5),
              static_cast<std::int64_t>((*with)->gpuBytes()) - static_cast<std::int64_t>((*without)->gpuBytes())};
}

std::string costText(ViewSession& session, const EffectRow& row, bool on) {
  if (!on) return "nothing: never constructed";
  if (row.side == EffectSide::Server) return fmt::format("{} (at the server; its --explain measures it)", row.cost);
  const auto cost = measure(session, row.kind);
  if (!cost) return fmt::format("not measured: {}", cost.error().text());
  return fmt::format("{:+.2f} ms a frame ({:.2f} ms with it, {:.2f} ms without), {:+} bytes on the GPU",
                     cost->withMs - cost->withoutMs, cost->withMs, cost->withoutMs, cost->gpuBytes);
}

}  // namespace

std::string explainEffects(ViewSession& session) {
  const SceneInfo& scene = session.scene();
  const std::vector<std::pair<std::string, int>> constructed =
      constructionCounts();  // before measuring constructs more
  std::string text =
      fmt::format("scene {}, body {}: {} tiles drawn, {} above the sphere\n", scene.name, session.body().name,
                  session.drawn().size(), lengthText(session.pose().altitudeMeters));
  const auto names = [](const std::vector<EffectCall>& calls, EffectKind kind) {
    return std::any_of(calls.begin(), calls.end(), [kind](const EffectCall& call) { return call.kind == kind; });
  };
  for (const EffectRow& row : effectTable()) {
    const bool on = names(session.effects(), row.kind), leftOut = !on && names(scene.effects, row.kind);
    text += fmt::format("effect {}: {}\n  shows  {}\n  needs  {}\n  why    {}\n  costs  {}\n", row.name,
                        on ? "on" : "off", row.summary, row.needs,
                        on        ? fmt::format("the scene names it: [effects.{}]", row.name)
                        : leftOut ? fmt::format("--without {}", row.name)
                                  : "the scene does not name it",
                        costText(session, row, on));
  }
  text += "constructed";
  if (constructed.empty()) text += ": nothing that a scene could leave out";
  for (bool first = true; const auto& [name, count] : constructed)
    text += fmt::format("{}{} {}", std::exchange(first, false) ? ": " : ", ", name, count);
  return text + "\n";
}

}  // namespace terrane
