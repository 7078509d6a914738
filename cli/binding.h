// From the command line to a problem that is ready to be evaluated: what identify, simulate and compare have
// in common.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/work_options.h"
#include "identify/files/run_file.h"
#include "identify/fit_setup.h"
#include "identify/solvers/solver.h"
#include "problems/registry.h"

namespace sinew {

/// The words of a command that name a problem, its data and its settings.
struct BindingOptions {
  std::string problem;
  std::string data;
  std::string config;
  const Program* program = nullptr;  ///< whose problems; set by AddTo
  std::string excitations;  ///< another file's grids "simulated" or "excitations" in place of the data's
  void AddTo(Command command);
};

/// The words of a command that say what is fitted and how.
struct FitOptions : WorkOptions {
  std::vector<std::string> free;
  std::vector<std::string> fix;
  std::vector<std::string> bounds;
  std::vector<std::string> start;
  std::vector<std::string> release;
  std::optional<long> max_evaluations;
  std::optional<double> max_seconds;
  std::string work_times;
  void AddTo(Command command);
  /// Only what chooses the base parameters and where they begin.
  void AddChoiceTo(Command command);
  /// Seed, threads, quiet, times of the work.
  void AddWorkTo(Command command);

  /// Errors: a word that is not NAME=VALUE or NAME=LOW:HIGH.
  [[nodiscard]] Result<FitRequest> Request() const;
  [[nodiscard]] Budget ToBudget() const;
  /// That file, and the one of --work-times if it was given.
  [[nodiscard]] std::vector<std::string> Written(const std::string& out) const;
  [[nodiscard]] SolverOptions ToSolverOptions() const;
};

/// Data, settings and problem, bound together.
struct Binding {
  const ProblemEntry* entry = nullptr;
  Dataset data;
  std::string config_text;
  BoundProblem bound;

  [[nodiscard]] const Problem& problem() const { return *bound.problem; }
  [[nodiscard]] Provenance ToProvenance(const BindingOptions& options) const;
  /// "synthetic, 3 train + 2 validate trials"
  [[nodiscard]] std::string DescribeData() const;
};

/// Settings come from --config, or from the file PROBLEM.yaml in the data set.
Result<Binding> Bind(const BindingOptions& options, bool with_sensor_effects);
/// The same for commands that fit. Errors, with the data's name: no training trial is compared.
Result<Binding> BindToFit(const BindingOptions& options, bool with_sensor_effects);
/// With another way to bind than the registry's. @param bind (data, settings)
Result<Binding> Bind(const BindingOptions& options,
                     const std::function<Result<BoundProblem>(const Dataset&, const YamlReader&)>& bind);

/// "--starts N".
void AddStartsTo(Command command, std::optional<int>& starts);
/// Whether a solver, or a link of a chain, is the one that --starts is about.
bool HasStarts(const std::string& solver);

/// "NAME=VALUE". Errors say what was expected of which option.
Result<std::pair<std::string, double>> ParseAssignment(const std::string& option, const std::string& text);

/// "NAME" or "NAME:PARAM=VALUE,PARAM=VALUE", a word of --effect. Errors: also a parameter that is given
/// twice.
Result<std::pair<std::string, std::map<std::string, double>>> ParseEffect(const std::string& text);

}  // namespace sinew
