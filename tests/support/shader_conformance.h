#pragma once
// Double-float as a shader computes it, behind the interface of double_float_conformance.h. GL thread only; a context
// must be current.

#include "tests/support/double_float_conformance.h"

namespace terrane::test {

enum class ShaderForm : std::uint8_t {
  Scalar,       ///< float
  Lanes,        ///< vec3: three cases a vertex; the operands come in threes
  Unqualified,  ///< float, without precise: the control
};

/// Each operation is compiled when first asked for. Throws std::runtime_error with the driver's log.
Evaluate onShader(ShaderForm form);

}  // namespace terrane::test
