#pragma once
// A scene: bodies with their fields, and the effects it calls for. Read from a TOML file (server/scenes/scene_file.h).

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/scene/effects.h"
#include "common/scene/parameters.h"
#include "common/tiling/face_path.h"

namespace terrane {

/// The kinds of height field that a body may have. To add one: a kind, a row in field_table.cpp, a case in
/// server/fields/make_field.
enum class FieldKind : std::uint8_t { Sphere, Lunar, Midpoint };
inline constexpr int kFieldKindCount = 3;

struct FieldRow {
  FieldKind kind;
  std::string_view name;  ///< as a scene file writes it: field = "lunar"
  std::string_view summary;
  std::span<const ParameterSpec> parameters;
};
std::span<const FieldRow> fieldTable() noexcept;
const FieldRow& fieldRow(FieldKind kind) noexcept;
std::optional<FieldKind> findField(std::string_view name) noexcept;

/// No body's centre is farther than this from the scene's origin along any axis, in metres: 67 astronomical units.
inline constexpr double kMaxPositionMeters = 1e13;

struct Body {
  std::string name;  ///< [a-z0-9-]{1,32}: it is a part of URLs
  double radiusMeters = 0;
  std::vector<Scheme> schemes{Scheme::Cube};
  FieldKind field = FieldKind::Sphere;
  ParameterValues fieldParameters;
  std::uint64_t seed = 0;
  /// Its centre in the scene's frame, metres; the axes of all bodies are the scene's.
  glm::dvec3 positionScene{0.0};
};

struct Scene {
  std::string name;
  std::string summary;
  std::vector<Body> bodies;
  std::vector<EffectCall> effects;
};

}  // namespace terrane
