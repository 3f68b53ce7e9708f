#pragma once
// Builds the tiles of one body in the one scheme that it is served in: grid directions -> field -> lattice -> mesh with
// skirts -> Draco -> GLB. A tile is a pure function of (body, path, wire settings): no clock, no thread order. build is
// const and thread-safe; each thread keeps its own scratch.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/result.h"
#include "common/scene/scene.h"
#include "proto/draco_mesh.h"
#include "proto/scene_json.h"
#include "proto/tile_mesh.h"
#include "server/fields/height_field.h"

namespace terrane {

/// Raise when the bytes of any tile change for reasons that no setting shows: the golden hashes refuse a change without
/// it.
inline constexpr int kGeneratorVersion = 9;

struct WireSettings {
  int cellsPerEdge = 64;  ///< a power of two, 2 to 128
  DracoSettings draco;
};

/// What encodes a body's tiles, to the same bytes: a template learnt from libdraco once, or libdraco for each tile.
enum class DracoCoder : std::uint8_t { Fast, Stock };

struct BuildTimes {
  double fieldMs = 0, meshMs = 0, dracoMs = 0, glbMs = 0;
};

struct BuiltTile {
  std::vector<std::uint8_t> glb;
  BuildTimes times;
};

class TileBuilder {
 public:
  /// The scheme is the first of the body's, the cube if it names none.
  TileBuilder(Body body, WireSettings wire, SimdPath simd, DracoCoder coder = DracoCoder::Fast);
  ~TileBuilder();
  TileBuilder(TileBuilder&&) noexcept;

  const Body& body() const noexcept;
  const BodyInfo& info() const noexcept;  ///< as scene.json gives it, with the revision
  /// Why libdraco encodes every tile; empty where a template does.
  const std::string& whyStockDraco() const noexcept;

  /// The mesh before encoding. Errors: InvalidArgument (path deeper than the body's cap, wrong scheme), TooLarge
  /// (relief beyond what 16 bits of the lattice hold: more than about one tile's width within a tile, which no lunar
  /// tile comes near).
  Result<Tile> buildMesh(const FacePath& path, BuildTimes* times = nullptr) const;
  Result<BuiltTile> build(const FacePath& path) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace terrane
