#include "problems/drive/problem.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "identify/noise/difference_noise.h"
#include "models/drive/integrator.h"
#include "models/drive/uses.h"
#include "problems/drive/data/input_noise.h"

namespace sinew {
namespace {
constexpr int kFirstTorqueChannel = 2;  // of kDriveChannels: torque, current
}  // namespace

struct DriveProblem::Scratch final : Problem::Workspace {
  std::vector<std::pair<int, int>> lanes;  // slot, column
  std::vector<double> plain;
  std::vector<Dual<4>> dual4;
  std::vector<Dual<8>> dual8;
  std::vector<Dual<12>> dual12;
  std::vector<Dual<16>> dual16;
  const std::vector<DriveRun>* runs = nullptr;  // that drive the joint in place of the problem's own
};

DriveProblem::DriveProblem(DriveData data) : data_(std::move(data)) {
  for (std::size_t r = 0; r < data_.runs.size(); ++r) {
    const DriveRun& run = data_.runs[r];
    segments_.push_back({r, 0, run.stops.size(), run.initial_position, run.initial_speed, 0});
  }
  ListParameters();
}

void DriveProblem::ListParameters() {
  list_ = ListDriveParameters(data_.traits, data_.scales, data_.starts);
  shared_ = list_.parameters.size();
  std::size_t number = 0;
  for (const DiscrepancyPort& port : list_.ports) {
    for (const DiscrepancyTerm& term : port.terms) data_.joint.knots[number++] = term.knots;
  }
  const DriveScales& s = data_.scales;
  states_ = data_.traits.integral_is_fitted ? 3 : 2;
  first_segment_.assign(data_.runs.size() + 1, segments_.size());
  for (std::size_t g = segments_.size(); g-- > 0;) first_segment_[segments_[g].run] = g;
  for (std::size_t r = 0; r < data_.runs.size(); ++r) {
    const DriveRun& run = data_.runs[r];
    for (std::size_t g = first_segment_[r]; g < first_segment_[r + 1]; ++g) {
      Segment& segment = segments_[g];
      const bool begins = segment.first == 0;
      const std::string name = begins ? "initial" : fmt::format("segment_{}", g - first_segment_[r] + 1);
      const std::string where = begins ? "at the begin of the trial"
                                       : fmt::format("at t = {:.6g} s", run.begin + run.stops[segment.first]);
      segment.state = static_cast<int>(list_.parameters.size());
      Parameter p;
      p.kind = ParameterKind::kNuisance;
      p.trial = run.trial;
      p.source = begins ? "state at the first time that is predicted" : "state where a new trajectory begins";
      p.name = name + "_position@" + run.trial;
      p.unit = data_.traits.rotary ? "rad" : "m";
      p.meaning = "position " + where;
      p.start = segment.position;
      p.lower = p.start - s.position;
      p.upper = p.start + s.position;
      list_.parameters.push_back(p);
      p.name = name + "_speed@" + run.trial;
      p.unit += "/s";
      p.meaning = "speed " + where;
      p.start = segment.speed;
      p.lower = p.start - 3 * s.speed;
      p.upper = p.start + 3 * s.speed;
      list_.parameters.push_back(p);
      if (states_ < 3) continue;
      p.name = name + "_integral@" + run.trial;
      p.unit = data_.traits.electric ? "V" : data_.traits.rotary ? "N*m" : "N";
      p.meaning = "output of the controller's integral " + where;
      p.start = 0;
      p.upper = run.gains.output_limit > 0 ? run.gains.output_limit : 3 * s.motor_command;
      p.lower = -p.upper;
      list_.parameters.push_back(p);
    }
  }
  blocks_of_run_.assign(data_.runs.size(), {});
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    const auto run = static_cast<std::size_t>(data_.blocks[b].run);
    blocks_of_run_[run].push_back(static_cast<int>(b));
    auto& columns = data_.layout[b].columns;
    columns.clear();
    for (std::size_t i = 0; i < shared_; ++i) columns.push_back(static_cast<int>(i));
    for (std::size_t g = first_segment_[run]; g < first_segment_[run + 1]; ++g) {
      for (std::size_t k = 0; k < states_; ++k) columns.push_back(segments_[g].state + static_cast<int>(k));
    }
  }
  if (data_.command.sampled()) {
    double longest = 0;
    for (const DriveSlot slot : {kSensingDelay, kActuationDelay}) {
      const int index = list_.index[slot];
      if (index >= 0) longest += list_.parameters[static_cast<std::size_t>(index)].upper;
    }
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
  const bool chosen = settings.step.has_value();
  if (!chosen) SINEW_TRY(problem->ChooseStep(problem->LargestStepError(), 5));
  SINEW_TRY(problem->PlanTrajectories(!chosen));
  return problem;
}

double DriveProblem::LargestStepError() const {
  double largest = kStepError * data_.scales.position;
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    const Block& block = data_.layout[b];
    if (data_.blocks[b].channel != 0 || block.role != BlockRole::kTrain) continue;
    const auto noise = noise::DifferenceNoise(block);
    if (noise && noise->visible) largest = std::min(largest, kStepErrorOfNoise * noise->deviation);
  }
  return largest;
}

