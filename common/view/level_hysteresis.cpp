#include "common/view/level_hysteresis.h"

namespace terrane {

bool staysSubdivided(const FacePath& path, const ViewOfTiles& view, const SelectionBody& body,
                     const ResidentLookup& resident) {
  if (path.level() > 0 &&
      !(tileErrorPixels(path.parent(), view.camera, body, resident) > kCombineShare * view.errorPixels))
    return false;
  return tileMayBeSeen(path, view.camera, body, resident);
}

}  // namespace terrane
