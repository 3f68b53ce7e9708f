#include "tests/support/shader_conformance.h"

#include <map>
#include <memory>
#include <stdexcept>

#include "tests/support/vertex_run.h"

namespace terrane::test {
namespace {

constexpr const char* kShader = R"(#ifdef UNQUALIFIED
#undef PRECISE
#define PRECISE
#endif
#include "double_float.glsl"
#include "double_float_scalar.glsl"

#ifdef LANES
#define REAL vec3
#define PAIR DoubleFloat3
#else
#define REAL float
#define PAIR DoubleFloat
#endif
PAIR asPair(REAL value) { return PAIR(value, REAL(0.0)); }

layout(location = 0) in REAL xHi;
layout(location = 1) in REAL xLo;
layout(location = 2) in REAL yHi;
layout(location = 3) in REAL yLo;
out REAL resultHi;
out REAL resultLo;

void main() {
  PAIR x = PAIR(xHi, xLo), y = PAIR(yHi, yLo);
  PAIR result = OPERATION;
  resultHi = result.hi;
  resultLo = result.lo;
  gl_Position = vec4(0.0);
}
)";

VertexRun makeRun(const PairOperation& operation, ShaderForm form) {
  VertexRun::Spec spec{.vertexText = kShader,
                       .defines = {std::string("OPERATION ") + operation.shader},
                       .varyings = {"resultHi", "resultLo"},
                       .floatsPerVertex = form == ShaderForm::Lanes ? 6u : 2u};
  if (form == ShaderForm::Lanes) spec.defines.emplace_back("LANES");
  if (form == ShaderForm::Unqualified) spec.defines.emplace_back("UNQUALIFIED");
  auto run = VertexRun::create(spec);
  if (!run) throw std::runtime_error(run.error().text());
  return std::move(*run);
}

/// Word by word of a vertex: x.hi of all lanes, x.lo, y.hi, y.lo.
std::vector<float> interleaved(std::span<const OperandPair> operands, std::size_t lanes) {
  std::vector<float> values;
  for (std::size_t i = 0; i + lanes <= operands.size(); i += lanes) {
    for (std::size_t lane = 0; lane < lanes; ++lane) values.push_back(operands[i + lane].x.hi);
    for (std::size_t lane = 0; lane < lanes; ++lane) values.push_back(operands[i + lane].x.lo);
    for (std::size_t lane = 0; lane < lanes; ++lane) values.push_back(operands[i + lane].y.hi);
    for (std::size_t lane = 0; lane < lanes; ++lane) values.push_back(operands[i + lane].y.lo);
  }
  return values;
}

std::vector<gl::VertexAttribute> fourReals(std::size_t lanes) {
  std::vector<gl::VertexAttribute> attributes;
  for (unsigned i = 0; i < 4; ++i)
    attributes.push_back(
        {i, static_cast<int>(lanes), gl::Component::F32, gl::Conversion::Float, i * lanes * sizeof(float)});
  return attributes;
}

}  // namespace

Evaluate onShader(ShaderForm form) {
  const auto runs = std::make_shared<std::map<std::string, VertexRun>>();
  return [runs, form](const PairOperation& operation, std::span<const OperandPair> operands) {
    auto found = runs->find(operation.name);
    if (found == runs->end()) found = runs->emplace(operation.name, makeRun(operation, form)).first;
    const std::size_t lanes = form == ShaderForm::Lanes ? 3 : 1;
    const std::vector<float> in = interleaved(operands, lanes);
    found->second.setVertices(gl::bytesOf(in), 4 * lanes * sizeof(float), fourReals(lanes));
    found->second.run();
    const std::vector<float> out = found->second.results();
    std::vector<DoubleFloat> results;
    for (std::size_t i = 0; i < out.size(); i += 2 * lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) results.emplace_back(out[i + lane], out[i + lanes + lane]);
    return results;
  };
}

}  // namespace terrane::test
