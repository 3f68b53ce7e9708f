// terrane-function-values COUNT SEED: the values of own_functions.h as hexadecimal floats, one a line, for a process
// that has started it with other CPU features than its own (GLIBC_TUNABLES).

#include <cstdio>
#include <cstdlib>

#include "tests/accuracy/own_functions.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("terrane-function-values COUNT SEED\n", stderr);
    return 2;
  }
  const std::size_t count = std::strtoull(argv[1], nullptr, 10);
  const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  for (const auto& f : terrane::accuracy::kFunctions)
    for (const double x : terrane::accuracy::argumentsOf(f, count, seed)) std::printf("%a\n", f.value(x));
  return 0;
}
