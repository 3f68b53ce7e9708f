// Writes the inputs that the fuzzers begin at: make_seeds DIRECTORY.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "proto/gltf_tile.h"
#include "proto/scene_json.h"
#include "proto/tile_url.h"
#include "tests/fuzz/draco_heads.h"
#include "tests/unit/proto/sample_tile.h"

namespace {

void write(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}
void write(const std::filesystem::path& file, const std::string& text) {
  write(file, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void writeDracoValues(const std::filesystem::path& corpus) {
  const auto heads = terrane::fuzz::dracoHeads();
  for (std::size_t head = 0; head < heads.size(); ++head)
    for (std::size_t i = 0; i < heads[head].values.size(); ++i) {
      std::vector<std::uint8_t> seed{static_cast<std::uint8_t>(head)};
      seed.insert(seed.end(), heads[head].values[i].begin(), heads[head].values[i].end());
      write(corpus / "fuzz_draco_reader_seeds" / (std::to_string(head) + "_" + std::to_string(i)), seed);
    }
}

void writeTile(const std::filesystem::path& corpus, const terrane::test::SampleSettings& sample) {
  const terrane::Tile tile = terrane::test::sampleTile(sample);
  for (const int speed : {0, 3, 4, 7, 10}) {
    const terrane::DracoSettings settings{.speed = speed, .normalBits = 8};
    const std::string name = std::string(schemeName(sample.path.scheme())) + std::to_string(sample.cellsPerEdge) +
                             (sample.skirts ? "_skirts" : "") + (sample.colors ? "_colors" : "") + "_speed" +
                             std::to_string(speed);
    write(corpus / "fuzz_decode_draco_seeds" / name, terrane::encodeDraco(tile.mesh, settings).value().bytes);
    write(corpus / "fuzz_decode_tile_seeds" / name, terrane::encodeTile(tile, settings).value());
  }
}

void writeTiles(const std::filesystem::path& corpus) {
  for (const terrane::FacePath& path : terrane::test::kSamplePaths)
    for (const int cells : {1, 2, 4, 16})
      for (const bool skirts : {false, true})
        for (const bool colors : {false, true})
          writeTile(corpus, {.path = path, .cellsPerEdge = cells, .skirts = skirts, .colors = colors});
}

/// fuzz_draco_template's layout: settings, then values.
void writeValues(const std::filesystem::path& corpus) {
  const std::vector<std::pair<std::string, std::vector<std::uint8_t>>> kinds{
      {"alike", {7, 70}}, {"ends", {0, 0, 255, 255, 127, 128}}, {"ramp", {1, 0, 2, 0, 3, 0, 5, 0, 8, 0, 13, 0}}};
  for (const int speed : {2, 4, 7, 10}) {
    for (int predictions = 0; predictions < 9; ++predictions) {
      for (const auto& [name, values] : kinds) {
        std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(speed), 6, static_cast<std::uint8_t>(predictions),
                                        static_cast<std::uint8_t>(speed + predictions)};
        bytes.insert(bytes.end(), values.begin(), values.end());
        write(corpus / "fuzz_draco_template_seeds" /
                  (name + "_speed" + std::to_string(speed) + "_" + std::to_string(predictions)),
              bytes);
      }
    }
  }
}

void writeScene(const std::filesystem::path& corpus) {
  terrane::BodyInfo body;
  body.name = "moon";
  body.revision = "0123456789abcdef";
  body.schemes = {terrane::Scheme::Cube};
  body.selection.radiusMeters = 1737400;
  body.selection.maxLevel = 2;
  body.selection.heights = {-9000, 10800};
  body.selection.occluderRadiusMeters = 1728000;
  body.selection.geometricErrorMeters = {1000, 500.5, 250.25};
  const terrane::EffectCall sun{terrane::EffectKind::Sun,
                                terrane::defaultValues(terrane::effectRow(terrane::EffectKind::Sun).parameters)};
  write(corpus / "fuzz_read_scene_json_seeds" / "moon", terrane::writeSceneJson({"moon", "The Moon", {body}, {sun}}));
}

void writeTargets(const std::filesystem::path& corpus) {
  int number = 0;
  for (const std::string target :
       {"/", "/healthz", "/readyz", "/metrics", "/v1/scene.json", "/v1/0123456789abcdef/moon/cube/2.glb",
        "/v1/0123456789abcdef/moon/ico/19/0312.glb", "//v1//0123456789abcdef/moon/cube/5/0.glb?x=%20",
        "http://host/v1/%30123456/a/cube/0/3.glb"}) {
    write(corpus / "fuzz_parse_target_seeds" / std::to_string(number++), target);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_seeds DIRECTORY\n", stderr);
    return 2;
  }
  writeDracoValues(argv[1]);
  writeTiles(argv[1]);
  writeValues(argv[1]);
  writeScene(argv[1]);
  writeTargets(argv[1]);
  return 0;
}
