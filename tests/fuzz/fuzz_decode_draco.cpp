// decodeDraco: the attributes have the ids that Terrane's encoder gives them.

#include "tests/fuzz/sound_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const terrane::DecodeLimits limits;
  for (const terrane::DracoAttributeIds ids :
       {terrane::DracoAttributeIds{0, 1, 2, 3}, terrane::DracoAttributeIds{0, 1, -1, 2}}) {
    if (const auto mesh = terrane::decodeDraco({data, size}, ids, limits)) terrane::fuzz::requireSound(*mesh, limits);
  }
  return 0;
}
