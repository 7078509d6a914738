#include "cli/binding.h"

#include <algorithm>

#include "base/read_file.h"
#include "base/text.h"
#include "cli/run_command_line.h"
#include "cli/terminal.h"
#include "datasets/dataset_hash.h"
#include "datasets/io/dataset_file.h"
#include "identify/check_problem.h"

namespace sinew {
namespace {

// What is recorded, or predicted, in another file, in place of each trial's excitations.
Status ReplaceExcitations(const std::string& path, Dataset& data) {
  SINEW_ASSIGN(const Dataset other, ReadDataset(path));
  for (auto& [name, trial] : data.trials) {
    const auto found = other.trials.find(name);
    if (found == other.trials.end()) return Fail("--excitations {}: has no trial '{}'", path, name);
    const auto& grids = found->second.grids;
    auto grid = grids.find("simulated");
    if (grid == grids.end()) grid = grids.find("excitations");
    if (grid == grids.end())
      return Fail("--excitations {}: trial '{}' has no grid 'simulated' or 'excitations'", path, name);
    trial.grids["excitations"] = grid->second;
  }
  return {};
}

}  // namespace

void BindingOptions::AddTo(Command command) {
  program = &command.program();
  if (program->problems.size() == 1) {
    problem = program->problems.front().name;
    command.Add("problem", problem, "May be left out").Shows("PROBLEM");
  } else {
    command.Add("problem", problem, "One of `sinew list problems`").Required().Shows("PROBLEM");
  }
  command.Add("--data", data, "Data set (HDF5, docs/dataset_file.md)").Required().Shows("F.h5");
  command.Add("--config", config, "Settings of the problem; default: PROBLEM.yaml inside the data set")
      .Shows("C.yaml");
}

void FitOptions::AddChoiceTo(Command command) {
  command.Add("--free", free, "Fit these parameters only").Split(',').Shows("A,B");
  command.Add("--fix", fix, "Hold a parameter at a value").Split(',').Shows("A=V");
  command.Add("--bounds", bounds, "Other bounds").Split(',').Shows("A=LO:HI");
  command.Add("--start", start, "Another start").Split(',').Shows("A=V");
}

void FitOptions::AddWorkTo(Command command) {
  AddSeedTo(command);
  AddThreadsTo(command);
  AddQuietTo(command);
  command
      .Add("--work-times", work_times, "Seconds of each piece of independent work, as JSON (docs/cluster.md)")
      .NotEmpty()
      .Shows("FILE");
}

void FitOptions::AddTo(Command command) {
  AddChoiceTo(command);
  command.Add("--release", release, "Release an effect (`sinew list effects PROBLEM`)")
      .Split(',')
      .Shows("EFFECT");
  command.Add("--max-evaluations", max_evaluations, "Budget").AtLeastZero().Shows("N");
  command.Add("--max-seconds", max_seconds, "Budget").AtLeastZero().Shows("S");
  AddWorkTo(command);
}

void AddStartsTo(Command command, std::optional<int>& starts) {
  constexpr int kMostStarts = 1000000;
  command.Add("--starts", starts, "Of solver multistart; default: 20").Between(1, kMostStarts);
}

bool HasStarts(const std::string& solver) {
  const std::vector<std::string_view> links = Split(solver, '+');
  return std::find(links.begin(), links.end(), "multistart") != links.end();
}

Result<std::pair<std::string, double>> ParseAssignment(const std::string& option, const std::string& text) {
  const auto at = text.find('=');
  const auto value =
      at == std::string::npos ? std::nullopt : ParseNumber(std::string_view(text).substr(at + 1));
  if (at == 0 || !value) return Fail("{} {}: expected NAME=VALUE", option, text);
  return std::pair{text.substr(0, at), *value};
}

Result<std::pair<std::string, std::map<std::string, double>>> ParseEffect(const std::string& text) {
  const auto at = text.find(':');
  std::map<std::string, double> parameters;
  if (at != std::string::npos) {
    for (const auto part : Split(std::string_view(text).substr(at + 1), ',')) {
      SINEW_ASSIGN(const auto assignment, ParseAssignment("--effect", std::string(part)));
      if (!parameters.insert(assignment).second)
        return Fail("--effect {}: '{}' is given twice", text.substr(0, at), assignment.first);
    }
  }
  return std::pair{text.substr(0, at), parameters};
}

Result<FitRequest> FitOptions::Request() const {
  FitRequest request;
  request.free = free;
  request.release = release;
  for (const std::string& text : fix) {
    SINEW_ASSIGN(auto assignment, ParseAssignment("--fix", text));
    request.fix.push_back(std::move(assignment));
  }
  for (const std::string& text : start) {
    SINEW_ASSIGN(auto assignment, ParseAssignment("--start", text));
    request.start.push_back(std::move(assignment));
  }
  for (const std::string& text : bounds) {
    const auto parts = Split(text, '=');
    const auto limits = parts.size() == 2 ? Split(parts[1], ':') : std::vector<std::string_view>();
    const auto lower = limits.size() == 2 ? ParseNumber(limits[0]) : std::nullopt;
    const auto upper = limits.size() == 2 ? ParseNumber(limits[1]) : std::nullopt;
    if (!lower || !upper) return Fail("--bounds {}: expected NAME=LOW:HIGH", text);
    request.bounds.push_back({std::string(parts[0]), {*lower, *upper}});
  }
  return request;
}

Budget FitOptions::ToBudget() const {
  Budget budget;
  if (max_evaluations) budget.max_evaluations = *max_evaluations;
  if (max_seconds) budget.max_seconds = *max_seconds;
  return budget;
}

std::vector<std::string> FitOptions::Written(const std::string& out) const {
  std::vector<std::string> written{out};
  if (!work_times.empty()) written.push_back(work_times);
  return written;
}

SolverOptions FitOptions::ToSolverOptions() const {
  SolverOptions options;
  options.seed = seed;
  options.threads = threads;
  return options;
}

Provenance Binding::ToProvenance(const BindingOptions& options) const {
  Provenance provenance;
  provenance.problem = entry->name;
  provenance.data_file = options.data;
  provenance.data_hash = DatasetHash(data);
  provenance.title = data.title;
  provenance.config = config_text;
  provenance.synthetic = data.synthetic;
  return provenance;
}

std::string Binding::DescribeData() const {
  int train = 0;
  int validate = 0;
  for (const auto& [name, trial] : data.trials) ++(trial.role == Role::kTrain ? train : validate);
  return fmt::format("{}{} train + {} validate trials", data.synthetic ? "synthetic, " : "", train, validate);
}

Result<Binding> Bind(const BindingOptions& options, bool with_sensor_effects) {
  SINEW_ASSIGN(const ProblemEntry* entry, FindProblem(options.program->problems, options.problem));
  return Bind(options, [&](const Dataset& data, const YamlReader& settings) {
    return entry->bind(data, settings, with_sensor_effects);
  });
}

Result<Binding> BindToFit(const BindingOptions& options, bool with_sensor_effects) {
  SINEW_ASSIGN(Binding binding, Bind(options, with_sensor_effects));
  const Status fits = CheckSomethingToFit(binding.problem());
  if (!fits) return Fail("{}: {}", options.data, fits.error().message);
  return binding;
}

Result<Binding> Bind(const BindingOptions& options,
                     const std::function<Result<BoundProblem>(const Dataset&, const YamlReader&)>& bind) {
  Binding binding;
  SINEW_ASSIGN(binding.entry, FindProblem(options.program->problems, options.problem));
  SINEW_ASSIGN(binding.data, ReadDataset(options.data));
  if (!options.excitations.empty()) SINEW_TRY(ReplaceExcitations(options.excitations, binding.data));
  std::string config_name = options.config;
  if (!options.config.empty()) {
    SINEW_ASSIGN(binding.config_text, ReadFile(options.config));
  } else {
    config_name = options.problem + ".yaml";
    const auto file = binding.data.files.find(config_name);
    if (file != binding.data.files.end()) {
      binding.config_text = file->second;
    } else if (binding.entry->settings_optional) {
      binding.config_text = options.problem + ": {}";
    } else {
      return Fail("{}: holds no settings '{}'; give --config, or import the file into the data set",
                  options.data, config_name);
    }
    config_name = options.data + "/files/" + config_name;
  }
  SINEW_ASSIGN(const YamlReader settings, YamlReader::Parse(binding.config_text, config_name));
  auto result = bind(binding.data, settings);
  if (!result) {
    // Errors that have a place of their own keep it; all others are about the data.
    const bool has_place = result.error().message.rfind(config_name, 0) == 0;
    return has_place ? tl::unexpected(result.error())
                     : tl::unexpected(Error{options.data + ": " + result.error().message});
  }
  binding.bound = std::move(*result);
  return binding;
}

}  // namespace sinew
