#include "server/scenes/scene_text.h"

#include <fmt/format.h>

#include <cstddef>

#include "server/scenes/scene_file.h"

namespace terrane {
namespace {

/// The number of bytes of the UTF-8 sequence at the start of text, or 0.
std::size_t utf8SequenceBytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto continues = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return continues(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    if (!continues(1) || !continues(2)) return 0;
    const bool overlongOrSurrogate = (lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) > 0x9F);
    return overlongOrSurrogate ? 0 : 3;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    if (!continues(1) || !continues(2) || !continues(3)) return 0;
    const bool outside = (lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) > 0x8F);
    return outside ? 0 : 4;
  }
  return 0;
}

}  // namespace

std::optional<Error> checkSceneText(std::string_view toml, std::string_view fileName) {
  if (toml.size() > kMaxSceneFileBytes)
    return makeError(ErrorKind::TooLarge, "",
                     fmt::format("{}: the file has more than {} bytes; allowed: at most {}", fileName,
                                 kMaxSceneFileBytes, kMaxSceneFileBytes));
  std::size_t line = 1, lineBytes = 0;
  for (std::size_t i = 0; i < toml.size();) {
    const std::size_t bytes = utf8SequenceBytes(toml.substr(i, 4));
    if (bytes == 0)
      return makeError(ErrorKind::Malformed, "",
                       fmt::format("{}:{}: not UTF-8 text; allowed: UTF-8 without other bytes", fileName, line));
    lineBytes += bytes;
    if (toml[i] == '\n') {
      ++line;
      lineBytes = 0;
    }
    if (lineBytes > kMaxSceneLineBytes)
      return makeError(
          ErrorKind::TooLarge, "",
          fmt::format("{}:{}: the line is too long; allowed: at most {} bytes", fileName, line, kMaxSceneLineBytes));
    i += bytes;
  }
  return std::nullopt;
}

}  // namespace terrane
