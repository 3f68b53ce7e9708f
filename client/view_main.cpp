#include "client/app/view_program.h"

int main(int argc, char** argv) { return terrane::runViewProgram(argc, argv); }
