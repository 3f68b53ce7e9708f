#pragma once
// Where this checkout and its build are.

#include <string>

namespace terrane::test {

std::string sourceFolder();
std::string buildFolder();

}  // namespace terrane::test
