#include "server/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "common/scene/effects.h"
#include "server/scenes/quantity_text.h"

namespace terrane {
namespace {

void appendParameters(std::string& out, std::span<const ParameterSpec> schema, const ParameterValues& values) {
  for (const ParameterSpec& spec : schema) {
    const auto value = values.find(spec.name);
    if (value == values.end()) continue;
    fmt::format_to(std::back_inserter(out), "      {} = {}{}: {}\n", spec.name,
                   formatQuantity(value->second, spec.quantity), value->second == spec.defaultValue ? " (default)" : "",
                   spec.summary);
  }
}

void appendBody(std::string& out, const Body& body, const BodyInfo& info, const std::string& whyStockDraco) {
  const FieldRow& field = fieldRow(body.field);
  fmt::format_to(std::back_inserter(out),
                 "  {}: radius {}, levels 0 to {}, heights {} to {}, revision {}\n"
                 "    field {}: {}; seed {}\n",
                 body.name, formatQuantity(body.radiusMeters, Quantity::Length), info.selection.maxLevel,
                 formatQuantity(info.selection.heights.minMeters, Quantity::Length),
                 formatQuantity(info.selection.heights.maxMeters, Quantity::Length), info.revision, field.name,
                 field.summary, body.seed);
  appendParameters(out, field.parameters, body.fieldParameters);
  fmt::format_to(std::back_inserter(out), "    tiles are encoded by {}\n",
                 whyStockDraco.empty() ? "a template learnt from libdraco" : "libdraco: " + whyStockDraco);
}

void appendEffect(std::string& out, const EffectRow& row, const Scene& scene) {
  const auto call = std::ranges::find(scene.effects, row.kind, &EffectCall::kind);
  const bool on = call != scene.effects.end();
  fmt::format_to(std::back_inserter(out), "  {}: {}; {}\n", row.name, on ? "on" : "off",
                 on ? fmt::format("the scene has [effects.{}]", row.name)
                    : fmt::format("the scene has no [effects.{}], so nothing of it is constructed", row.name));
  fmt::format_to(std::back_inserter(out), "    {}; runs in the {}\n    needs: {}\n    cost: {}\n", row.summary,
                 row.side == EffectSide::Client ? "viewer" : "server", row.needs,
                 on ? row.cost : std::string_view("none"));
  if (on) appendParameters(out, row.parameters, call->parameters);
}

}  // namespace

std::string explainScene(const Scene& scene, const TileService::Options& options) {
  resetConstructionCounts();
  const auto start = std::chrono::steady_clock::now();
  const TileService service(scene, options);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;

  std::string out = fmt::format("scene {}{}{}\nbodies\n", scene.name, scene.summary.empty() ? "" : ": ", scene.summary);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    appendBody(out, scene.bodies[i], service.scene().bodies[i], service.whyStockDraco()[i]);
  out += "effects\n";
  for (const EffectRow& row : effectTable()) appendEffect(out, row, scene);
  fmt::format_to(std::back_inserter(out), "constructed by this server in {:.1f} ms\n", took.count());
  const auto counts = constructionCounts();
  for (const auto& [name, count] : counts) fmt::format_to(std::back_inserter(out), "  {} {}\n", name, count);
  if (counts.empty()) out += "  nothing\n";
  return out;
}

}  // namespace terrane
