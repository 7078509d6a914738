#include "cli/cohort/step_state.h"

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/digest.h"
#include "base/read_file.h"
#include "base/replace_file.h"

namespace sinew::cohort {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "sinew.steps/1";
constexpr std::array<std::pair<Progress, const char*>, 3> kNames{
    {{Progress::kBegun, "begun"}, {Progress::kDone, "done"}, {Progress::kFailed, "failed"}}};

Json ToJson(const StepRecord& record) {
  Json json{{"progress", ""}, {"question", record.question}, {"seconds", record.seconds}};
  for (const auto& [progress, name] : kNames) {
    if (progress == record.progress) json["progress"] = name;
  }
  json["written"] = record.written;
  if (!record.reason.empty()) json["reason"] = record.reason;
  return json;
}

// Throws what nlohmann throws if a field is absent or of another kind.
StepRecord FromJson(const Json& json) {
  StepRecord record;
  record.question = json.at("question");
  record.seconds = json.at("seconds");
  record.written = json.at("written").get<std::map<std::string, std::string>>();
  record.reason = json.value("reason", "");
  const std::string progress = json.at("progress");
  for (const auto& [value, name] : kNames) {
    if (progress == name) record.progress = value;
  }
  return record;
}

}  // namespace

Result<StepStates> StepStates::Read(const std::string& folder) {
  StepStates states(folder + "/steps.json");
  std::error_code code;
  if (!std::filesystem::exists(states.path_, code)) return states;
  SINEW_ASSIGN(const std::string text, ReadFile(states.path_));
  try {
    const Json json = Json::parse(text);
    if (json.at("schema") != kSchema) throw std::runtime_error("another schema");
    for (const auto& [step, record] : json.at("steps").items()) states.records_[step] = FromJson(record);
  } catch (const std::exception&) {
    return Fail("{}: is not a record of steps: remove it, and its subject begins from the start",
                states.path_);
  }
  return states;
}

const StepRecord* StepStates::Find(const std::string& step) const {
  const auto found = records_.find(step);
  return found == records_.end() ? nullptr : &found->second;
}

Status StepStates::Set(const std::string& step, StepRecord record) {
  records_[step] = std::move(record);
  Json steps = Json::object();
  for (const auto& [name, one] : records_) steps[name] = ToJson(one);
  const Json json{{"schema", kSchema}, {"steps", std::move(steps)}};
  return ReplaceFile(path_, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<std::string> DigestOfFile(const std::string& path) {
  SINEW_ASSIGN(const std::string bytes, ReadFile(path));
  return ToHex(Digest().Add(bytes).value());
}

}  // namespace sinew::cohort
