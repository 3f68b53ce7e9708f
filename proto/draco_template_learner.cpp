#include <draco/compression/mesh/mesh_edgebreaker_encoder.h>

#include <algorithm>
#include <array>
#include <exception>
#include <random>
#include <span>
#include <string>

#include "proto/draco_input.h"
#include "proto/draco_template.h"
#include "proto/little_endian.h"
#include "proto/rans_bits.h"
#include "proto/symbol_encoder.h"

namespace terrane {
namespace {

/// After all values: the quantisation of positions (origin 3 x 4 bytes, range 4, bits 1) and of normals (bits 1).
constexpr std::size_t kTailBytes = 18;
constexpr std::size_t kMostParallelograms = 4;

/// libdraco's encoder, which tells where the values begin and in which order they come.
class ListeningEncoder : public draco::MeshEdgebreakerEncoder {
 public:
  std::size_t headBytes = 0;

 protected:
  bool EncodeAllAttributes() override {
    headBytes = buffer()->size();
    return draco::MeshEdgebreakerEncoder::EncodeAllAttributes();
  }
};

/// Data that takes no pattern: all that an encoder may choose by data it meets in this or in smooth ground.
TileMesh noiseOn(const TileMesh& model) {
  TileMesh noise = model;
  std::minstd_rand random(1);
  const auto draw = [&] { return static_cast<std::uint32_t>(random()) >> 4; };
  for (auto& offset : noise.offsets) offset = static_cast<std::uint16_t>(draw());
  for (auto& color : noise.colors) color = static_cast<std::uint8_t>(draw());
  for (auto& component : noise.normals) component = static_cast<float>(draw() % 2001) - 1000.5f;
  return noise;
}

Error differs(const char* what) { return makeError(ErrorKind::Internal, "draco", what); }

/// libdraco's predictions at a speed of 2 or more.
IntegerPrediction stockPrediction(int speed) noexcept {
  return speed >= 8 ? IntegerPrediction::Difference : IntegerPrediction::Parallelogram;
}
NormalPrediction stockNormals(int speed) noexcept {
  return speed >= 4 ? NormalPrediction::Difference : NormalPrediction::Geometric;
}

IntegerPrediction predictionOf(const DracoSettings& settings) noexcept {
  if (settings.prediction == DracoPrediction::StockAtSpeed) return stockPrediction(settings.speed);
  return settings.prediction == DracoPrediction::Parallelogram ? IntegerPrediction::Parallelogram
                                                               : IntegerPrediction::MultiParallelogram;
}
NormalPrediction normalsOf(const DracoSettings& settings) noexcept {
  if (settings.normals == DracoNormals::StockAtSpeed) return stockNormals(settings.speed);
  return settings.normals == DracoNormals::Delta ? NormalPrediction::Difference : NormalPrediction::Geometric;
}

/// Walks a mesh's corners in the order of a stream.
class OrderReader {
 public:
  OrderReader(const draco::Mesh& mesh, const draco::MeshAttributeIndicesEncodingData& order,
              const draco::CornerTable& corners)
      : mesh_(mesh), order_(order), corners_(corners) {}

  EntryOrder read() const {
    EntryOrder out;
    const auto& cornerOfEntry = order_.encoded_attribute_value_index_to_corner_map;
    out.aroundBegin.push_back(0);
    for (std::uint32_t entry = 0; entry < cornerOfEntry.size(); ++entry) {
      out.pointOfEntry.push_back(mesh_.CornerToPointId(cornerOfEntry[entry]).value());
      if (entry > 0) {
        Parallelogram by{entry - 1, entry - 1, entry - 1};
        takeParallelogram(cornerOfEntry[entry], entry, by);
        out.parallelograms.push_back(by);
        takeAround(cornerOfEntry[entry], entry, out.around);
      }
      out.aroundBegin.push_back(static_cast<std::uint32_t>(out.around.size()));
    }
    readFaces(out);
    return out;
  }

 private:
  std::uint32_t entryAt(draco::CornerIndex corner) const {
    return static_cast<std::uint32_t>(
        order_.vertex_to_encoded_attribute_value_index_map[corners_.Vertex(corner).value()]);
  }

