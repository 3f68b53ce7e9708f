#pragma once
// One headless window with a GL context a process, for all its tests or experiments: opened when first asked for,
// closed when the process ends, after all that was made in it. GL thread only.

#include "client/gl/window.h"
#include "common/result.h"

namespace terrane {

/// Errors: as Window::open has them; the same ones whenever asked again.
Result<Window*> sharedWindow();

}  // namespace terrane
