// The subcommands of `sinew data`.
#pragma once

#include <optional>
#include <string>

#include "cli/command.h"
#include "datasets/dataset.h"

namespace sinew {

void AddSynthesizeCommand(Command data, const RunAction& run);
void AddImportCommand(Command data, const RunAction& run);
void AddInfoCommand(Command data, const RunAction& run);
void AddCheckCommand(Command data, const RunAction& run);
void AddCutCommand(Command data, const RunAction& run);
void AddSplitCommand(Command data, const RunAction& run);
void AddStancesCommand(Command data, const RunAction& run);
void AddStepsCommand(Command data, const RunAction& run);
void AddLoadsCommand(Command data, const RunAction& run);
void AddDropCommand(Command data, const RunAction& run);
void AddSolesCommand(Command data, const RunAction& run);
void AddCeinmsCommand(Command data, const RunAction& run);
void AddSubjectCommand(Command data, const RunAction& run);
void AddKinematicsCommand(Command data, const RunAction& run);
void AddDynamicsCommand(Command data, const RunAction& run);
void AddEnvelopeCommand(Command data, const RunAction& run);
void AddMusclesCommand(Command data, const RunAction& run);

/// The word of --role; nothing if it is empty. Errors: any other word than train and validate.
Result<std::optional<Role>> ParseRole(const std::string& word);

}  // namespace sinew
