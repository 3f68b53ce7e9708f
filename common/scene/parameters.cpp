#include "common/scene/parameters.h"

namespace terrane {

ParameterValues defaultValues(std::span<const ParameterSpec> schema) {
  ParameterValues values;
  for (const ParameterSpec& spec : schema) values.emplace(spec.name, spec.defaultValue);
  return values;
}

}  // namespace terrane
