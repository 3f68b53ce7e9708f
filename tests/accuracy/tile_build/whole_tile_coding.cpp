#include "tests/accuracy/tile_build/whole_tile_coding.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "proto/draco_reader.h"
#include "tests/bench/measure.h"

namespace terrane::accuracy {
namespace {

/// Vertices come back in another order.
double worstOffsetSteps(const TileMesh& encoded, const TileMesh& decoded) {
  std::vector<std::size_t> byGrid(65536, encoded.vertexCount());
  for (std::size_t i = 0; i < encoded.vertexCount(); ++i) byGrid[encoded.gridIndices[i]] = i;
  double worst = decoded.vertexCount() == encoded.vertexCount() ? 0 : INFINITY;
  for (std::size_t i = 0; i < decoded.vertexCount(); ++i) {
    const std::size_t from = byGrid[decoded.gridIndices[i]];
    if (from == encoded.vertexCount()) return INFINITY;
    for (std::size_t axis = 0; axis < 3; ++axis)
      worst = std::max(worst, std::fabs(static_cast<double>(decoded.offsets[3 * i + axis]) -
                                        static_cast<double>(encoded.offsets[3 * from + axis])));
  }
  return worst;
}

}  // namespace

WholeTileCoding codeWholeTile(const Tile& tile, const DracoSettings& settings, const DracoTemplate* learnt,
                              int rounds) {
  DracoBuffer stream;
  TileMesh decoded;
  DracoReader reader;
  std::vector<double> encodeMs, decodeMs;
  for (int round = 0; round <= rounds; ++round) {  // the first finds cold memory, and a reader that knows no tile
    encodeMs.push_back(bench::milliseconds([&] {
      if (learnt != nullptr)
        learnt->encodeInto(tile.mesh, stream).value();
      else
        stream = encodeDraco(tile.mesh, settings).value();
    }));
    const DracoAttributeIds ids{stream.positionId, stream.normalId, stream.colorId, stream.gridId};
    decodeMs.push_back(bench::milliseconds([&] {
      decoded = (learnt != nullptr ? reader.decode(stream.bytes, ids, {}) : decodeDraco(stream.bytes, ids, {})).value();
    }));
  }
  encodeMs.erase(encodeMs.begin());
  decodeMs.erase(decodeMs.begin());
  return {bench::median(encodeMs), bench::median(decodeMs), static_cast<double>(stream.bytes.size()) / 1024,
          worstOffsetSteps(tile.mesh, decoded)};
}

}  // namespace terrane::accuracy
