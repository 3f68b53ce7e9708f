// DracoReader against decodeDraco: whatever follows a head that it knows, both give the same mesh, bit for bit, or the
// same error. An input's first byte chooses the head and the rest are the values, so that no mutation is spent on
// heads.

#include <cstring>
#include <vector>

#include "proto/draco_reader.h"
#include "tests/fuzz/draco_heads.h"
#include "tests/fuzz/sound_mesh.h"

namespace {

using namespace terrane;

template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void requireSame(const Result<TileMesh>& expected, const Result<TileMesh>& actual) {
  fuzz::require(expected.has_value() == actual.has_value());
  if (!expected) return fuzz::require(expected.error().text() == actual.error().text());
  fuzz::require(sameBits(expected->offsets, actual->offsets) && sameBits(expected->normals, actual->normals));
  fuzz::require(sameBits(expected->colors, actual->colors) && sameBits(expected->gridIndices, actual->gridIndices));
  fuzz::require(sameBits(expected->triangles, actual->triangles));
}

std::vector<std::uint8_t> joined(std::vector<std::uint8_t> head, std::span<const std::uint8_t> values) {
  head.insert(head.end(), values.begin(), values.end());
  return head;
}

/// A reader that has learnt all heads.
class Experienced {
 public:
  Experienced() {
    for (const fuzz::DracoHead& head : heads)
      for (const auto& values : head.values) (void)reader.decode(joined(head.bytes, values), head.ids, {}).value();
    fuzz::require(reader.counts().byLibdraco == heads.size());
  }
  const std::vector<fuzz::DracoHead> heads = fuzz::dracoHeads();
  DracoReader reader;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Experienced experienced;
  if (size == 0) return 0;
  const fuzz::DracoHead& head = experienced.heads[data[0] % experienced.heads.size()];
  const auto bytes = joined(head.bytes, {data + 1, size - 1});
  requireSame(decodeDraco(bytes, head.ids, {}), experienced.reader.decode(bytes, head.ids, {}));
  return 0;
}
