#include "problems/free_body/problem.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "identify/execution/executor.h"

namespace sinew {
namespace {

// Of ten made-up and ten recorded tosses: 1.1e-5 at 1e-8, 1.2e-4 at 1e-7, 5e-4 at 1e-6, of the made-up ones'
// cost, and a hundredth of that of the recorded ones', whose residuals are not noise.
constexpr double kCostNoisePerAccuracy = 1e3;

}  // namespace

struct FreeBodyProblem::Scratch final : Problem::Workspace {
  std::vector<std::unique_ptr<WindowFit>> fits;
  std::vector<Matrix> derivatives;
  std::vector<Status> status;
};

FreeBodyProblem::FreeBodyProblem(FreeBodyData data, ParameterList list)
    : data_(std::move(data)), list_(std::move(list)), known_(new FittedStates[data_.windows.size()]) {
  std::vector<int> all;
  for (std::size_t i = 0; i < list_.parameters.size(); ++i) all.push_back(static_cast<int>(i));
  for (Block& block : data_.layout) block.columns = all;
}

Result<std::unique_ptr<FreeBodyProblem>> FreeBodyProblem::Make(const Dataset& data,
                                                               const FreeBodySettings& settings) {
  SINEW_ASSIGN(auto prepared, PrepareFreeBodyData(data, settings));
  auto list = ListFreeBodyParameters(prepared.body, prepared.speed);
  std::unique_ptr<FreeBodyProblem> problem(new FreeBodyProblem(std::move(prepared), std::move(list)));
  SINEW_TRY(CheckParameterList(problem->list_));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

std::unique_ptr<Problem::Workspace> FreeBodyProblem::NewWorkspace() const {
  auto scratch = std::make_unique<Scratch>();
  for (std::size_t w = 0; w < data_.windows.size(); ++w)
    scratch->fits.push_back(std::make_unique<WindowFit>(data_, data_.windows[w], &known_[w]));
  scratch->derivatives.resize(data_.windows.size());
  scratch->status.resize(data_.windows.size());
  return scratch;
}

FreeBodyNumbers FreeBodyProblem::NumbersAt(const Vector& parameters) const {
  FreeBodyNumbers numbers;
  for (std::size_t slot = 0; slot < numbers.value.size(); ++slot) {
    const int index = list_.index[slot];
    if (index >= 0) numbers.value[slot] = parameters[index];
  }
  return numbers;
}

Status FreeBodyProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  const FreeBodyNumbers numbers = NumbersAt(query.parameters);
  std::vector<int> slots;
  for (int slot = 0; slot < kFreeBodySlots; ++slot) {
    const int index = list_.index[static_cast<std::size_t>(slot)];
    if (index >= 0 && query.Differentiates(index)) slots.push_back(slot);
  }
  std::vector<std::size_t> wanted;
  for (std::size_t w = 0; w < data_.windows.size(); ++w) {
    const Toss& toss = data_.tosses[static_cast<std::size_t>(data_.windows[w].toss)];
    const auto begin = query.blocks.begin() + toss.first_block;
    if (std::any_of(begin, begin + kTossPhases * kPoseChannels, [](bool b) { return b; }))
      wanted.push_back(w);
  }
  CurrentExecutor().ForEach(wanted.size(), [&](std::size_t i, std::size_t) {
    const std::size_t w = wanted[i];
    scratch.status[w] = PredictWindow(w, query, numbers, slots, scratch, prediction);
  });
  for (const std::size_t w : wanted) {
    const TossWindow& window = data_.windows[w];
    if (!scratch.status[w]) {
      return Fail("trial '{}', from t = {:.4g} s: {}",
                  data_.tosses[static_cast<std::size_t>(window.toss)].trial, window.times.front(),
                  scratch.status[w].error().message);
    }
  }
  return {};
}

Status FreeBodyProblem::PredictWindow(std::size_t w, const Query& query, const FreeBodyNumbers& numbers,
                                      const std::vector<int>& slots, Scratch& scratch,
                                      Prediction& prediction) const {
  const TossWindow& window = data_.windows[w];
  WindowFit& fit = *scratch.fits[w];
  SINEW_TRY(fit.Fit(numbers));
  Matrix& derivatives = scratch.derivatives[w];
  if (!slots.empty()) SINEW_TRY(fit.Differentiate(numbers, slots, derivatives));
  const Toss& toss = data_.tosses[static_cast<std::size_t>(window.toss)];
  for (std::size_t i = 0; i < window.times.size(); ++i) {
    const int frame = window.first + static_cast<int>(i);
    const TossPhase phase = toss.PhaseOf(frame);
    const Eigen::Index at = phase == kFlight ? frame : frame - toss.in_flight;
    for (int c = 0; c < kPoseChannels; ++c) {
      const int block = toss.first_block + phase * kPoseChannels + c;
      if (!query.blocks[static_cast<std::size_t>(block)]) continue;
      prediction.values(block)[at] = fit.poses()[i][static_cast<std::size_t>(c)];
      auto slopes = prediction.derivatives(block);
      for (std::size_t s = 0; s < slots.size(); ++s) {
        slopes(at, list_.index[static_cast<std::size_t>(slots[s])]) =
            derivatives(static_cast<Eigen::Index>(i) * kPoseChannels + c, static_cast<Eigen::Index>(s));
      }
    }
  }
  return {};
}

double FreeBodyProblem::cost_noise_level() const {
  return std::min(1e-2, kCostNoisePerAccuracy * data_.body.accuracy);
}

std::string FreeBodyProblem::objective() const {
  return data_.weight[kContact] == data_.weight[kFlight]
             ? "half the sum of squared residuals of the poses in units of their noise"
             : "half the sum of squared residuals of the poses: before the first touch in units of the "
               "noise, "
               "after it in hundredths of the body's size";
}

Status FreeBodyProblem::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  const FreeBodyNumbers numbers = NumbersAt(parameters);
  for (std::size_t t = 0; t < data_.tosses.size(); ++t) {
    const Toss& toss = data_.tosses[t];
    Hdf5Node& node = details.At("free_body/" + toss.trial);
    node.At("time").SetVector(toss.times);
    const auto poses = PredictWholeToss(data_, static_cast<int>(t), numbers);
    if (!poses) {
      node.attributes["failure"] = poses.error().message;
      continue;
    }
    std::vector<double> measured;
    std::vector<double> predicted;
    std::vector<double> place;
    std::vector<double> turn;
    for (std::size_t i = 0; i < poses->size(); ++i) {
      const Pose& a = toss.poses[i];
      const Pose& b = (*poses)[i];
      measured.insert(measured.end(), a.begin(), a.end());
      predicted.insert(predicted.end(), b.begin(), b.end());
      place.push_back(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
      turn.push_back(AngleBetween(a, b));
    }
    node.At("measured").SetMatrix(toss.times.size(), kPoseChannels, std::move(measured));
    node.At("predicted").SetMatrix(toss.times.size(), kPoseChannels, std::move(predicted));
    node.At("position_error").SetVector(std::move(place));
    node.At("rotation_error").SetVector(std::move(turn));
    node.attributes["frames_before_touch"] = static_cast<std::int64_t>(toss.in_flight);
  }
  return {};
}

std::vector<Problem::Signal> FreeBodyProblem::ResidualCovariates(int block) const {
  const int per_toss = kTossPhases * kPoseChannels;
  const Toss& toss = data_.tosses[static_cast<std::size_t>(block / per_toss)];
  std::vector<double> speed(toss.times.size());
  for (std::size_t i = 1; i < speed.size(); ++i) {
    const Pose& a = toss.poses[i - 1];
    const Pose& b = toss.poses[i];
    speed[i] = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) / (toss.times[i] - toss.times[i - 1]);
  }
  speed[0] = speed[1];
  const auto of_phase = [&](const std::vector<double>& all) {
    const auto middle = all.begin() + toss.in_flight;
    const auto end = all.begin() + toss.compared;
    const bool flight = block % per_toss < kPoseChannels;
    return flight ? std::vector<double>(all.begin(), middle) : std::vector<double>(middle, end);
  };
  return {{"height", "m", of_phase(toss.height)}, {"speed", "m/s", of_phase(speed)}};
}

