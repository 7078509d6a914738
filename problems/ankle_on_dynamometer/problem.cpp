#include "problems/ankle_on_dynamometer/problem.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "identify/execution/executor.h"
#include "problems/ankle_on_dynamometer/trial_run.h"

namespace sinew {
namespace {

constexpr int kLanes = 8;

// Slots that a trial's channels depend on.
bool Matters(AnkleTask task, int slot) {
  if (slot <= kLastOfAttachment) return true;
  if (task == AnkleTask::kAttachmentAlone) return false;
  // The first of these knots is at rest.
  const bool of_activation =
      slot > kActiveMomentTerm && slot < kActiveMomentTerm + static_cast<int>(kMomentKnots);
  const bool of_muscle = slot >= kAnkleSlots && PlaceInMuscle(slot) >= kActivationTerm;
  const bool of_drive = (slot >= kAnkleShape && slot <= kAntagonist) || of_activation || of_muscle;
  return task == AnkleTask::kActive || !of_drive;
}

// What a stop shows, its torque that of the machine.
template <class T>
struct Shown {
  T torque{0.0};
  const StrappedFootRun<T>* run = nullptr;

  [[nodiscard]] T Of(const AnkleBlock& block) const {
    if (block.quantity == AnkleQuantity::kMachineTorque) return torque;
    if (run == nullptr) return T(0.0);
    if (block.quantity == AnkleQuantity::kAnkleAngle) return run->instant().ankle_angle;
    return run->fibre_lengths()[block.muscle];
  }
};

}  // namespace

struct AnkleProblem::TrialScratch {
  FootSolutions solutions;
  std::vector<double> plain;
  std::vector<Dual<kLanes>> dual;
  std::vector<std::vector<std::size_t>> first_row;  // [blocks][stops + 1] rows of each stop
  Status status;
  // Of the last plain run: a search asks for the derivatives where it asked for the values before, and many
  // of its steps leave the parameters of some trials as they are.
  std::vector<double> values;                  // [slots] empty: none, or it failed
  std::vector<std::vector<double>> predicted;  // [blocks][stops] the torque's without its zero
  std::vector<double> interaction;             // [stops] torque of the foot on the plate
};

struct AnkleProblem::Scratch final : Problem::Workspace {
  std::vector<TrialScratch> trials;
};

AnkleProblem::AnkleProblem(AnkleData data, ParameterList list)
    : data_(std::move(data)), list_(std::move(list)), defaults_(AnkleDefaults(data_.settings)) {
  for (AnkleTrial& trial : data_.trials) {
    std::vector<int>& columns = trial.columns;
    for (std::size_t slot = 0; slot < list_.index.size(); ++slot) {
      if (list_.index[slot] >= 0 && Matters(trial.task, static_cast<int>(slot)))
        columns.push_back(list_.index[slot]);
    }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    if (data_.settings.torque_zero > 0) AddZero(trial);
    for (const AnkleBlock& block : trial.blocks) {
      auto& of_block = data_.layout[static_cast<std::size_t>(block.block)].columns;
      of_block = columns;
      if (trial.zero >= 0 && block.quantity == AnkleQuantity::kMachineTorque) of_block.push_back(trial.zero);
    }
  }
  ListSteps();
}

Result<std::unique_ptr<AnkleProblem>> AnkleProblem::Make(const Dataset& data, AnkleSettings settings,
                                                         double margin) {
  SINEW_ASSIGN(auto prepared, PrepareAnkleData(data, std::move(settings), margin));
  SINEW_ASSIGN(auto list, ListAnkleParameters(prepared.settings));
  std::unique_ptr<AnkleProblem> problem(new AnkleProblem(std::move(prepared), std::move(list)));
  SINEW_TRY(CheckParameterList(problem->list_));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

void AnkleProblem::AddZero(AnkleTrial& trial) {
  constexpr double kReach = 10;  // standard deviations
  const double deviation = data_.settings.torque_zero;
  Parameter p = BaseParameter("torque_zero@" + trial.name, "N*m", "reading of the machine without a torque",
                              -kReach * deviation, kReach * deviation, 0);
  p.kind = ParameterKind::kNuisance;
  p.trial = trial.name;
  p.prior = {0, deviation};
  trial.zero = static_cast<int>(list_.parameters.size());
  list_.parameters.push_back(std::move(p));
}

void AnkleProblem::ListSteps() {
  struct Kind {
    AnkleTask task;
    const char* name;
    int first;
    int end;
  };
  const int slots = static_cast<int>(list_.index.size());
  const Kind kinds[] = {{AnkleTask::kAttachmentAlone, "attachment alone", 0, kSoleStiffness},
                        {AnkleTask::kPassive, "passive", kSoleStiffness, kAnkleShape},
                        {AnkleTask::kActive, "active", kAnkleShape, slots}};
  for (const Kind& kind : kinds) {
    FitStep step;
    step.name = kind.name;
    for (int slot = 0; slot < slots; ++slot) {
      // A muscle that is silent is a spring beyond its slack length.
      const bool spring =
          kind.task == AnkleTask::kPassive && slot >= kAnkleSlots && PlaceInMuscle(slot) == kAnkleSlackLength;
      if (!spring && (slot < kind.first || slot >= kind.end)) continue;
      const int index = list_.index[static_cast<std::size_t>(slot)];
      if (index >= 0 && list_.parameters[static_cast<std::size_t>(index)].kind == ParameterKind::kBase)
        step.parameters.push_back(index);
    }
    for (const AnkleTrial& trial : data_.trials) {
      if (trial.task != kind.task) continue;
      for (const AnkleBlock& block : trial.blocks) {
        if (data_.layout[static_cast<std::size_t>(block.block)].role != BlockRole::kPredicted)
          step.blocks.push_back(block.block);
      }
    }
    std::sort(step.parameters.begin(), step.parameters.end());
    step.parameters.erase(std::unique(step.parameters.begin(), step.parameters.end()), step.parameters.end());
    std::sort(step.blocks.begin(), step.blocks.end());
    const bool fitted = std::any_of(step.blocks.begin(), step.blocks.end(), [this](int b) {
      return data_.layout[static_cast<std::size_t>(b)].role == BlockRole::kTrain;
    });
    if (fitted && !step.parameters.empty()) steps_.push_back(std::move(step));
  }
  FitStep all;
  all.name = "all levels";
  for (std::size_t i = 0; i < list_.parameters.size(); ++i) {
    if (list_.parameters[i].kind == ParameterKind::kBase) all.parameters.push_back(static_cast<int>(i));
  }
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    if (data_.layout[b].role != BlockRole::kPredicted) all.blocks.push_back(static_cast<int>(b));
  }
  steps_.push_back(std::move(all));
}

std::unique_ptr<Problem::Workspace> AnkleProblem::NewWorkspace() const {
  auto scratch = std::make_unique<Scratch>();
  scratch->trials.resize(data_.trials.size());
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    const AnkleTrial& trial = data_.trials[t];
    for (const AnkleBlock& block : trial.blocks) {
      std::vector<std::size_t> first(trial.stops.size() + 1, 0);
      for (const std::size_t stop : block.stop) ++first[stop + 1];
      for (std::size_t s = 1; s < first.size(); ++s) first[s] += first[s - 1];
      scratch->trials[t].first_row.push_back(std::move(first));
    }
  }
  return scratch;
}

