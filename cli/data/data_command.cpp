#include "cli/data/data_commands.h"

namespace sinew {

Result<std::optional<Role>> ParseRole(const std::string& word) {
  if (word.empty()) return std::optional<Role>();
  if (word == "train") return std::optional<Role>(Role::kTrain);
  if (word == "validate") return std::optional<Role>(Role::kValidate);
  return Fail("--role {}: expected train or validate", word);
}

void AddDataCommand(Command app, const RunAction& run) {
  Command data = app.AddCommand("data", "Make, import, check, cut and inspect data sets");
  data.RequireCommand();
  AddSynthesizeCommand(data, run);
  AddImportCommand(data, run);
  AddInfoCommand(data, run);
  AddCheckCommand(data, run);
  AddCutCommand(data, run);
  AddSplitCommand(data, run);
  AddStancesCommand(data, run);
  AddSolesCommand(data, run);
  AddDropCommand(data, run);
  AddKinematicsCommand(data, run);
  AddDynamicsCommand(data, run);
  AddStepsCommand(data, run);
  AddLoadsCommand(data, run);
  AddEnvelopeCommand(data, run);
  AddCeinmsCommand(data, run);
  AddSubjectCommand(data, run);
  AddMusclesCommand(data, run);
}

}  // namespace sinew