  /// Across the triangle of corner, if all of it comes before entry.
  bool takeParallelogram(draco::CornerIndex corner, std::uint32_t entry, Parallelogram& out) const {
    const draco::CornerIndex across = corners_.Opposite(corner);
    if (across == draco::kInvalidCornerIndex) return false;
    const Parallelogram found{entryAt(corners_.Next(across)), entryAt(corners_.Previous(across)), entryAt(across)};
    if (std::max({found.next, found.previous, found.opposite}) >= entry) return false;
    out = found;
    return true;
  }

  /// As libdraco's decoder meets them: leftwards from the entry's own corner and, from a border on, rightwards.
  void takeAround(draco::CornerIndex first, std::uint32_t entry, std::vector<Parallelogram>& out) const {
    const std::size_t full = out.size() + kMostParallelograms;
    bool left = true;
    for (draco::CornerIndex corner = first; corner != draco::kInvalidCornerIndex;) {
      Parallelogram found;
      if (takeParallelogram(corner, entry, found)) out.push_back(found);
      if (out.size() == full) return;
      corner = left ? corners_.SwingLeft(corner) : corners_.SwingRight(corner);
      if (corner == first) return;
      if (corner == draco::kInvalidCornerIndex && left) {
        left = false;
        corner = corners_.SwingRight(first);
      }
    }
  }

  /// In the order of their last entries, so that what lies together is read together.
  void readFaces(EntryOrder& out) const {
    std::vector<std::uint32_t> around(out.size(), 0);
    for (std::uint32_t face = 0; face < mesh_.num_faces(); ++face) {
      std::array<std::uint32_t, 3> entries{};
      for (std::uint32_t k = 0; k < 3; ++k) {
        entries[k] = entryAt(draco::CornerIndex(3 * face + k));
        out.mostFacesAroundEntry = std::max(out.mostFacesAroundEntry, ++around[entries[k]]);
      }
      out.faces.push_back(entries);
    }
    std::ranges::sort(out.faces, {}, [](const auto& face) { return *std::ranges::max_element(face); });
  }

  const draco::Mesh& mesh_;
  const draco::MeshAttributeIndicesEncodingData& order_;
  const draco::CornerTable& corners_;
};

/// For each number of parallelograms, one to four: how many lie around entries that have so many, and for each that it
/// is used (0).
std::vector<std::uint8_t> allParallelogramsUsed(const EntryOrder& order) {
  std::array<std::size_t, kMostParallelograms + 1> count{};
  for (std::size_t entry = 0; entry < order.size(); ++entry) {
    const std::size_t around = order.aroundBegin[entry + 1] - order.aroundBegin[entry];
    count[around] += around;
  }
  std::vector<std::uint8_t> out;
  for (std::size_t around = 1; around <= kMostParallelograms; ++around) {
    appendVarint(count[around], out);
    if (count[around] > 0) appendRansBits(std::vector<std::uint8_t>(count[around], 0), out);
  }
  return out;
}

bool sameDecoded(const DracoBuffer& ours, const DracoBuffer& stock) {
  const DracoAttributeIds ids{stock.positionId, stock.normalId, stock.colorId, stock.gridId};
  const auto decoded = [&](const DracoBuffer& buffer) {
    return decodeDraco(buffer.bytes, ids, {stock.vertexCount, stock.triangleCount, buffer.bytes.size()});
  };
  const Result<TileMesh> a = decoded(ours), b = decoded(stock);
  return a.has_value() && b.has_value() && a->offsets == b->offsets && a->normals == b->normals &&
         a->colors == b->colors && a->gridIndices == b->gridIndices && a->triangles == b->triangles;
}

}  // namespace

/// Fills a template from what libdraco wrote.
class DracoTemplate::Learner {
 public:
  static Result<std::shared_ptr<const DracoTemplate>> learn(const TileMesh& model, const DracoSettings& settings) {
    const Result<DracoBuffer> smooth = encodeDraco(model, settings);
    if (!smooth) return smooth.error();
    const std::shared_ptr<DracoTemplate> learnt(new DracoTemplate);
    learnt->settings_ = settings;
    learnt->prediction_ = predictionOf(settings);
    learnt->normalPrediction_ = normalsOf(settings);
    learnt->triangles_ = model.triangles;
    learnt->gridIndices_ = model.gridIndices;
    learnt->colors_ = !model.colors.empty();
    learnt->ids_ = *smooth;
    learnt->ids_.bytes.clear();
    const TileMesh noise = noiseOn(model);
    DracoBuffer ofNoise = learnt->ids_;
    if (auto listened = listen(noise, *learnt, ofNoise.bytes); !listened) return listened.error();
    if (!agrees(*learnt, model, *smooth)) return differs("libdraco encodes the model otherwise than expected");
    if (!agrees(*learnt, noise, ofNoise)) return differs("libdraco encodes noise otherwise than expected");
    return std::shared_ptr<const DracoTemplate>(learnt);
  }