std::vector<double> AnkleProblem::ValuesAt(const Vector& parameters) const {
  std::vector<double> values = defaults_;
  for (std::size_t slot = 0; slot < values.size(); ++slot) {
    if (list_.index[slot] >= 0) values[slot] = parameters[list_.index[slot]];
  }
  return values;
}

Status AnkleProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  std::vector<std::size_t> wanted;
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    const auto& blocks = data_.trials[t].blocks;
    if (std::any_of(blocks.begin(), blocks.end(), [&](const AnkleBlock& block) {
          return query.blocks[static_cast<std::size_t>(block.block)];
        }))
      wanted.push_back(t);
  }
  CurrentExecutor().ForEach(wanted.size(), [&](std::size_t i, std::size_t) {
    TrialScratch& own = scratch.trials[wanted[i]];
    own.status = PredictTrial(wanted[i], query, own, prediction);
  });
  for (const std::size_t t : wanted) {
    const Status& status = scratch.trials[t].status;
    if (!status) return Fail("trial '{}': {}", data_.trials[t].name, status.error().message);
  }
  return {};
}

Status AnkleProblem::PredictTrial(std::size_t t, const Query& query, TrialScratch& scratch,
                                  Prediction& prediction) const {
  const AnkleTrial& trial = data_.trials[t];
  scratch.plain = ValuesAt(query.parameters);
  SINEW_TRY(RunPlain(trial, scratch));
  const double zero = trial.zero >= 0 ? query.parameters[trial.zero] : 0;
  for (std::size_t b = 0; b < trial.blocks.size(); ++b) {
    const AnkleBlock& block = trial.blocks[b];
    if (!query.blocks[static_cast<std::size_t>(block.block)]) continue;
    const double offset = block.quantity == AnkleQuantity::kMachineTorque ? zero : 0;
    auto values = prediction.values(block.block);
    for (std::size_t row = 0; row < block.stop.size(); ++row)
      values[static_cast<Eigen::Index>(row)] = scratch.predicted[b][block.stop[row]] + offset;
  }
  if (!query.derivatives) return {};
  if (trial.zero >= 0 && query.Differentiates(trial.zero)) {
    for (const AnkleBlock& block : trial.blocks) {
      if (block.quantity != AnkleQuantity::kMachineTorque ||
          !query.blocks[static_cast<std::size_t>(block.block)])
        continue;
      prediction.derivatives(block.block).col(static_cast<Eigen::Index>(trial.columns.size())).setOnes();
    }
  }
  std::vector<std::size_t> of_attachment;  // places in the trial's columns
  std::vector<std::size_t> others;
  for (std::size_t c = 0; c < trial.columns.size(); ++c) {
    if (query.Differentiates(trial.columns[c]))
      (IsOfAttachment(trial.columns[c]) ? of_attachment : others).push_back(c);
  }
  SINEW_TRY(Differentiate(trial, query, of_attachment, false, scratch, prediction));
  return Differentiate(trial, query, others, true, scratch, prediction);
}