Status DriveProblem::ChooseStep(double enough, int max_halvings) {
  const Vector rest = RestPoint(*this);
  const auto workspace = NewWorkspace();
  std::vector<bool> wanted(data_.layout.size(), false);
  for (std::size_t b = 0; b < wanted.size(); ++b) wanted[b] = data_.blocks[b].channel == 0;
  Prediction coarse(data_.layout);
  Prediction fine(data_.layout);
  // Starts may be so bad that there is no motion to compare; then the longest step stays.
  if (!Predict({rest, wanted, false, nullptr}, *workspace, coarse)) return {};
  for (int halving = 0; halving < max_halvings; ++halving) {
    data_.command.step *= 0.5;
    if (!Predict({rest, wanted, false, nullptr}, *workspace, fine)) break;
    double moved = 0;
    for (std::size_t b = 0; b < wanted.size(); ++b) {
      if (!wanted[b]) continue;
      const int block = static_cast<int>(b);
      moved = std::max(moved, (fine.values(block) - coarse.values(block)).cwiseAbs().maxCoeff());
    }
    if (moved <= enough) {
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
  scratch->dual12.resize(history_);
  scratch->dual16.resize(history_);
  return scratch;
}

int DriveProblem::IndexOf(int slot, const Segment& segment) const {
  if (slot == kInitialPosition) return segment.state;
  if (slot == kInitialSpeed) return segment.state + 1;
  if (slot == kInitialIntegral) return states_ > 2 ? segment.state + 2 : -1;
  return list_.index[static_cast<std::size_t>(slot)];
}

Status DriveProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  return PredictDrivenBy(data_.runs, query, static_cast<Scratch&>(workspace), prediction);
}

Result<bool> DriveProblem::PredictWithInputNoise(const Query& query, std::uint64_t draw, Workspace& workspace,
                                                 Prediction& prediction) const {
  std::vector<DriveRun> runs = data_.runs;
  bool noisy = false;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    DriveRun& run = runs[r];
    if (run.input_noise == 0) continue;
    noisy = true;
    Random random(Random::StreamSeed(draw, r));
    std::vector<double> noise(run.input.size());
    for (double& value : noise) value = run.input_noise * random.Normal();
    if (run.input_cutoff > 0) noise = LowPass(noise, run.input_cutoff);
    for (std::size_t i = 0; i < noise.size(); ++i) run.input[i] += noise[i];
    run.SetSlopes();
  }
  if (noisy) SINEW_TRY(PredictDrivenBy(runs, query, static_cast<Scratch&>(workspace), prediction));
  return noisy;
}

Status DriveProblem::PredictDrivenBy(const std::vector<DriveRun>& runs, const Query& query, Scratch& scratch,
                                     Prediction& prediction) const {
  scratch.runs = &runs;
  for (const Segment& segment : segments_) {
    const auto& blocks = blocks_of_run_[segment.run];
    const bool wanted = std::any_of(blocks.begin(), blocks.end(),
                                    [&](int b) { return query.blocks[static_cast<std::size_t>(b)]; });
    if (wanted) SINEW_TRY(PredictSegment(segment, query, scratch, prediction));
  }
  return {};
}

template <class F>
Status DriveProblem::InPasses(Scratch& scratch, F&& pass) {
  const auto& lanes = scratch.lanes;
  if (lanes.empty()) return pass(double(), 0, 0, scratch.plain);
  for (std::size_t first = 0; first < lanes.size();) {
    const std::size_t left = lanes.size() - first;
    const std::size_t count = std::min<std::size_t>(left, 16);
    if (left <= 4) {
      SINEW_TRY(pass(Dual<4>(), first, count, scratch.dual4));
    } else if (left <= 8) {
      SINEW_TRY(pass(Dual<8>(), first, count, scratch.dual8));
    } else if (left <= 12) {
      SINEW_TRY(pass(Dual<12>(), first, count, scratch.dual12));
    } else {
      SINEW_TRY(pass(Dual<16>(), first, count, scratch.dual16));
    }
    first += count;
  }
  return {};
}

template <class T, class Sink>
Status DriveProblem::Integrate(const Stretch& stretch, const Vector& parameters, std::size_t first_lane,
                               std::size_t lanes, bool wants_torque, Scratch& scratch,
                               std::vector<T>& history, Sink&& sink) const {
  const DriveRun& run = (*scratch.runs)[stretch.run];
  DriveNumbers numbers;
  std::array<T, kDriveSlots> variables;
  for (int slot = 0; slot < kDriveSlots; ++slot) {
    const auto at = static_cast<std::size_t>(slot);
    const int index = list_.index[at];
    numbers[at] = index < 0 ? list_.resting[at] : parameters[index];
    if (slot == kInitialPosition) numbers[at] = stretch.position;
    if (slot == kInitialSpeed) numbers[at] = stretch.speed;
    if (slot == kInitialIntegral) numbers[at] = stretch.integral;
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
      shift_moves =
          shift_moves || slot == kCommandDelay || slot == kActuationDelay || slot == kInputTimeOffset;
    }
  }
  const bool frictional = AnyFrictionAboveZero(numbers);
  const DriveDynamics<T> dynamics(data_.joint, variables, uses, frictional);
  const DriveDynamics<double> plain(data_.joint, numbers, uses, frictional);
  const double rate = FastestRate(numbers, data_.joint, data_.command, run);
  DriveIntegrator<T> integrator(data_.command, run, dynamics, plain, rate, shift_moves, wants_torque,
                                history);
  return integrator.Run(stretch.first, stretch.end, stretch.reading,
                        [&](std::size_t stop, const DriveSample<T>& sample) {
                          sink(stop, sample, integrator.position(), integrator.speed());
                        });
}

