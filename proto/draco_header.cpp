#include "proto/draco_header.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace terrane {
namespace {

constexpr std::array<std::uint8_t, 5> kMagic{'D', 'R', 'A', 'C', 'O'};
constexpr std::size_t kFixedBytes = 11;
constexpr std::uint8_t kTriangularMesh = 1;
constexpr std::uint8_t kEdgebreaker = 1;
constexpr std::uint8_t kTraversalStandard = 0;
constexpr std::uint8_t kTraversalValence = 2;

Error malformed(const char* message) { return makeError(ErrorKind::Malformed, "draco", message); }
Error unsupported(const char* message) { return makeError(ErrorKind::Unsupported, "draco", message); }

/// Little-endian base 128. Refuses what does not fit 32 bits.
bool readVarint(std::span<const std::uint8_t>& rest, std::uint32_t& value) {
  std::uint64_t sum = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    if (rest.empty()) return false;
    const std::uint8_t byte = rest.front();
    rest = rest.subspan(1);
    sum |= static_cast<std::uint64_t>(byte & 0x7Fu) << shift;
    if ((byte & 0x80u) == 0) {
      value = static_cast<std::uint32_t>(sum);
      return sum <= 0xFFFFFFFFu;
    }
  }
  return false;
}

}  // namespace

Result<DracoHeader> readDracoHeader(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kFixedBytes + 1) return malformed("shorter than a Draco header");
  if (!std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) return malformed("does not begin with DRACO");
  if (bytes[5] != 2 || bytes[6] != 2) return unsupported("only bitstream version 2.2 is read");
  if (bytes[7] != kTriangularMesh) return unsupported("not a triangle mesh");
  if (bytes[8] != kEdgebreaker) return unsupported("only the edgebreaker method is read");
  if (bytes[9] != 0 || bytes[10] != 0) return unsupported("metadata is not read");
  if (bytes[11] != kTraversalStandard && bytes[11] != kTraversalValence)
    return unsupported("unknown edgebreaker traversal");

  DracoHeader header;
  auto rest = bytes.subspan(kFixedBytes + 1);
  if (!readVarint(rest, header.vertexCount) || !readVarint(rest, header.triangleCount))
    return malformed("cut in its counts");
  if (rest.empty()) return malformed("cut in its counts");
  header.attributeConnectivities = rest.front();
  rest = rest.subspan(1);
  if (!readVarint(rest, header.symbolCount) || !readVarint(rest, header.splitSymbolCount))
    return malformed("cut in its counts");
  if (header.symbolCount > header.triangleCount) return malformed("more symbols than triangles");
  if (header.splitSymbolCount > header.symbolCount) return malformed("more split symbols than symbols");
  if (header.vertexCount > 3ull * header.triangleCount) return malformed("more vertices than corners");
  return header;
}

}  // namespace terrane
