#include "problems/drive/problem.h"

#include <algorithm>
#include <cmath>

#include "models/drive/integrator.h"
#include "models/drive/uses.h"

namespace sinew {

struct DriveProblem::Scratch final : Problem::Workspace {
  std::vector<std::pair<int, int>> lanes;  // slot, column
  std::vector<double> plain;
  std::vector<Dual<4>> dual4;
  std::vector<Dual<8>> dual8;
  std::vector<Dual<16>> dual16;
};

DriveProblem::DriveProblem(DriveData data) : data_(std::move(data)) {
  ListParameters();
}

void DriveProblem::ListParameters() {
  list_ = ListDriveParameters(data_.traits, data_.scales, data_.starts);
  shared_ = list_.parameters.size();
  for (std::size_t term = 0; term < list_.ports.front().terms.size(); ++term)
    data_.joint.knots[term] = list_.ports.front().terms[term].knots;
  const DriveScales& s = data_.scales;
  for (const DriveRun& run : data_.runs) {
    Parameter p;
    p.kind = ParameterKind::kNuisance;
    p.trial = run.trial;
    p.source = "state at the first time that is predicted";
    p.name = "initial_position@" + run.trial;
    p.unit = data_.traits.rotary ? "rad" : "m";
    p.meaning = "position at the begin of the trial";
    p.start = run.initial_position;
    p.lower = p.start - s.position;
    p.upper = p.start + s.position;
    list_.parameters.push_back(p);
    p.name = "initial_speed@" + run.trial;
    p.unit += "/s";
    p.meaning = "speed at the begin of the trial";
    p.start = run.initial_speed;
    p.lower = p.start - 3 * s.speed;
    p.upper = p.start + 3 * s.speed;
    list_.parameters.push_back(p);
  }
  blocks_of_run_.resize(data_.runs.size());
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    const auto run = static_cast<std::size_t>(data_.blocks[b].run);
    blocks_of_run_[run].push_back(static_cast<int>(b));
    auto& columns = data_.layout[b].columns;
    columns.clear();
    for (std::size_t i = 0; i < shared_; ++i) columns.push_back(static_cast<int>(i));
    columns.push_back(static_cast<int>(shared_ + 2 * run));
    columns.push_back(static_cast<int>(shared_ + 2 * run + 1));
  }
  if (data_.command.sampled() && list_.index[kSensingDelay] >= 0) {
    const double longest = list_.parameters[static_cast<std::size_t>(list_.index[kSensingDelay])].upper;
    for (const DriveRun& run : data_.runs)
      history_ = std::max(history_, DriveHistorySize(longest, run.gains.control_period));
  }
}

Result<std::unique_ptr<DriveProblem>> DriveProblem::Make(const Dataset& data, const DriveSettings& settings,
                                                         double margin) {
  SINEW_ASSIGN(auto prepared, PrepareDriveData(data, settings, margin));
  std::unique_ptr<DriveProblem> problem(new DriveProblem(std::move(prepared)));
  SINEW_TRY(CheckParameterList(problem->list_));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  if (!settings.step) SINEW_TRY(problem->ChooseStep());
  return problem;
}

Status DriveProblem::ChooseStep() {
  constexpr double kEnough = 1e-4;  // of the spread of the positions
  constexpr int kMaxHalvings = 5;
  const Vector rest = RestPoint(*this);
  const auto workspace = NewWorkspace();
  std::vector<bool> wanted(data_.layout.size(), false);
  double spread = 0;
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (data_.blocks[b].channel != 0) continue;
    wanted[b] = true;
    spread = std::max(spread, data_.scales.position);
  }
  Prediction coarse(data_.layout);
  Prediction fine(data_.layout);
  // Starts may be so bad that there is no motion to compare; then the longest step stays.
  if (!Predict({rest, wanted, false, nullptr}, *workspace, coarse)) return {};
  for (int halving = 0; halving < kMaxHalvings; ++halving) {
    data_.command.step *= 0.5;
    if (!Predict({rest, wanted, false, nullptr}, *workspace, fine)) break;
    double moved = 0;
    for (std::size_t b = 0; b < wanted.size(); ++b) {
      if (!wanted[b]) continue;
      const int block = static_cast<int>(b);
      moved = std::max(moved, (fine.values(block) - coarse.values(block)).cwiseAbs().maxCoeff());
    }
    if (moved <= kEnough * spread) {
      data_.command.step *= 2;
      break;
    }
    std::swap(coarse, fine);
  }
  return {};
}

std::unique_ptr<Problem::Workspace> DriveProblem::NewWorkspace() const {
  auto scratch = std::make_unique<Scratch>();
  scratch->lanes.reserve(kDriveSlots);
  scratch->plain.resize(history_);
  scratch->dual4.resize(history_);
  scratch->dual8.resize(history_);
  scratch->dual16.resize(history_);
  return scratch;
}

int DriveProblem::IndexOf(int slot, std::size_t run) const {
  if (slot == kInitialPosition) return static_cast<int>(shared_ + 2 * run);
  if (slot == kInitialSpeed) return static_cast<int>(shared_ + 2 * run + 1);
  return list_.index[static_cast<std::size_t>(slot)];
}

Status DriveProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  for (std::size_t run = 0; run < data_.runs.size(); ++run) {
    const auto& blocks = blocks_of_run_[run];
    const bool wanted = std::any_of(blocks.begin(), blocks.end(),
                                    [&](int b) { return query.blocks[static_cast<std::size_t>(b)]; });
    if (wanted) SINEW_TRY(PredictRun(run, query, scratch, prediction));
  }
  return {};
}