 private:
  /// Where libdraco predicts as the template does, by its bytes; elsewhere by what it reads.
  static bool agrees(const DracoTemplate& learnt, const TileMesh& mesh, const DracoBuffer& stock) {
    DracoBuffer ours;
    if (!learnt.encodeFitting(mesh, ours)) return false;
    const int speed = learnt.settings_.speed;
    const bool same =
        speed >= 2 && learnt.prediction_ == stockPrediction(speed) && learnt.normalPrediction_ == stockNormals(speed);
    return same ? ours.bytes == stock.bytes : sameDecoded(ours, stock);
  }

  /// stream: what libdraco wrote.
  static Result<void> listen(const TileMesh& mesh, DracoTemplate& out, std::vector<std::uint8_t>& stream) {
    const DracoInput input(mesh);
    ListeningEncoder encoder;
    draco::EncoderBuffer buffer;
    if (auto encoded = input.encode(encoder, out.settings_, buffer); !encoded) return encoded.error();
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(buffer.data());
    stream.assign(bytes, bytes + buffer.size());
    if (buffer.size() < encoder.headBytes + kTailBytes) return differs("libdraco's stream ends before it is due to");
    out.head_.assign(bytes, bytes + encoder.headBytes);
    out.tail_.assign(bytes + buffer.size() - kTailBytes, bytes + buffer.size());

    const auto* order = encoder.GetAttributeEncodingData(out.ids_.positionId);
    const draco::CornerTable* corners = encoder.GetCornerTable();
    if (order == nullptr || corners == nullptr) return differs("libdraco does not tell the order of its values");
    out.order_ = OrderReader(input.mesh(), *order, *corners).read();
    if (out.order_.size() != mesh.vertexCount()) return differs("libdraco writes a vertex more or less than once");
    if (out.order_.mostFacesAroundEntry > kMostFacesAroundEntry)
      return makeError(ErrorKind::Unsupported, "triangles",
                       "more than " + std::to_string(kMostFacesAroundEntry) + " around a vertex");
    if (out.prediction_ == IntegerPrediction::MultiParallelogram)
      out.parallelsUsed_ = allParallelogramsUsed(out.order_);
    return writeGrid(mesh, out);
  }

  static Result<void> writeGrid(const TileMesh& mesh, DracoTemplate& out) {
    ResidualScratch scratch;
    std::vector<std::uint32_t> symbols;
    const ValueRange range =
        residualSymbols(std::span(mesh.gridIndices), 1, out.order_, out.prediction_, scratch, symbols);
    SymbolEncoder encoder;
    if (!encoder.begin(symbols, 1, 10 - out.settings_.speed)) return differs("grid indices cannot be coded");
    RansStream* const stream[] = {&encoder.stream()};
    encodeStreams(stream);
    out.appendIntegers(range, encoder, out.grid_);
    return {};
  }
};

Result<std::shared_ptr<const DracoTemplate>> DracoTemplate::learn(const TileMesh& model,
                                                                  const DracoSettings& settings) {
  if (settings.speed < 2 &&
      (settings.prediction == DracoPrediction::StockAtSpeed || settings.normals == DracoNormals::StockAtSpeed))
    return makeError(ErrorKind::Unsupported, "speed", "libdraco's predictions below speed 2 depend on the data");
  try {
    return Learner::learn(model, settings);
  } catch (const std::exception& e) {
    return makeError(ErrorKind::Internal, "draco", e.what());
  }
}

}  // namespace terrane
