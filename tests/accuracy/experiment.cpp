#include "tests/accuracy/experiment.h"

#include <algorithm>

namespace terrane::accuracy {
namespace {

std::vector<Experiment>& list() {
  static std::vector<Experiment> registered;
  return registered;
}

}  // namespace

Registration::Registration(const Experiment& experiment) {
  auto& all = list();
  all.insert(std::ranges::upper_bound(all, experiment.order, {}, &Experiment::order), experiment);
}

std::span<const Experiment> experiments() { return list(); }

}  // namespace terrane::accuracy
