#pragma once
// The yardstick for a viewer's frame: the same triangles, camera-relative float positions ready in vertex buffers, one
// matrix, one dot product a vertex; nothing is selected, placed or streamed. GL thread only.

#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "common/view/camera.h"
#include "proto/tile_mesh.h"

namespace terrane::bench {

class BareLoop {
 public:
  BareLoop(const Camera& camera, const std::vector<std::shared_ptr<const Tile>>& tiles);
  ~BareLoop();
  BareLoop(const BareLoop&) = delete;
  BareLoop& operator=(const BareLoop&) = delete;

  void draw() const;

 private:
  struct Mesh {
    unsigned vertexArray = 0, vertices = 0, indices = 0;
    int indexCount = 0;
  };
  std::vector<Mesh> meshes_;
  unsigned program_ = 0;
  int matrixLocation_ = -1;
  float matrix_[16] = {};
};

}  // namespace terrane::bench
