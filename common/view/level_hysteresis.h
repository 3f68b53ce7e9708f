#pragma once
// When a tile's children may go again. A tile is subdivided as soon as its screen-space error is larger than allowed,
// and its children are combined into it only once it is down to half of that: a camera that hovers where a level begins
// asks for nothing and drops nothing. (TrySubdivide and TryCombine of icosahedral planet renderers have the same factor
// of two between them.) It governs requests and residency (client/tiles/tile_stream.h), never what is drawn, which is
// a function of the camera and what is there. Thread-safe.

#include "common/view/camera.h"
#include "common/view/tile_selection.h"

namespace terrane {

/// Of the allowed error: below it children are combined.
inline constexpr double kCombineShare = 0.5;

/// Where tiles are looked at from.
struct ViewOfTiles {
  Camera camera;
  double errorPixels = 2.0;  ///< allowed
};

/// Whether a tile is to be kept though it may not be wanted: it may be in view, and its parent's error is above
/// kCombineShare of what is allowed. A whole face is while it may be in view.
bool staysSubdivided(const FacePath& path, const ViewOfTiles& view, const SelectionBody& body,
                     const ResidentLookup& resident);

}  // namespace terrane
