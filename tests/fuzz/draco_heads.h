#pragma once
// Streams of small tiles in two parts: the head, which DracoReader knows, and values, where its fuzzer begins.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "proto/draco_mesh.h"
#include "tests/unit/proto/sample_tile.h"

namespace terrane::fuzz {

struct DracoHead {
  std::vector<std::uint8_t> bytes;
  DracoAttributeIds ids;
  std::vector<std::vector<std::uint8_t>> values;  ///< what may follow
};

/// Of both schemes, with colours and without; values that are predicted in all ways that libdraco's encoder knows.
inline std::vector<DracoHead> dracoHeads() {
  std::vector<DracoHead> heads;
  const auto add = [&](const FacePath& path, bool colors) {
    // Below 40 vertices libdraco predicts by differences at every speed.
    const auto mesh = test::sampleTile({.path = path, .cellsPerEdge = 8, .colors = colors}).mesh;
    std::vector<DracoBuffer> streams;
    for (const int speed : {1, 3, 7, 10})
      streams.push_back(encodeDraco(mesh, {.speed = speed, .normalBits = 8}).value());
    const auto& first = streams.front();
    DracoHead head;
    // The first byte of the values is the method of prediction: another one at the first speed than at the last.
    head.bytes.assign(first.bytes.begin(), std::ranges::mismatch(first.bytes, streams.back().bytes).in1);
    head.ids = {first.positionId, first.normalId, first.colorId, first.gridId};
    for (const DracoBuffer& stream : streams)
      head.values.emplace_back(stream.bytes.begin() + static_cast<std::ptrdiff_t>(head.bytes.size()),
                               stream.bytes.end());
    heads.push_back(head);
  };
  for (const FacePath& path : test::kSamplePaths) {
    add(path, true);
    add(path, false);
  }
  return heads;
}

}  // namespace terrane::fuzz
