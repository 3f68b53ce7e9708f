// DracoTemplate: any values on a small tile, in any settings. Where it predicts as libdraco does, its bytes are
// libdraco's; elsewhere libdraco reads the same mesh from both. Layout: speed, normal bits, predictions, kind of tile;
// then offsets (two bytes each), normals and colours (a byte each), the bytes there are over and over.

#include <map>
#include <memory>
#include <tuple>

#include "proto/draco_template.h"
#include "tests/fuzz/sound_mesh.h"
#include "tests/unit/proto/sample_tile.h"

namespace {

using namespace terrane;

TileMesh modelOf(int kind) {
  const test::SampleSettings sample{.path = test::kSamplePaths[static_cast<std::size_t>(kind & 1)],
                                    .cellsPerEdge = 4,
                                    .skirts = (kind & 2) != 0,
                                    .colors = (kind & 4) != 0};
  return test::sampleTile(sample).mesh;
}

struct Learnt {
  TileMesh model;
  std::shared_ptr<const DracoTemplate> coder;
};

/// Learnt once each.
const Learnt& learnt(const DracoSettings& settings, int kind) {
  static std::map<std::tuple<int, int, DracoPrediction, DracoNormals, int>, Learnt> all;
  const auto [found, fresh] =
      all.try_emplace({settings.speed, settings.normalBits, settings.prediction, settings.normals, kind});
  if (fresh) {
    found->second.model = modelOf(kind);
    if (auto coder = DracoTemplate::learn(found->second.model, settings)) found->second.coder = *coder;
  }
  return found->second;
}

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::uint8_t next() { return size_ == 0 ? 0 : data_[at_++ % size_]; }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

void fill(TileMesh& mesh, Bytes bytes) {
  for (auto& offset : mesh.offsets) offset = static_cast<std::uint16_t>(bytes.next() | bytes.next() << 8);
  for (auto& component : mesh.normals) component = static_cast<float>(static_cast<std::int8_t>(bytes.next())) / 128;
  for (auto& color : mesh.colors) color = bytes.next();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  const DracoSettings settings{.speed = data[0] % 11,
                               .normalBits = 2 + data[1] % 15,
                               .prediction = static_cast<DracoPrediction>(data[2] % 3),
                               .normals = static_cast<DracoNormals>(data[2] / 3 % 3)};
  const bool stock =
      settings.prediction == DracoPrediction::StockAtSpeed && settings.normals == DracoNormals::StockAtSpeed;
  const Learnt& of = learnt(settings, data[3] % 8);
  if (!of.coder) return fuzz::require(settings.speed < 2), 0;
  TileMesh mesh = of.model;
  fill(mesh, Bytes(data + 4, size - 4));

  const auto ours = of.coder->encode(mesh), libdracos = encodeDraco(mesh, settings);
  fuzz::require(ours.has_value() == libdracos.has_value());
  if (!ours) return fuzz::require(ours.error().field == libdracos.error().field), 0;
  if (stock) return fuzz::require(ours->bytes == libdracos->bytes), 0;
  const DracoAttributeIds ids{ours->positionId, ours->normalId, ours->colorId, ours->gridId};
  const auto read = decodeDraco(ours->bytes, ids, {}), expected = decodeDraco(libdracos->bytes, ids, {});
  fuzz::require(read.has_value() && expected.has_value());
  fuzz::require(read->offsets == expected->offsets && read->normals == expected->normals &&
                read->colors == expected->colors && read->gridIndices == expected->gridIndices &&
                read->triangles == expected->triangles);
  return 0;
}
