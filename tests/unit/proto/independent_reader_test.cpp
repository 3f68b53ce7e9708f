// A reader that shares no code with ours, tinygltf with libdraco, must see the very lattice offsets that were encoded:
// what any glTF client gets.

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wextra"
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_ENABLE_DRACO
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#include <nlohmann/json.hpp>

#include <tiny_gltf.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "common/tiling/lattice.h"
#include "proto/gltf_tile.h"
#include "tests/unit/proto/sample_tile.h"

namespace terrane {
namespace {

template <class T>
std::vector<T> valuesOf(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const std::string& name,
                        int components) {
  const auto& accessor = model.accessors[static_cast<std::size_t>(primitive.attributes.at(name))];
  const auto& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  const auto& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  std::vector<T> values(accessor.count * static_cast<std::size_t>(components));
  EXPECT_GE(bytes.size(), view.byteOffset + values.size() * sizeof(T)) << name;
  std::memcpy(values.data(), bytes.data() + view.byteOffset, values.size() * sizeof(T));
  return values;
}

class IndependentReader : public testing::TestWithParam<FacePath> {};
INSTANTIATE_TEST_SUITE_P(Schemes, IndependentReader, testing::ValuesIn(test::kSamplePaths),
                         [](const auto& path) { return std::string(schemeName(path.param.scheme())); });

TEST_P(IndependentReader, SeesTheVeryLatticePositionsThatWereEncoded) {
  const Tile tile = test::sampleTile({.path = GetParam()});
  const auto glb = encodeTile(tile, {});
  ASSERT_TRUE(glb) << glb.error().text();

  tinygltf::TinyGLTF reader;
  tinygltf::Model model;
  std::string error, warning;
  ASSERT_TRUE(reader.LoadBinaryFromMemory(&model, &error, &warning, glb->data(), static_cast<unsigned>(glb->size())))
      << error;
  EXPECT_EQ(warning, "");

  ASSERT_EQ(model.meshes.size(), 1u);
  const auto& primitive = model.meshes[0].primitives.at(0);
  const auto positions = valuesOf<float>(model, primitive, "POSITION", 3);
  const auto grid = valuesOf<std::uint16_t>(model, primitive, "_GRID", 1);
  ASSERT_EQ(grid.size(), tile.mesh.vertexCount());

  std::map<std::uint16_t, std::size_t> vertexOfGrid;
  for (std::size_t i = 0; i < tile.mesh.vertexCount(); ++i) vertexOfGrid[tile.mesh.gridIndices[i]] = i;
  const auto& matrix = model.nodes.at(static_cast<std::size_t>(model.scenes.at(0).nodes.at(0))).matrix;
  ASSERT_EQ(matrix.size(), 16u);
  const double step = stepMeters(tile.metadata.stepExponent);
  const auto origin = latticePosition(tile.metadata.origin, tile.metadata.stepExponent);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::size_t expected = vertexOfGrid.at(grid[i]);
    glm::dvec3 local;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(positions[3 * i + axis], static_cast<float>(tile.mesh.offsets[3 * expected + axis]))
          << "grid index " << grid[i];
      local[static_cast<int>(axis)] = static_cast<double>(positions[3 * i + axis]);
    }
    // glTF's Y-up (X, Z, -Y) back to the body frame: exactly origin + offset * step.
    const glm::dvec3 placed{matrix[0] * local.x + matrix[12], -(matrix[6] * local.y + matrix[14]),
                            matrix[9] * local.z + matrix[13]};
    ASSERT_EQ(placed.x, origin.x + local.x * step);
    ASSERT_EQ(placed.y, origin.y + local.y * step);
    ASSERT_EQ(placed.z, origin.z + local.z * step);
  }
}

}  // namespace
}  // namespace terrane
