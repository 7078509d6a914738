// sinew simulate: what a model predicts at given parameters.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cli/binding.h"
#include "cli/command.h"
#include "cli/command_files.h"
#include "cli/mode_options.h"
#include "cli/terminal.h"
#include "datasets/io/dataset_file.h"
#include "datasets/io/storage_file.h"
#include "identify/files/recorded_cost.h"
#include "identify/text/warnings.h"
#include "identify/unmeasured_estimate.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

struct SimulateWords {
  BindingOptions binding;
  ModeOptions mode;
  WorkOptions work;
  std::vector<std::string> set;
  std::string from;
  std::string out;
  std::string json;

  [[nodiscard]] CommandFiles Files() const {
    return {{binding.data, binding.config, from, binding.excitations}, {out}, json};
  }
};

// @param left_out if not null, how many nuisance values of the run were of trials that these data do not have
Result<Vector> Parameters(const SimulateWords& words, const Problem& problem, int* left_out = nullptr) {
  Vector parameters = RestPoint(problem);
  const auto assign = [&](const std::string& name, double value) -> Status {
    SINEW_ASSIGN(const int index, FindParameter(problem.parameters(), name));
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(index)];
    if (!(value >= p.lower && value <= p.upper)) {
      return Fail("parameter '{}' = {}: outside its bounds {} .. {} [{}]", name, value, p.lower, p.upper,
                  p.unit);
    }
    parameters[index] = value;
    return {};
  };
  if (!words.from.empty()) {
    SINEW_ASSIGN(const RecordedRun recorded, ReadRun(words.from));
    for (const auto& [name, value] : recorded.values) {
      const bool nuisance = recorded.incidental.count(name) > 0;
      if ((nuisance || recorded.at_null.count(name) > 0) && !FindParameter(problem.parameters(), name)) {
        if (nuisance && left_out != nullptr) ++*left_out;
        continue;
      }
      const Status status = assign(name, value);
      if (!status) return Fail("{}: {}", words.from, status.error().message);
    }
  }
  for (const std::string& text : words.set) {
    SINEW_ASSIGN(const auto assignment, ParseAssignment("--set", text));
    SINEW_TRY(assign(assignment.first, assignment.second));
  }
  return parameters;
}

// Blocks of one trial that share their times become one grid.
// @param unmeasured whose bands become channels NAME_band95; may be null
std::map<std::string, Trial> ToTrials(const Binding& binding, const FullPrediction& prediction,
                                      const UnmeasuredEstimate* unmeasured) {
  std::map<std::string, Trial> trials;
  const Layout& layout = binding.problem().layout();
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    Trial& trial = trials[block.trial];
    const Trial& measured = binding.data.trials.at(block.trial);
    trial.role = measured.role;
    trial.cut_from = measured.cut_from;
    std::string name = "simulated";
    for (int i = 2; trial.grids.count(name) > 0 && trial.grids[name].time != block.prediction_time; ++i) {
      name = fmt::format("simulated_{}", i);
    }
    Grid& grid = trial.grids[name];
    grid.time = block.prediction_time;
    const Vector& values = prediction.values[b];
    grid.channels[block.channel] = {block.unit, ChannelKind::kMeasured, std::nullopt,
                                    std::vector<double>(values.data(), values.data() + values.size())};
    if (unmeasured == nullptr || unmeasured->half_width[b].size() == 0) continue;
    const Vector& half_width = unmeasured->half_width[b];
    grid.channels[block.channel + "_band95"] = {
        block.unit, ChannelKind::kMeasured, std::nullopt,
        std::vector<double>(half_width.data(), half_width.data() + half_width.size())};
  }
  return trials;
}

