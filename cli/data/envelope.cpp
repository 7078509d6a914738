// sinew data envelope: raw EMG becomes excitations.
#include "models/emg/envelope.h"

#include <cstdio>
#include <filesystem>

#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "problems/nms/excitation/emg_excitations.h"

namespace sinew {
namespace {

struct EnvelopeWords {
  std::string path;
  std::string out;
  std::vector<std::string> grids;
  std::vector<std::string> channels;
  std::optional<double> high_pass;
  std::optional<double> low_pass;
  int order = EnvelopeSettings().order;
  std::string normalise = "all";
  std::optional<double> rate;
  std::optional<double> longest_gap;
  std::string json;
};

constexpr const char* kNormalise =
    "--normalise {}: expected all, none, a trial, trials:NAME,... or values:MUSCLE=VALUE,...";

Status ParseNormalise(const std::string& word, ExcitationSettings& settings) {
  const std::string trials = "trials:";
  const std::string values = "values:";
  if (word == "all" || word == "max") {
    settings.normalisation = Normalisation::kAllTrials;
  } else if (word == "none") {
    settings.normalisation = Normalisation::kNone;
  } else if (word.rfind(values, 0) == 0) {
    settings.normalisation = Normalisation::kGiven;
    for (const auto part : Split(std::string_view(word).substr(values.size()), ',')) {
      const auto at = part.find('=');
      const auto value = at < part.size() ? ParseNumber(part.substr(at + 1)) : std::nullopt;
      if (!value || !(*value > 0)) return Fail("--normalise values: '{}' is no MUSCLE=VALUE above 0", part);
      settings.maxima[std::string(part.substr(0, at))] = *value;
    }
  } else {
    settings.normalisation = Normalisation::kNamedTrials;
    const std::string_view names =
        word.rfind(trials, 0) == 0 ? std::string_view(word).substr(trials.size()) : std::string_view(word);
    for (const auto name : Split(names, ',')) {
      if (name.empty()) return Fail(kNormalise, word);
      settings.trials.emplace_back(name);
    }
  }
  return {};
}

Result<ExcitationSettings> ParseSettings(const EnvelopeWords& words) {
  ExcitationSettings settings;
  EnvelopeSettings& envelope = settings.envelope;
  envelope.high_pass_Hz = words.high_pass.value_or(envelope.high_pass_Hz);
  envelope.low_pass_Hz = words.low_pass.value_or(envelope.low_pass_Hz);
  envelope.order = words.order;
  envelope.longest_gap_s = words.longest_gap.value_or(envelope.longest_gap_s);
  SINEW_TRY(CheckEnvelopeSettings(envelope));
  settings.rate_Hz = words.rate.value_or(settings.rate_Hz);
  settings.grids = words.grids;
  for (const std::string& word : words.channels) {
    const auto at = word.find('=');
    const std::string muscle = at == std::string::npos ? word : word.substr(at + 1);
    if (at == 0 || muscle.empty()) return Fail("--channels {}: expected CHANNEL or CHANNEL=MUSCLE", word);
    settings.channels.emplace_back(word.substr(0, at), muscle);
  }
  SINEW_TRY(ParseNormalise(words.normalise, settings));
  return settings;
}

Result<int> MakeEnvelope(const EnvelopeWords& words) {
  SINEW_ASSIGN(const ExcitationSettings settings, ParseSettings(words));
  SINEW_ASSIGN(const FileLocks locks, ClaimInPlace(words.path, words.out, {}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  const auto report = AddExcitations(data, settings);
  if (!report) return Fail("{}: {}", words.path, report.error().message);
  const std::string& out = words.out.empty() ? words.path : words.out;
  SINEW_TRY(WriteDataset(out, data));
  for (const std::string& note : report->notes) Print(stderr, Wrapped("note: " + note, 0));
  SINEW_TRY(Report(
      words.json, [&] { return DatasetJson(data); }, out + ": " + Join(report->lines, "\n  ") + "\n"));
  return kDone;
}

}  // namespace

void AddEnvelopeCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<EnvelopeWords>();
  Command command = data.AddCommand("envelope", "Compute excitations from raw EMG (docs/envelopes.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--out", words->out, "Data set to write; default: F.h5 itself").NotEmpty().Shows("G.h5");
  command
      .Add("--grid", words->grids,
           "Grids with raw EMG; default: named *emg*, else the one with channels in V")
      .Split(',')
      .Shows("GRID");
  command
      .Add("--channels", words->channels,
           "Channels to take, and the muscles they become; default: all in V, else all")
      .Split(',')
      .Shows("CHANNEL[=MUSCLE]");
  command.Add("--high-pass", words->high_pass, "Cut-off of the raw signal in Hz; default: 30").AtLeastZero();
  command.Add("--low-pass", words->low_pass, "Cut-off of the rectified signal in Hz; default: 6")
      .AtLeastZero();
  command
      .Add("--order", words->order,
           "Of both filters, forward and backward together: 4 is a Butterworth of order 2 run both ways")
      .Shows("N")
      .ShowsDefault();
  command
      .Add("--normalise,--normalize", words->normalise,
           "Divide by the maximum over all trials, over named trials (MVC), by given values (V), or not")
      .Shows("all|none|TRIAL|trials:NAME,...|values:MUSCLE=VALUE,...")
      .ShowsDefault();
  command.Add("--rate", words->rate, "Of the excitations in Hz; 0: as recorded; default: 200").AtLeastZero();
  command.Add("--longest-gap", words->longest_gap, "Gaps up to here are bridged, in s; default: 0.05")
      .AtLeastZero();
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return MakeEnvelope(*words); });
}

}  // namespace sinew
