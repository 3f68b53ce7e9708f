#pragma once
// Encodes meshes that share one connectivity many times faster than libdraco does, with the same bytes. All tiles of
// a kind have the same triangles, so what an edgebreaker stream says of them, and the order in which it visits the
// vertices, are learnt once from libdraco itself; a tile then costs its predictions and its entropy coding. Immutable
// once learnt; thread-safe. Keeps working memory for each thread that encodes.

#include <cstdint>
#include <memory>
#include <vector>

#include "proto/draco_mesh.h"
#include "proto/entry_order.h"
#include "proto/normal_symbols.h"
#include "proto/residual_symbols.h"

namespace terrane {

class DracoTemplate {
 public:
  /// Learns from the model's triangles, grid indices and whether it has colours; its offsets, normals and colours do
  /// not matter. Errors say why libdraco must do it alone: Unsupported (libdraco's predictions below speed 2, which
  /// depend on the data; more triangles around a vertex than kMostFacesAroundEntry), InvalidArgument (what encodeDraco
  /// refuses), Internal (a libdraco that encodes the model or noise on it otherwise than expected or, where the
  /// settings choose their own predictions, does not decode it exactly).
  static Result<std::shared_ptr<const DracoTemplate>> learn(const TileMesh& model, const DracoSettings& settings);

  /// The bytes that encodeDraco gives, and its errors; with predictions of its own, other bytes of the same mesh. A
  /// mesh of another connectivity goes to encodeDraco.
  Result<DracoBuffer> encode(const TileMesh& mesh) const;
  /// The same into out, whose memory is used again. After an error out holds nothing of use.
  Result<void> encodeInto(const TileMesh& mesh, DracoBuffer& out) const;

  /// Whether mesh has the connectivity, grid indices and attributes of the model.
  bool fits(const TileMesh& mesh) const noexcept;

 private:
  class Learner;

  DracoTemplate() = default;
  Result<void> encodeFitting(const TileMesh& mesh, DracoBuffer& out) const;
  void appendIntegers(const ValueRange& range, const class SymbolEncoder& symbols,
                      std::vector<std::uint8_t>& out) const;

  DracoSettings settings_;
  IntegerPrediction prediction_ = IntegerPrediction::Parallelogram;
  NormalPrediction normalPrediction_ = NormalPrediction::Difference;
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint16_t> gridIndices_;
  bool colors_ = false;
  DracoBuffer ids_;                          ///< without bytes
  std::vector<std::uint8_t> head_, tail_;    ///< of every stream
  std::vector<std::uint8_t> grid_;           ///< the grid indices' part
  std::vector<std::uint8_t> parallelsUsed_;  ///< what multi-parallelograms say of each integer attribute: all are used
  EntryOrder order_;
};

}  // namespace terrane