Status DriveProblem::PredictRun(std::size_t run, const Query& query, Scratch& scratch,
                                Prediction& prediction) const {
  auto& lanes = scratch.lanes;
  lanes.clear();
  for (int slot = 0; slot < kDriveSlots; ++slot) {
    const int index = IndexOf(slot, run);
    if (index < 0 || !query.Differentiates(index)) continue;
    const int own = index - static_cast<int>(shared_ + 2 * run);
    lanes.emplace_back(slot, own < 0 ? index : static_cast<int>(shared_) + own);
  }
  if (lanes.empty()) return Pass<double>(run, query, 0, 0, scratch, scratch.plain, prediction);
  for (std::size_t first = 0; first < lanes.size();) {
    const std::size_t left = lanes.size() - first;
    const std::size_t count = std::min<std::size_t>(left, 16);
    if (left <= 4) {
      SINEW_TRY(Pass<Dual<4>>(run, query, first, count, scratch, scratch.dual4, prediction));
    } else if (left <= 8) {
      SINEW_TRY(Pass<Dual<8>>(run, query, first, count, scratch, scratch.dual8, prediction));
    } else {
      SINEW_TRY(Pass<Dual<16>>(run, query, first, count, scratch, scratch.dual16, prediction));
    }
    first += count;
  }
  return {};
}

template <class T>
Status DriveProblem::Pass(std::size_t run_index, const Query& query, std::size_t first_lane,
                          std::size_t lanes, Scratch& scratch, std::vector<T>& history,
                          Prediction& prediction) const {
  const DriveRun& run = data_.runs[run_index];
  DriveNumbers numbers;
  std::array<T, kDriveSlots> variables;
  for (int slot = 0; slot < kDriveSlots; ++slot) {
    const auto at = static_cast<std::size_t>(slot);
    const int index = IndexOf(slot, run_index);
    numbers[at] = index < 0 ? list_.resting[at] : query.parameters[index];
    variables[at] = T(numbers[at]);
  }
  std::array<bool, kDriveSlots> differentiated{};
  for (std::size_t i = 0; i < lanes; ++i)
    differentiated[static_cast<std::size_t>(scratch.lanes[first_lane + i].first)] = true;
  const DriveUses uses = UsesOf(numbers, differentiated, data_.joint);
  bool shift_moves = false;
  if constexpr (!std::is_same_v<T, double>) {
    for (std::size_t i = 0; i < lanes; ++i) {
      const int slot = scratch.lanes[first_lane + i].first;
      variables[static_cast<std::size_t>(slot)].d[i] = 1;
      shift_moves = shift_moves || slot == kCommandDelay || slot == kInputTimeOffset;
    }
  }
  const bool frictional = AnyFrictionAboveZero(numbers);
  const DriveDynamics<T> dynamics(data_.joint, variables, uses, frictional);
  const DriveDynamics<double> plain(data_.joint, numbers, uses, frictional);
  const double rate = FastestRate(numbers, data_.joint, data_.command, run);
  DriveIntegrator<T> integrator(data_.command, run, dynamics, plain, rate, shift_moves, history);
  bool finite = true;
  SINEW_TRY(integrator.Run([&](std::size_t stop, const DriveSample<T>& sample) {
    const std::array<const T*, 4> channels{&sample.position, &sample.speed, &sample.torque, &sample.current};
    for (const int block : blocks_of_run_[run_index]) {
      const auto b = static_cast<std::size_t>(block);
      const int row = data_.blocks[b].rows[stop];
      if (!query.blocks[b] || row < 0) continue;
      const T& value = *channels[static_cast<std::size_t>(data_.blocks[b].channel)];
      prediction.values(block)[row] = Value(value);
      finite = finite && std::isfinite(Value(value));
      if constexpr (!std::is_same_v<T, double>) {
        auto derivatives = prediction.derivatives(block);
        for (std::size_t i = 0; i < lanes; ++i) {
          derivatives(row, scratch.lanes[first_lane + i].second) = value.d[i];
          finite = finite && std::isfinite(value.d[i]);
        }
      }
    }
  }));
  if (!finite) return Fail("trial '{}': the prediction or its sensitivity is not finite", run.trial);
  return {};
}

std::string DriveProblem::objective() const {
  return data_.known_noise ? "half the sum of squared errors / noise variance"
                           : "half the sum over channels of mean squared error / variance of the channel";
}

Status DriveProblem::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  Prediction prediction(data_.layout);
  const auto workspace = NewWorkspace();
  const std::vector<bool> all(data_.layout.size(), true);
  SINEW_TRY(Predict({parameters, all, false, nullptr}, *workspace, prediction));
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    const Block& block = data_.layout[b];
    Hdf5Node& node = details.At("drive/" + block.trial + "/" + block.channel);
    const auto values = prediction.values(static_cast<int>(b));
    node.attributes["unit"] = block.unit;
    node.At("time").SetVector(block.prediction_time);
    node.At("predicted").SetVector(std::vector<double>(values.data(), values.data() + values.size()));
  }
  return {};
}

std::vector<Problem::Signal> DriveProblem::ResidualCovariates(int block) const {
  const DriveBlock& of = data_.blocks[static_cast<std::size_t>(block)];
  const std::string unit = data_.traits.rotary ? "rad" : "m";
  return {{"position", unit, of.position},
          {"velocity", unit + "/s", of.velocity},
          {"command", data_.traits.input_unit, of.command}};
}

std::vector<Parameter> DefaultDriveParameters() {
  DriveStarts starts{};
  starts[kInertia] = 0.05;
  starts[kViscousFriction] = 0.05;
  starts[kDriveGain] = 1;
  starts[kTorqueConstant] = 1;
  starts[kResistance] = 1;
  return ListDriveParameters({}, {}, starts).parameters;
}

}  // namespace sinew
