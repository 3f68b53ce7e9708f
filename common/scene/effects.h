#pragma once
// The one table of effects. Everything optional hangs on a row here: a scene names the effects it calls for, and what
// it does not name is never constructed: no shader compiled, no buffer, no thread, no route, no bytes. The code that
// makes an effect is registered by kind on the side that runs it (client/render/effect_factories.cpp), where a missing
// factory does not compile. To add an effect: a kind, a row in effects.cpp, a factory.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/scene/parameters.h"

namespace terrane {

enum class EffectKind : std::uint8_t { Sun, Detail, Dust };
inline constexpr int kEffectKindCount = 3;

enum class EffectSide : std::uint8_t { Client, Server };

struct EffectRow {
  EffectKind kind;
  std::string_view name;     ///< as a scene file writes it: [effects.sun]
  std::string_view summary;  ///< what it shows
  std::string_view needs;    ///< what it cannot run without
  std::string_view cost;     ///< what it adds, in words; --explain prints what was measured
  EffectSide side;
  std::span<const ParameterSpec> parameters;
};

std::span<const EffectRow> effectTable() noexcept;
const EffectRow& effectRow(EffectKind kind) noexcept;
std::optional<EffectKind> findEffect(std::string_view name) noexcept;

/// An effect that a scene names, with its settings.
struct EffectCall {
  EffectKind kind;
  ParameterValues parameters;
};
/// A setting of an effect, or the table's default where a scene was made by hand. Precondition: the table has it.
double effectSetting(const EffectCall& call, std::string_view name);

/// Counts what was constructed, by name ("effect.sun", "field.lunar"): what --explain prints and the tests assert.
/// Process-wide and thread-safe, as metrics are.
void countConstruction(std::string_view name);
std::vector<std::pair<std::string, int>> constructionCounts();
void resetConstructionCounts();

}  // namespace terrane