Status DriveProblem::IntegrateLanes(const Stretch& stretch, const Vector& parameters,
                                    const std::vector<std::pair<int, int>>& lanes, Workspace& workspace,
                                    const LaneSink& sink) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  scratch.runs = &data_.runs;
  scratch.lanes = lanes;
  return InPasses(scratch, [&](auto type, std::size_t first, std::size_t count, auto& history) -> Status {
    using T = decltype(type);
    return Integrate<T>(
        stretch, parameters, first, count, true, scratch, history,
        [&](std::size_t stop, const DriveSample<T>& sample, const T& position, const T& speed) {
          const std::array<const T*, 6> values{&speed,        &position,      &sample.position,
                                               &sample.speed, &sample.torque, &sample.current};
          for (int channel = -2; channel < 4; ++channel) {
            const T& value = *values[static_cast<std::size_t>(channel + 2)];
            const double* slopes = nullptr;
            if constexpr (!std::is_same_v<T, double>) slopes = value.d.data();
            sink(stop, channel, Value(value), slopes, first, count);
          }
        });
  });
}

Status DriveProblem::PredictSegment(const Segment& segment, const Query& query, Scratch& scratch,
                                    Prediction& prediction) const {
  // Columns of the states of the other segments of this run, which this one does not depend on.
  const std::size_t first_state = shared_ + states_ * (static_cast<std::size_t>(&segment - segments_.data()) -
                                                       first_segment_[segment.run]);
  const std::size_t columns =
      shared_ + states_ * (first_segment_[segment.run + 1] - first_segment_[segment.run]);
  auto& lanes = scratch.lanes;
  lanes.clear();
  for (int slot = 0; slot < kDriveSlots; ++slot) {
    const int index = IndexOf(slot, segment);
    if (index < 0 || !query.Differentiates(index)) continue;
    const int own = index - segment.state;
    lanes.emplace_back(slot, own < 0 ? index : static_cast<int>(first_state) + own);
  }
  const Stretch stretch{segment.run,
                        segment.first,
                        segment.end,
                        query.parameters[segment.state],
                        query.parameters[segment.state + 1],
                        states_ > 2 ? query.parameters[segment.state + 2] : 0,
                        segment.position};
  const auto& blocks = blocks_of_run_[segment.run];
  const bool wants_torque = std::any_of(blocks.begin(), blocks.end(), [&](int b) {
    const auto block = static_cast<std::size_t>(b);
    return query.blocks[block] && data_.blocks[block].channel >= kFirstTorqueChannel;
  });
  return InPasses(
      scratch, [&](auto type, std::size_t first_lane, std::size_t count, auto& history) -> Status {
        using T = decltype(type);
        bool finite = true;
        SINEW_TRY(Integrate<T>(stretch, query.parameters, first_lane, count, wants_torque, scratch, history,
                               [&](std::size_t stop, const DriveSample<T>& sample, const T&, const T&) {
                                 const std::array<const T*, 4> channels{&sample.position, &sample.speed,
                                                                        &sample.torque, &sample.current};
                                 for (const int block : blocks) {
                                   const auto b = static_cast<std::size_t>(block);
                                   const int row = data_.blocks[b].rows[stop];
                                   if (!query.blocks[b] || row < 0) continue;
                                   const T& value =
                                       *channels[static_cast<std::size_t>(data_.blocks[b].channel)];
                                   prediction.values(block)[row] = Value(value);
                                   finite = finite && std::isfinite(Value(value));
                                   auto derivatives = prediction.derivatives(block);
                                   if (query.derivatives && first_lane == 0) {
                                     for (std::size_t c = shared_; c < columns; ++c)
                                       derivatives(row, static_cast<Eigen::Index>(c)) = 0;
                                   }
                                   if constexpr (!std::is_same_v<T, double>) {
                                     for (std::size_t i = 0; i < count; ++i) {
                                       derivatives(row, scratch.lanes[first_lane + i].second) = value.d[i];
                                       finite = finite && std::isfinite(value.d[i]);
                                     }
                                   }
                                 }
                               }));
        if (!finite) {
          return Fail("trial '{}': the prediction or its sensitivity is not finite",
                      data_.runs[segment.run].trial);
        }
        return {};
      });
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
