#pragma once
// A TileMesh as libdraco takes it; shared by what encodes with libdraco and what learns from it. Private to proto.

#include <memory>

#include "proto/draco_mesh.h"

namespace draco {
class EncoderBuffer;
class Mesh;
class MeshEdgebreakerEncoder;
}  // namespace draco

namespace terrane {

/// Errors: InvalidArgument, as encodeDraco has them.
Result<void> checkDracoSettings(const DracoSettings& settings);
Result<void> checkDracoMesh(const TileMesh& mesh);

class DracoInput {
 public:
  /// Precondition: checkDracoMesh passed.
  explicit DracoInput(const TileMesh& mesh);
  ~DracoInput();
  DracoInput(const DracoInput&) = delete;
  DracoInput& operator=(const DracoInput&) = delete;

  const draco::Mesh& mesh() const noexcept { return *mesh_; }
  /// Attribute ids only.
  const DracoBuffer& ids() const noexcept { return ids_; }

  /// Errors: Internal (libdraco refused).
  Result<void> encode(draco::MeshEdgebreakerEncoder& encoder, const DracoSettings& settings,
                      draco::EncoderBuffer& out) const;

 private:
  std::unique_ptr<draco::Mesh> mesh_;
  DracoBuffer ids_;
};

}  // namespace terrane
