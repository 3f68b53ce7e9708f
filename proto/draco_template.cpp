#include "proto/draco_template.h"

#include <array>
#include <exception>
#include <span>

#include "proto/draco_input.h"
#include "proto/little_endian.h"
#include "proto/octahedron.h"
#include "proto/rans_bits.h"
#include "proto/symbol_encoder.h"

namespace terrane {
namespace {

/// As Draco numbers what it does to a residual.
enum class Transform : std::uint8_t { Wrap = 1, CanonicalOctahedron = 3 };

/// Working memory of one encode.
struct Attribute {
  std::vector<std::uint32_t> symbols;
  SymbolEncoder encoder;
};
struct Scratch {
  ResidualScratch residuals;
  NormalScratch normals;
  Attribute positions, directions, colors;
};
Scratch& scratchOfThread() {
  thread_local Scratch scratch;
  return scratch;
}

void append(const std::vector<std::uint8_t>& bytes, std::vector<std::uint8_t>& out) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

template <class Prediction>
void appendSymbols(Prediction prediction, Transform transform, const SymbolEncoder& symbols,
                   std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(prediction));
  out.push_back(static_cast<std::uint8_t>(transform));
  out.push_back(1);  // entropy coded
  symbols.append(out);
}

/// What encodeDraco says of a mesh that is not as encodeFitting needs it.
Error refusalOf(const TileMesh& mesh) {
  if (auto checked = checkDracoMesh(mesh); !checked) return checked.error();
  return makeError(ErrorKind::Internal, "draco", "refused to encode the symbols of a tile");
}

}  // namespace

bool DracoTemplate::fits(const TileMesh& mesh) const noexcept {
  return mesh.colors.empty() != colors_ && mesh.gridIndices == gridIndices_ && mesh.triangles == triangles_;
}

Result<DracoBuffer> DracoTemplate::encode(const TileMesh& mesh) const {
  DracoBuffer out;
  if (auto encoded = encodeInto(mesh, out); !encoded) return encoded.error();
  return out;
}

Result<void> DracoTemplate::encodeInto(const TileMesh& mesh, DracoBuffer& out) const {
  if (!fits(mesh)) {
    Result<DracoBuffer> encoded = encodeDraco(mesh, settings_);
    if (!encoded) return encoded.error();
    out = std::move(*encoded);
    return {};
  }
  try {
    return encodeFitting(mesh, out);
  } catch (const std::exception& e) {
    return makeError(ErrorKind::Internal, "draco", e.what());
  }
}

void DracoTemplate::appendIntegers(const ValueRange& range, const SymbolEncoder& symbols,
                                   std::vector<std::uint8_t>& out) const {
  appendSymbols(prediction_, Transform::Wrap, symbols, out);
  append(parallelsUsed_, out);
  appendLittleEndian(range.least, out);
  appendLittleEndian(range.greatest, out);
}

Result<void> DracoTemplate::encodeFitting(const TileMesh& mesh, DracoBuffer& out) const {
  const std::size_t numbers = 3 * order_.size();
  Scratch& scratch = scratchOfThread();
  Attribute &positions = scratch.positions, &directions = scratch.directions, &colors = scratch.colors;
  if (mesh.offsets.size() != numbers || mesh.normals.size() != numbers || (colors_ && mesh.colors.size() != numbers) ||
      !gatherNormals(mesh.normals, order_, scratch.normals))
    return refusalOf(mesh);

  const ValueRange offsetRange =
      residualSymbols(std::span(mesh.offsets), 3, order_, prediction_, scratch.residuals, positions.symbols);
  if (normalPrediction_ == NormalPrediction::Geometric)
    geometricSymbols(settings_.normalBits, scratch.residuals.values, order_, scratch.normals, directions.symbols);
  else
    differenceSymbols(settings_.normalBits, order_, scratch.normals, directions.symbols);
  ValueRange colorRange;
  if (colors_)
    colorRange = residualSymbols(std::span(mesh.colors), 3, order_, prediction_, scratch.residuals, colors.symbols);

  const int level = 10 - settings_.speed;
  if (!positions.encoder.begin(positions.symbols, 3, level) ||
      !directions.encoder.begin(directions.symbols, 2, level) ||
      (colors_ && !colors.encoder.begin(colors.symbols, 3, level)))
    return refusalOf(mesh);
  const std::array<RansStream*, 3> streams{&positions.encoder.stream(), &directions.encoder.stream(),
                                           &colors.encoder.stream()};
  encodeStreams(std::span(streams).first(colors_ ? 3 : 2));

  std::vector<std::uint8_t> bytes = std::move(out.bytes);
  out = ids_;
  bytes.clear();
  append(head_, bytes);
  appendIntegers(offsetRange, positions.encoder, bytes);
  appendSymbols(normalPrediction_, Transform::CanonicalOctahedron, directions.encoder, bytes);
  const OctahedralGrid grid(settings_.normalBits);
  appendLittleEndian(grid.modulus(), bytes);
  appendLittleEndian(grid.center, bytes);
  if (normalPrediction_ == NormalPrediction::Geometric) appendRansBits(scratch.normals.flips, bytes);
  if (colors_) appendIntegers(colorRange, colors.encoder, bytes);
  append(grid_, bytes);
  append(tail_, bytes);
  out.bytes = std::move(bytes);
  return {};
}

}  // namespace terrane
