#include "proto/glb_container.h"

#include <cstddef>
#include <limits>

namespace terrane {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8, kAlignment = 4;

std::size_t padded(std::size_t size) { return (size + kAlignment - 1) / kAlignment * kAlignment; }

void append(std::vector<std::uint8_t>& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

std::uint32_t readWord(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

Error malformed(const char* field, const char* message) { return makeError(ErrorKind::Malformed, field, message); }

/// Takes a chunk of the given type off the front of rest.
Result<std::span<const std::uint8_t>> takeChunk(std::span<const std::uint8_t>& rest, std::uint32_t type,
                                                const char* field) {
  if (rest.size() < kChunkHeaderBytes) return malformed(field, "no such chunk");
  const std::uint32_t length = readWord(rest, 0);
  if (readWord(rest, 4) != type) return malformed(field, "another chunk is in its place");
  rest = rest.subspan(kChunkHeaderBytes);
  if (length % kAlignment != 0) return malformed(field, "chunk length is not a multiple of 4");
  if (length > rest.size()) return malformed(field, "chunk is longer than the file");
  const auto chunk = rest.first(length);
  rest = rest.subspan(length);
  return chunk;
}

}  // namespace

std::vector<std::uint8_t> packGlb(std::string_view json, std::span<const std::uint8_t> bin) {
  const std::size_t jsonBytes = padded(json.size()), binBytes = padded(bin.size());
  const std::size_t total = kHeaderBytes + 2 * kChunkHeaderBytes + jsonBytes + binBytes;
  std::vector<std::uint8_t> glb;
  glb.reserve(total);
  append(glb, kMagic);
  append(glb, 2);
  append(glb, total);
  append(glb, jsonBytes);
  append(glb, kJsonChunk);
  glb.insert(glb.end(), json.begin(), json.end());
  glb.resize(glb.size() + jsonBytes - json.size(), ' ');
  append(glb, binBytes);
  append(glb, kBinChunk);
  glb.insert(glb.end(), bin.begin(), bin.end());
  glb.resize(total, 0);
  return glb;
}

Result<GlbChunks> unpackGlb(std::span<const std::uint8_t> glb) {
  if (glb.size() < kHeaderBytes) return malformed("header", "shorter than a GLB header");
  if (readWord(glb, 0) != kMagic) return malformed("header", "does not begin with glTF");
  if (readWord(glb, 4) != 2) return makeError(ErrorKind::Unsupported, "header", "only GLB version 2 is read");
  if (readWord(glb, 8) != glb.size()) return malformed("header", "says another length than the file has");
  auto rest = glb.subspan(kHeaderBytes);
  const auto json = takeChunk(rest, kJsonChunk, "json");
  if (!json) return json.error();
  const auto bin = takeChunk(rest, kBinChunk, "bin");
  if (!bin) return bin.error();
  if (!rest.empty()) return malformed("bin", "more bytes follow");
  return GlbChunks{std::string_view(reinterpret_cast<const char*>(json->data()), json->size()), *bin};
}

}  // namespace terrane
