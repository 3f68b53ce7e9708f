// Writes Draco streams of real tiles, and beside each the mesh that C++ libdraco reads from it, for decode.mjs to
// compare with what JavaScript reads. Usage: draco3d_samples FOLDER TILES
//
// A file: 7 little-endian words (vertices, triangles, the ids of position, normal, colour and grid index, the stream's
// bytes), the stream, then offsets (u16 x 3), normals (f32 x 3), colours (u8 x 3, if there is an id), grid indices
// (u16) and triangles (u32 x 3). Its name begins with the settings' name.

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "proto/draco_template.h"
#include "tests/unit/server/built_tiles.h"

namespace {

using namespace terrane;

constexpr unsigned kSeed = 72;

struct Choice {
  std::string_view name;
  DracoSettings settings;
};
constexpr std::array kChoices{
    Choice{"default", {}},
    Choice{"speed-4", {.speed = 4}},
    Choice{"multi-geometric", {.prediction = DracoPrediction::MultiParallelogram, .normals = DracoNormals::Geometric}},
};

template <class T>
void write(std::ofstream& file, const std::vector<T>& values) {
  file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

void writeSample(const std::filesystem::path& path, const DracoBuffer& stream) {
  const DracoAttributeIds ids{stream.positionId, stream.normalId, stream.colorId, stream.gridId};
  const TileMesh mesh = decodeDraco(stream.bytes, ids, {}).value();
  std::ofstream file(path, std::ios::binary);
  write<std::uint32_t>(file, {stream.vertexCount, stream.triangleCount, static_cast<std::uint32_t>(ids.position),
                              static_cast<std::uint32_t>(ids.normal), static_cast<std::uint32_t>(ids.color),
                              static_cast<std::uint32_t>(ids.grid), static_cast<std::uint32_t>(stream.bytes.size())});
  write(file, stream.bytes);
  write(file, mesh.offsets);
  write(file, mesh.normals);
  write(file, mesh.colors);
  write(file, mesh.gridIndices);
  write(file, mesh.triangles);
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

void writeSamples(const std::filesystem::path& folder, int tiles) {
  std::mt19937_64 random(kSeed);
  const std::array grounds{test::Ground(Scheme::Cube), test::Ground(Scheme::Ico),
                           test::Ground(Scheme::Cube, FieldKind::Midpoint),
                           test::Ground(Scheme::Ico, FieldKind::Midpoint)};
  for (const Choice& choice : kChoices) {
    for (std::size_t g = 0; g < grounds.size(); ++g) {
      const TileBuilder& builder = test::builderOf(grounds[g]);
      const auto whole = builder.buildMesh(FacePath::wholeFace(grounds[g].scheme, 0)).value();
      const auto learnt = DracoTemplate::learn(whole.mesh, choice.settings).value();
      for (int i = 0; i < tiles; ++i) {
        const int level = i % (builder.info().selection.maxLevel + 1);
        const Tile tile = builder.buildMesh(test::randomTile(random, grounds[g].scheme, level)).value();
        writeSample(folder / fmt::format("{}.{}.{:05}.bin", choice.name, g, i), learnt->encode(tile.mesh).value());
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int tiles = 0;
  const std::string_view count = argc == 3 ? argv[2] : "";
  if (const auto [end, failure] = std::from_chars(count.data(), count.data() + count.size(), tiles);
      failure != std::errc() || end != count.data() + count.size() || tiles <= 0) {
    std::cerr << "usage: draco3d_samples FOLDER TILES (of each ground and setting)\n";
    return 2;
  }
  try {
    std::filesystem::create_directories(argv[1]);
    writeSamples(argv[1], tiles);
  } catch (const std::exception& failure) {
    std::cerr << "draco3d_samples: " << failure.what() << '\n';
    return 1;
  }
}
