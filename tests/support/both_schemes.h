#pragma once
// Tests that hold for tiles of both schemes: INSTANTIATE_TEST_SUITE_P(Schemes, Suite, bothSchemes(), nameOfScheme).

#include <gtest/gtest.h>

#include <string>

#include "common/tiling/face_path.h"

namespace terrane::test {

inline auto bothSchemes() { return testing::Values(Scheme::Cube, Scheme::Ico); }
inline constexpr auto nameOfScheme = [](const auto& scheme) { return std::string(schemeName(scheme.param)); };

}  // namespace terrane::test
