#include "tests/unit/proto/kinds_of_data.h"

#include <cmath>
#include <cstdint>
#include <random>

namespace terrane::test {

std::vector<std::pair<std::string, TileMesh>> kindsOfData(const TileMesh& model, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::pair<std::string, TileMesh>> kinds{{"as sampled", model}};
  const auto add = [&](std::string name, auto&& offset, auto&& color, auto&& normal) {
    TileMesh mesh = model;
    for (std::size_t i = 0; i < mesh.offsets.size(); ++i) mesh.offsets[i] = static_cast<std::uint16_t>(offset(i));
    for (std::size_t i = 0; i < mesh.colors.size(); ++i) mesh.colors[i] = static_cast<std::uint8_t>(color(i));
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) mesh.normals[i] = static_cast<float>(normal(i));
    kinds.emplace_back(std::move(name), std::move(mesh));
  };
  const auto drawn = [&](std::size_t) { return random() >> 8; };
  const auto sign = [&](std::size_t) { return random() % 2 == 0 ? 1 : -1; };
  const auto one = [](std::size_t) { return 1; };
  add(
      "all equal", [](std::size_t) { return 4711; }, [](std::size_t) { return 96; }, one);
  add("noise", drawn, drawn, [&](std::size_t) { return std::ldexp(random(), -32) - 0.4999; });
  add(
      "only the ends of the range", [&](std::size_t) { return random() % 2 * 65535; },
      [&](std::size_t) { return random() % 2 * 255; }, sign);
  add(
      "one spike", [](std::size_t i) { return i == 30 ? 65535 : 0; }, [](std::size_t i) { return i == 8 ? 255 : 0; },
      [](std::size_t i) { return i % 3 == 2 ? -1.0 : 0.0; });
  add(
      "a ramp", [](std::size_t i) { return i; }, [](std::size_t i) { return i / 64; },
      [](std::size_t i) { return i % 3 == 0 ? 1.0 : std::sin(0.01 * static_cast<double>(i)); });
  add(
      "small steps", [&](std::size_t i) { return 30000 + i / 3 + random() % 3; },
      [&](std::size_t) { return 96 + random() % 2; },
      [&](std::size_t i) { return i % 3 == 1 ? 1.0 : 0.02 * std::ldexp(random(), -32); });
  add(
      "normals on the octahedron's edges", [](std::size_t i) { return i; }, [](std::size_t i) { return i / 64; },
      [&](std::size_t i) { return i % 3 == i / 3 % 3  ? 0.0
                                  : random() % 2 == 0 ? 1.0
                                                      : -1.0; });
  return kinds;
}

}  // namespace terrane::test
