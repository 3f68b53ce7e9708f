// decodeTile. Half of the mutations are made inside the chunks and packed again, or the container's lengths would keep
// most of them from ever reaching the JSON and the Draco data.

#include <cstring>
#include <string>
#include <vector>

#include "proto/glb_container.h"
#include "proto/gltf_tile.h"
#include "tests/fuzz/sound_mesh.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maxSize);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t maxSize,
                                               unsigned seed) {
  const auto chunks = terrane::unpackGlb({data, size});
  if (!chunks || seed % 2 == 0) return LLVMFuzzerMutate(data, size, maxSize);
  std::string json(chunks->json);
  std::vector<std::uint8_t> bin(chunks->bin.begin(), chunks->bin.end());
  if (seed % 4 == 1) {
    std::vector<std::uint8_t> text(json.begin(), json.end());
    text.resize(2 * text.size() + 16);
    text.resize(LLVMFuzzerMutate(text.data(), json.size(), text.size()));
    json.assign(text.begin(), text.end());
  } else {
    const std::size_t before = bin.size();
    bin.resize(2 * before + 16);
    bin.resize(LLVMFuzzerMutate(bin.data(), before, bin.size()));
  }
  const auto glb = terrane::packGlb(json, bin);
  if (glb.size() > maxSize) return LLVMFuzzerMutate(data, size, maxSize);
  std::memcpy(data, glb.data(), glb.size());
  return glb.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const terrane::DecodeLimits limits;
  const auto tile = terrane::decodeTile({data, size}, limits);
  if (!tile) {
    terrane::fuzz::require(!tile.error().field.empty());
    return 0;
  }
  terrane::fuzz::requireSound(tile->mesh, limits);
  const auto edge = static_cast<std::size_t>(tile->metadata.cellsPerEdge) + 1;
  for (const std::uint16_t index : tile->mesh.gridIndices) terrane::fuzz::require(index < edge * edge + 4 * edge);
  return 0;
}