Status AnkleProblem::RunPlain(const AnkleTrial& trial, TrialScratch& scratch) const {
  const auto same = [&] {
    if (scratch.values.empty()) return false;
    for (std::size_t slot = 0; slot < scratch.plain.size(); ++slot) {
      if (Matters(trial.task, static_cast<int>(slot)) && scratch.values[slot] != scratch.plain[slot])
        return false;
    }
    return true;
  };
  if (same()) return {};
  scratch.values.clear();
  scratch.predicted.resize(trial.blocks.size());
  for (auto& values : scratch.predicted) values.resize(trial.stops.size());
  scratch.interaction.assign(trial.stops.size(), 0);
  SINEW_TRY(RunAnkleTrial(data_, trial, scratch.plain, scratch.solutions,
                          [&](std::size_t stop, double torque, const StrappedFootRun<double>* run) {
                            const Shown<double> shown{torque, run};
                            for (std::size_t b = 0; b < trial.blocks.size(); ++b)
                              scratch.predicted[b][stop] = shown.Of(trial.blocks[b]);
                            if (run != nullptr) scratch.interaction[stop] = run->instant().torque;
                          }));
  scratch.values = scratch.plain;
  return {};
}

bool AnkleProblem::IsOfAttachment(int parameter) const {
  for (std::size_t slot = 0; slot < list_.index.size(); ++slot) {
    if (list_.index[slot] == parameter && slot > kLastOfAttachment) return false;
  }
  return true;
}

