// SPDX-License-Identifier: MIT
#include "batten/cli/program.h"

int main(int argc, char** argv) { return batten::RunProgram(argc, argv); }
