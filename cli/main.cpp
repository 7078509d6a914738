// The sinew program.
#include "cli/run_command_line.h"

int main(int argc, char** argv) {
  sinew::Program program;
  program.name = "sinew";
  program.description =
      "sinew identifies the parameters of human-robot interaction models from measured data,\n"
      "reports which of them the data cannot determine, and what the fitted model still gets wrong.";
  program.problems = sinew::ProblemRegistry();
  program.mechanisms = true;
  return sinew::RunCommandLine(argc, argv, program);
}
