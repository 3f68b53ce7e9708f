#include <draco/compression/mesh/mesh_edgebreaker_encoder.h>

#include <exception>

#include "proto/draco_header.h"
#include "proto/draco_input.h"
#include "proto/draco_mesh.h"

namespace terrane {
namespace {

Result<DracoBuffer> encodeChecked(const TileMesh& mesh, const DracoSettings& settings) {
  const DracoInput input(mesh);
  draco::MeshEdgebreakerEncoder encoder;
  draco::EncoderBuffer buffer;
  if (auto encoded = input.encode(encoder, settings, buffer); !encoded) return encoded.error();

  DracoBuffer out = input.ids();
  const auto* first = reinterpret_cast<const std::uint8_t*>(buffer.data());
  out.bytes.assign(first, first + buffer.size());
  const auto header = readDracoHeader(out.bytes);
  if (!header)
    return makeError(ErrorKind::Internal, "draco",
                     "wrote a header that Terrane does not read: " + header.error().message);
  out.vertexCount = header->vertexCount;
  out.triangleCount = header->triangleCount;
  if (out.vertexCount != mesh.vertexCount() || out.triangleCount != mesh.triangles.size() / 3) {
    return makeError(ErrorKind::InvalidArgument, "triangles",
                     "a vertex without triangle, a triangle with equal corners, or a vertex where sheets touch");
  }
  return out;
}

}  // namespace

Result<DracoBuffer> encodeDraco(const TileMesh& mesh, const DracoSettings& settings) {
  if (auto checked = checkDracoSettings(settings); !checked) return checked.error();
  if (auto checked = checkDracoMesh(mesh); !checked) return checked.error();
  try {
    return encodeChecked(mesh, settings);
  } catch (const std::exception& e) {
    return makeError(ErrorKind::Internal, "draco", e.what());
  }
}

}  // namespace terrane
