// Scenes by name or file: those built into the program, and what lies on the disk.

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "server/scenes/quantity_text.h"
#include "server/scenes/scene_file.h"
#include "server/scenes/shipped_scenes.h"

namespace terrane {

Result<Scene> loadSceneFile(const std::filesystem::path& file) try {
  const std::string name = file.string();
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(file, failure);
  if (!std::filesystem::exists(status)) return makeError(ErrorKind::NotFound, name, name + ": no such file");
  if (!std::filesystem::is_regular_file(status)) return makeError(ErrorKind::Io, name, name + ": not a regular file");
  std::ifstream stream(file, std::ios::binary);
  std::string text(kMaxSceneFileBytes + 1, '\0');
  if (!stream || (!stream.read(text.data(), static_cast<std::streamsize>(text.size())) && !stream.eof()))
    return makeError(ErrorKind::Io, name, name + ": cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return parseScene(text, name);
} catch (const std::exception& error) {
  return makeError(ErrorKind::Io, "--scene", error.what());
}

Result<Scene> loadScene(std::string_view nameOrFile) {
  for (const ShippedScene& scene : shippedSceneTexts())
    if (scene.name == nameOrFile) return parseScene(scene.toml, fmt::format("{}.toml", scene.name));
  if (nameOrFile.ends_with(".toml")) return loadSceneFile(std::filesystem::path(nameOrFile));
  std::vector<std::string_view> names;
  for (const ShippedScene& scene : shippedSceneTexts()) names.push_back(scene.name);
  const std::string_view near = nearestWord(nameOrFile, names);
  return makeError(
      ErrorKind::NotFound, "--scene",
      fmt::format("no scene {}{}; allowed: {}, or a path that ends in .toml", quotedForMessage(nameOrFile),
                  near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near), fmt::join(names, ", ")));
}

std::vector<std::string> shippedScenes() {
  std::vector<std::string> names;
  for (const ShippedScene& scene : shippedSceneTexts()) names.emplace_back(scene.name);
  return names;
}

}  // namespace terrane
