#include "client/render/gpu_self_test.h"

#include <epoxy/gl.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <random>
#include <vector>

#include "client/gl/objects.h"
#include "client/gl/shader_program.h"

namespace terrane {
namespace {

/// What the shader is given: see self_test.vert.glsl.
struct Input {
  float a = 0, b = 0;
  std::int32_t origin = 0, unused = 0;
  std::array<std::uint16_t, 4> offset{};
};

/// What it answers, in the order of the captured varyings.
struct Output {
  float sumHigh, sumLow;
  float productHigh, productLow, fmaProduct, fmaError;
  std::int32_t integerSum, convertedBits;
  float converted, difference;
};
static_assert(sizeof(Output) == 40);

constexpr int kCases = 1024;

std::vector<Input> makeInputs() {
  std::mt19937 random(20220611);  // a fixed seed: the same GPU always gets the same verdict
  std::uniform_real_distribution<float> mantissa(1.0f, 2.0f);
  std::uniform_int_distribution<int> exponent(-20, 20), sign(0, 1), offset(0, kTileOffsetMax);
  std::uniform_int_distribution<std::int32_t> origin(-(1 << 30), 1 << 30);
  const auto number = [&] {
    return std::ldexp(sign(random) != 0 ? mantissa(random) : -mantissa(random), exponent(random));
  };
  std::vector<Input> inputs(kCases);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    Input& input = inputs[i];
    input.a = number();
    input.b = number();
    // Half the origins are near the camera, where the result must be exact.
    input.origin = i % 2 == 0 ? origin(random) : origin(random) >> 7;
    for (auto& component : input.offset) component = static_cast<std::uint16_t>(offset(random));
  }
  return inputs;
}

Result<std::vector<Output>> runOnGpu(const std::vector<Input>& inputs, const gl::Capabilities& capabilities,
                                     bool qualified) {
  std::vector<std::string> defines;
  if (!qualified) defines.emplace_back("UNQUALIFIED");
  auto program = gl::Program::build({.vertexFile = "self_test.vert.glsl",
                                     .fragmentFile = {},
                                     .defines = defines,
                                     .feedbackVaryings = {"sums", "products", "whole", "relative"}},
                                    capabilities);
  if (!program) return program.error();
  gl::Buffer in, out;
  gl::VertexArray array;
  in.upload(gl::BufferTarget::Vertices, gl::bytesOf(inputs), gl::BufferUse::Static);
  using gl::Component, gl::Conversion;
  constexpr std::array kAttributes{
      gl::VertexAttribute{0, 2, Component::F32, Conversion::Float, offsetof(Input, a)},
      gl::VertexAttribute{1, 2, Component::I32, Conversion::Integer, offsetof(Input, origin)},
      gl::VertexAttribute{2, 4, Component::U16, Conversion::Integer, offsetof(Input, offset)},
  };
  array.attach(in, sizeof(Input), kAttributes);
  std::vector<Output> outputs(inputs.size());
  out.allocate(gl::BufferTarget::Feedback, outputs.size() * sizeof(Output), gl::BufferUse::ReadBack);
  out.bindForFeedback();
  program->use();
  glEnable(GL_RASTERIZER_DISCARD);
  glBeginTransformFeedback(GL_POINTS);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(inputs.size()));
  glEndTransformFeedback();
  glDisable(GL_RASTERIZER_DISCARD);
  out.read(0, std::as_writable_bytes(std::span(outputs)));
  gl::VertexArray::unbind();
  return outputs;
}

/// Within one unit in the last place of the correctly rounded value, and exact where a float can hold the integer: what
/// placement needs (the language does not promise how larger integers round).
bool convertedWell(std::int32_t integer, float converted) {
  const auto nearest = static_cast<float>(integer);
  if (std::abs(integer) <= 1 << 24) return converted == nearest;
  return std::abs(std::bit_cast<std::int32_t>(converted) - std::bit_cast<std::int32_t>(nearest)) <= 1;
}

}  // namespace

Result<SelfTestReport> runGpuSelfTest(const gl::Capabilities& capabilities) {
  SelfTestReport report;
  report.renderer = capabilities.renderer;
  report.version = capabilities.versionText;
  const std::vector<Input> inputs = makeInputs();
  const auto outputs = runOnGpu(inputs, capabilities, true);
  if (!outputs) return outputs.error();
  const auto plainOutputs = runOnGpu(inputs, capabilities, false);
  if (!plainOutputs) return plainOutputs.error();

  report.integerExact = report.twoSumExact = report.twoProdExact = report.twoSumWithoutPrecise = report.fmaFused = true;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Input& in = inputs[i];
    const Output &out = (*outputs)[i], &plain = (*plainOutputs)[i];
    // a + b has at most 65 bits here, a * b 48: the sum's error is the exact remainder of Knuth's algorithm on the CPU,
    // the product's is exact in double.
    const float sum = in.a + in.b, bPart = sum - in.a, sumError = (in.a - (sum - bPart)) + (in.b - bPart);
    const float product = in.a * in.b;
    const auto productError =
        static_cast<float>(static_cast<double>(in.a) * static_cast<double>(in.b) - static_cast<double>(product));
    const std::int32_t integer = in.origin + in.offset[0];

    report.twoSumExact &= out.sumHigh == sum && out.sumLow == sumError;
    report.twoSumWithoutPrecise &= plain.sumHigh == sum && plain.sumLow == sumError;
    report.twoProdExact &= out.productHigh == product && out.productLow == productError;
    report.fmaFused &= capabilities.precise && out.fmaProduct == product && out.fmaError == productError;
    report.integerExact &= out.integerSum == integer && convertedWell(integer, out.converted) &&
                           std::bit_cast<float>(out.convertedBits) == out.converted &&
                           out.difference == out.converted - in.a;
  }
  report.chosen = report.integerExact  ? Placement::Integer
                  : report.twoSumExact ? Placement::DoubleFloat
                                       : Placement::Cpu;
  return report;
}

}  // namespace terrane
