#pragma once
// What must hold of a scene file's text before a TOML parser sees it. Thread-safe.

#include <optional>
#include <string_view>

#include "common/result.h"

namespace terrane {

/// UTF-8 throughout, no more bytes than kMaxSceneFileBytes, no line longer than kMaxSceneLineBytes: dotted keys nest as
/// deep as a line is long, and parsers recurse. Errors: as parseScene's, one line with file and line; empty if all is
/// well.
std::optional<Error> checkSceneText(std::string_view toml, std::string_view fileName);

}  // namespace terrane
