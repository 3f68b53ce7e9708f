#include "tests/support/folders.h"

// The one file that knows: everything else is compiled alike in every checkout, so a compiler cache serves them all.

namespace terrane::test {

std::string sourceFolder() { return TERRANE_SOURCE_DIR; }
std::string buildFolder() { return TERRANE_BINARY_DIR; }

}  // namespace terrane::test
