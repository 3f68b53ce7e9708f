#pragma once
// Encodes meshes that share one connectivity several times faster than libdraco does, with the same bytes. All tiles of
// a kind have the same triangles, so what an edgebreaker stream says of them, and the order in which it visits the
// vertices, are learnt once from libdraco itself; a tile then costs its predictions and libdraco's entropy coding.
// Immutable once learnt; thread-safe.

#include <cstdint>
#include <memory>
#include <vector>

#include "proto/draco_mesh.h"

namespace terrane {

class DracoTemplate {
 public:
  /// Learns from the model's triangles, grid indices and whether it has colours; its offsets, normals and colours do
  /// not matter. Null where it could not promise libdraco's bytes: a speed below 4 or above 7 (other predictions), a
  /// mesh that encodeDraco refuses, or a libdraco that encodes noise on this mesh otherwise than expected.
  static std::shared_ptr<const DracoTemplate> learn(const TileMesh& model, const DracoSettings& settings);

  /// The bytes that encodeDraco gives, and its errors. A mesh of another connectivity goes to encodeDraco.
  Result<DracoBuffer> encode(const TileMesh& mesh) const;

  /// Whether mesh has the connectivity, grid indices and attributes of the model.
  bool fits(const TileMesh& mesh) const noexcept;

 private:
  /// Entries (vertices in the order of the stream) that predict another: next + previous - opposite.
  struct Parallelogram {
    std::uint32_t next, previous, opposite;
  };
  class Learner;

  DracoTemplate() = default;
  Result<DracoBuffer> encodeFitting(const TileMesh& mesh) const;

  DracoSettings settings_;
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint16_t> gridIndices_;
  bool colors_ = false;
  DracoBuffer ids_;                            ///< without bytes
  std::vector<std::uint8_t> head_, tail_;      ///< of every stream
  std::vector<std::uint8_t> grid_;             ///< the grid indices' part
  std::vector<std::uint32_t> pointOfEntry_;    ///< which vertex is entry i
  std::vector<Parallelogram> parallelograms_;  ///< of entries 1 and up
};

}  // namespace terrane
