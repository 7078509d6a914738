// A proposal of soles as a settings file, and what was found on the way as sentences.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "problems/contact/soles/sole_proposal.h"

namespace sinew {

/// The settings of a contact problem, every number with a comment that says where it is from.
/// @param data the data set's file name; @param model name of the .osim inside it
[[nodiscard]] std::string SolesYaml(const SoleProposal& proposal, const std::string& data,
                                    const std::string& model);

/// One sentence for each plate that cannot be used and each trial that was left out.
[[nodiscard]] std::vector<std::string> SolesNotes(const SoleProposal& proposal);

/// A table of the regions, for a terminal.
[[nodiscard]] std::string SolesText(const SoleProposal& proposal);

[[nodiscard]] nlohmann::ordered_json SolesJson(const SoleProposal& proposal);

}  // namespace sinew