Status AnkleProblem::Differentiate(const AnkleTrial& trial, const Query& query,
                                   const std::vector<std::size_t>& places, bool moves, TrialScratch& scratch,
                                   Prediction& prediction) const {
  using Number = Dual<kLanes>;
  for (std::size_t first = 0; first < places.size(); first += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, places.size() - first);
    scratch.dual.assign(scratch.plain.begin(), scratch.plain.end());
    for (std::size_t slot = 0; slot < list_.index.size(); ++slot) {
      for (std::size_t lane = 0; lane < count; ++lane) {
        if (list_.index[slot] == trial.columns[places[first + lane]])
          scratch.dual[slot] = Number::Variable(scratch.plain[slot], static_cast<int>(lane));
      }
    }
    const auto see = [&](std::size_t stop, const Number& torque, const StrappedFootRun<Number>* run) {
      const Shown<Number> shown{torque, run};
      for (std::size_t b = 0; b < trial.blocks.size(); ++b) {
        const AnkleBlock& block = trial.blocks[b];
        if (!query.blocks[static_cast<std::size_t>(block.block)]) continue;
        const auto& first_row = scratch.first_row[b];
        if (first_row[stop] == first_row[stop + 1]) continue;
        const Number value = shown.Of(block);
        auto derivatives = prediction.derivatives(block.block);
        for (std::size_t row = first_row[stop]; row < first_row[stop + 1]; ++row) {
          for (std::size_t lane = 0; lane < count; ++lane)
            derivatives(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(places[first + lane])) =
                value.d[lane];
        }
      }
    };
    if (moves) {
      SINEW_TRY(RunAnkleTrial(data_, trial, scratch.dual, scratch.solutions, see));
      continue;
    }
    const StrappedFoot<Number> foot = FootOf(data_.settings, scratch.dual);
    for (std::size_t stop = 0; stop < trial.stops.size(); ++stop)
      see(stop,
          StrappedFootRun<Number>::AttachmentTorque(foot.attachment, data_.settings.foot, trial.plate[stop],
                                                    Number(scratch.interaction[stop])),
          nullptr);
  }
  return {};
}

std::vector<Problem::Signal> AnkleProblem::ResidualCovariates(int b) const {
  const Block& block = data_.layout[static_cast<std::size_t>(b)];
  const auto trial = std::find_if(data_.trials.begin(), data_.trials.end(),
                                  [&](const AnkleTrial& t) { return t.name == block.trial; });
  const auto of = std::find_if(trial->blocks.begin(), trial->blocks.end(),
                               [&](const AnkleBlock& own) { return own.block == b; });
  Signal angle{"machine_angle", "rad", {}};
  Signal velocity{"machine_velocity", "rad/s", {}};
  Signal excitation{"mean_excitation", "1", {}};
  for (const int sample : block.sample) {
    const PlateMotion& plate = trial->plate[of->stop[static_cast<std::size_t>(sample)]];
    angle.values.push_back(plate.angle);
    velocity.values.push_back(plate.velocity);
    double mean = 0;
    if (!trial->excitation_time.empty()) {
      const double t = block.prediction_time[static_cast<std::size_t>(sample)];
      const auto& times = trial->excitation_time;
      const auto after = std::upper_bound(times.begin(), times.end() - 1, t);
      const auto k = static_cast<std::size_t>(after - times.begin());
      for (const auto& values : trial->excitations)
        mean += values[k] / static_cast<double>(trial->excitations.size());
    }
    excitation.values.push_back(mean);
  }
  return {std::move(angle), std::move(velocity), std::move(excitation)};
}

std::vector<Parameter> DefaultAnkleParameters() {
  return ListAnkleParameters(AnkleSettings())->parameters;
}

}  // namespace sinew
