#include "server/build/tile_revision.h"

#include <fmt/format.h>
#include <xxhash.h>

namespace terrane {

std::string tileRevision(const Body& body, std::string_view fieldIdentity, const WireSettings& wire,
                         std::span<const std::uint8_t> probe) {
  // Hexadecimal floating point: two radii that differ in the last bit are two bodies.
  std::string text =
      fmt::format("generator {}\nprobe {:016x}\nfield {}\nradius {:a}\ncells {}\nspeed {}\nnormal bits {}\n",
                  kGeneratorVersion, XXH3_64bits(probe.data(), probe.size()), fieldIdentity, body.radiusMeters,
                  wire.cellsPerEdge, wire.draco.speed, wire.draco.normalBits);
  for (const Scheme scheme : body.schemes) text += fmt::format("scheme {}\n", schemeName(scheme));
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace terrane