// One file per grid; with more than one, trial and grid are added to the name.
// @param doubts about the parameters, which are added to the titles
std::vector<std::pair<std::string, Storage>> ToStorages(const std::string& out,
                                                        const std::map<std::string, Trial>& trials,
                                                        const std::vector<std::string>& doubts) {
  std::vector<std::pair<std::string, Storage>> storages;
  std::size_t grids = 0;
  for (const auto& [name, trial] : trials) grids += trial.grids.size();
  for (const auto& [name, trial] : trials) {
    for (const auto& [grid_name, grid] : trial.grids) {
      Storage storage;
      storage.title = name;
      for (const std::string& doubt : doubts) storage.title += "; warning: " + doubt;
      storage.in_degrees = false;
      storage.time = grid.time;
      for (const auto& [channel, values] : grid.channels) {
        storage.names.push_back(channel);
        storage.columns.push_back(values.values);
      }
      fs::path path(out);
      if (grids > 1) {
        path.replace_filename(fmt::format("{}_{}{}.sto", path.stem().string(), name,
                                          trial.grids.size() > 1 ? "_" + grid_name : ""));
      }
      storages.emplace_back(path.string(), std::move(storage));
    }
  }
  return storages;
}

// @return the names of the files written.
Result<std::vector<std::string>> WritePrediction(const SimulateWords& words, const Binding& binding,
                                                 const std::map<std::string, Trial>& trials,
                                                 const std::vector<std::string>& doubts) {
  if (fs::path(words.out).extension() == ".h5") {
    Dataset out;
    out.title = "simulated: " + binding.data.title;
    out.source = "sinew simulate " + words.binding.problem + " on " + words.binding.data;
    for (const std::string& doubt : doubts) out.source += "; warning: " + doubt;
    out.synthetic = true;
    out.trials = trials;
    SINEW_ASSIGN(const FileLocks locks, ClaimFiles(words.Files()));
    SINEW_TRY(WriteDataset(words.out, out));
    return std::vector<std::string>{words.out};
  }
  const auto storages = ToStorages(words.out, trials, doubts);
  CommandFiles files = words.Files();
  files.written.clear();
  for (const auto& [path, storage] : storages) files.written.push_back(path);
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles(files));
  for (const auto& [path, storage] : storages) SINEW_TRY(WriteStorage(path, storage));
  return files.written;
}