Result<std::vector<Pose>> PredictWholeToss(const FreeBodyData& data, int index,
                                           const FreeBodyNumbers& numbers) {
  const Toss& toss = data.tosses[static_cast<std::size_t>(index)];
  TossWindow flight;
  flight.toss = index;
  const int frames = std::min(std::max(toss.in_flight, kMinInFlight), static_cast<int>(toss.times.size()));
  flight.times.assign(toss.times.begin(), toss.times.begin() + frames);
  flight.guess = GuessStart(data.body, flight.times, toss.poses.data());
  WindowFit fit(data, flight);
  SINEW_TRY(fit.Fit(numbers));
  const FlightLimits limits = FlightLimits::For(data.body, toss.times.size());
  std::vector<Pose> poses(toss.times.size());
  SINEW_TRY(Fly(data.body, numbers.value, numbers.Used(), fit.start(), -1, toss.times, limits, poses.data()));
  return poses;
}

std::vector<Parameter> DefaultFreeBodyParameters() {
  FreeBody body;
  body.mass = 0.37;
  body.size = 0.05;
  for (int k = 0; k < kFreeBodyKnots; ++k) {
    body.knots[0].push_back(2.0 * k / (kFreeBodyKnots - 1));
    body.knots[1].push_back(3.0 * k / (kFreeBodyKnots - 1) - 1);
  }
  return ListFreeBodyParameters(body, 2).parameters;
}

}  // namespace sinew
