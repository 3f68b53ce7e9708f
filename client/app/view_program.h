#pragma once
// terrane-view as a function: command line in, exit status out (0 done, 1 it failed, 2 wrong usage).

namespace terrane {

int runViewProgram(int argc, char** argv);

}  // namespace terrane