// As JSON: how well what was measured is predicted, and the files that were written.
std::string SimulationJson(const SimulateWords& words, const FullPrediction& prediction,
                           const std::vector<std::string>& files, const std::vector<std::string>& doubts) {
  nlohmann::ordered_json json{{"schema", "sinew.simulation/1"},
                              {"problem", words.binding.problem},
                              {"data", words.binding.data},
                              {"files", files},
                              {"warnings", doubts},
                              {"fit", nlohmann::ordered_json::array()}};
  const auto finite = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  for (const FitQuality& q : prediction.quality) {
    json["fit"].push_back({{"trial", q.trial},
                           {"role", ToString(q.role)},
                           {"channel", q.channel},
                           {"unit", q.unit},
                           {"rmse", finite(q.rmse)},
                           {"mae", finite(q.mae)},
                           {"r2", finite(q.r2)},
                           {"n", q.n}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

// Sensor effects look beyond the samples, so the problem that has them predicts a margin: it is bound only if
// a parameter is asked for that the problem alone does not have.
// Where excitations are found, `mode` keeps how, and the problem is always bare.
Result<Binding> BindFor(const SimulateWords& words, std::unique_ptr<ExcitationMode>& mode) {
  if (words.binding.problem == "nms") {
    const auto bind = [&](const Dataset& data, const YamlReader& settings) -> Result<BoundProblem> {
      SINEW_ASSIGN(BoundMode made, BindWithMode(data, settings, words.mode.change));
      mode = std::move(made.mode);
      return std::move(made.bound);
    };
    SINEW_ASSIGN(Binding moded, Bind(words.binding, bind));
    if (mode != nullptr) return moded;
  }
  SINEW_ASSIGN(Binding bare, Bind(words.binding, false));
  if (Parameters(words, bare.problem())) return bare;
  return Bind(words.binding, true);
}

void PrintNotes(const SimulateWords& words, const Binding& binding, int left_out) {
  if (left_out > 0) {
    Print(stderr,
          Wrapped(
              left_out == 1
                  ? fmt::format("note: 1 nuisance value of {} belongs to a trial that these data do not have",
                                words.from)
                  : fmt::format("note: {} nuisance values of {} belong to trials that these data do not have",
                                left_out, words.from),
              0));
  }
  for (const std::string& note : binding.bound.notes) Print(stderr, Wrapped("note: " + note, 0));
}

void PrintQuality(const FullPrediction& prediction, const std::vector<std::string>& files) {
  std::vector<std::vector<std::string>> rows{{"trial", "role", "channel", "RMSE", "unit", "R2"}};
  for (const FitQuality& q : prediction.quality) {
    rows.push_back({q.trial, ToString(q.role), q.channel, fmt::format("{:.4g}", q.rmse), q.unit,
                    fmt::format("{:.4f}", q.r2)});
  }
  for (const std::string& file : files) Print(stdout, fmt::format("{}\n", file));
  Print(stdout, Table(rows, 2));
}

Result<int> RunSimulate(SimulateWords& words) {
  const auto limit = words.work.LimitThreads();
  const std::string extension = fs::path(words.out).extension().string();
  if (extension != ".h5" && extension != ".sto")
    return Fail("--out {}: expected a name that ends with .h5 or .sto", words.out);
  SINEW_TRY(CheckFiles(words.Files()));
  if (!words.binding.excitations.empty() && words.binding.problem != "nms")
    return Fail("--excitations: the problem '{}' takes none, only nms does", words.binding.problem);
  SINEW_TRY(words.mode.CheckFor(words.binding.problem));
  ProgressLine line("simulate", words.work.quiet);
  std::unique_ptr<ExcitationMode> mode;
  SINEW_ASSIGN(const Binding binding, BindFor(words, mode));
  int left_out = 0;
  SINEW_ASSIGN(Vector parameters, Parameters(words, binding.problem(), &left_out));
  if (mode != nullptr) {
    line.Show("finding excitations");
    const Status found = mode->Find(parameters);
    if (!found) return Fail("{}: {}", words.binding.data, found.error().message);
  }
  std::vector<std::string> doubts;
  if (!words.from.empty()) {
    SINEW_ASSIGN(const RecordedRun run, ReadRun(words.from));
    doubts = text::Warnings(files::WarningsOfRun(words.from, run, binding.problem(),
                                                 binding.ToProvenance(words.binding).data_hash));
  }
  line.Show("predicting");
  std::optional<UnmeasuredEstimate> unmeasured;
  if (!words.from.empty()) unmeasured = binding.problem().EstimateUnmeasured(parameters);
  if (unmeasured) parameters = unmeasured->parameters;
  auto prediction = PredictAll(binding.problem(), parameters);
  line.Clear();
  if (!prediction) {
    return ReportNotUsable(*words.binding.program, prediction.error().message);
  }
  if (unmeasured) TakeOver(*unmeasured, prediction->values);
  auto trials = ToTrials(binding, *prediction, unmeasured ? &*unmeasured : nullptr);
  if (mode != nullptr) SINEW_TRY(mode->AddTo(trials, parameters));
  SINEW_ASSIGN(const std::vector<std::string> files, WritePrediction(words, binding, trials, doubts));
  if (!words.json.empty())
    SINEW_TRY(WriteText(words.json, SimulationJson(words, *prediction, files, doubts)));
  if (words.json != "-") PrintQuality(*prediction, files);
  PrintNotes(words, binding, left_out);
  for (const std::string& doubt : doubts) Print(stderr, Wrapped("warning: " + doubt, 0));
  if (mode != nullptr) PrintExcitations(*mode, words.json != "-");
  return kDone;
}

}  // namespace

void AddSimulateCommand(Command app, const RunAction& run) {
  auto words = std::make_shared<SimulateWords>();
  Command command = app.AddCommand("simulate", "Predict every channel at given parameters");
  words->binding.AddTo(command);
  command.Add("--set", words->set, "Parameters; all others have their start values, effects their null")
      .Split(',')
      .Shows("NAME=VALUE");
  command.Add("--from", words->from, "Parameters of a run file").Shows("RUN.h5");
  command
      .Add("--excitations", words->binding.excitations,
           "nms: take the excitations of all trials from this file, such as what `simulate emg_shape` "
           "predicted")
      .Shows("EMG.h5");
  words->mode.AddTo(command);
  command.Add("--out", words->out, "Predicted channels").Required().Shows("OUT.h5|OUT.sto");
  AddJsonTo(command, words->json);
  words->work.AddThreadsTo(command);
  words->work.AddQuietTo(command);
  command.Runs(run, [=] { return RunSimulate(*words); });
}

}  // namespace sinew
