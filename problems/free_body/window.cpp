#include "problems/free_body/window.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"

namespace sinew {
namespace {

constexpr int kMaxIterations = 30;
constexpr double kEnough = 1e-7;    // predicted gain, as a share of the cost
constexpr double kOnTheWay = 1e-3;  // the same, of a fit that only leads to the next
constexpr double kNearly = 1e-4;    // the same, of the last of these
constexpr double kRougher = 1e3;    // accuracy of their integrator, over that of the answer
constexpr double kCostNoiseLevel =
    1e-4;                           // the same, where the steps of the integrator and kinks of contact show
constexpr double kNothing = 1e-18;  // cost per residual: rounding
constexpr double kFirstDamping = 1e-6;  // of columns of unit length
constexpr double kMaxDamping = 1e6;
constexpr double kRank = 1e-7;
// A step may be at most so long: place as a share of the size, turn [rad], velocity [m/s], spin [rad/s].
constexpr double kLongestPlace = 0.2;
constexpr double kLongestTurn = 0.2;
constexpr double kLongestVelocity = 0.5;
constexpr double kLongestSpin = 8;

Eigen::Index Rows(const TossWindow& window) {
  return static_cast<Eigen::Index>(window.times.size()) * kPoseChannels;
}

// Shortens a step whose parts are too long.
void Clamp(double size, Eigen::Ref<Vector> step) {
  const double share =
      std::max({step.segment<3>(0).norm() / (kLongestPlace * size), step.segment<3>(3).norm() / kLongestTurn,
                step.segment<3>(6).norm() / kLongestVelocity, step.segment<3>(9).norm() / kLongestSpin, 1.0});
  step /= share;
}

}  // namespace

std::array<bool, kFreeBodySlots> FreeBodyNumbers::Used() const {
  std::array<bool, kFreeBodySlots> used{};
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = value[i] != 0;
  return used;
}

std::optional<FlightStart> FittedStarts::Find(const Digest::Value& numbers) const {
  const std::lock_guard lock(mutex_);
  const auto found = starts_.find(numbers);
  if (found == starts_.end()) return std::nullopt;
  return found->second;
}

void FittedStarts::Keep(const Digest::Value& numbers, const FlightStart& start) {
  const std::lock_guard lock(mutex_);
  if (starts_.size() >= kMost) starts_.clear();
  starts_.emplace(numbers, start);
}

WindowFit::WindowFit(const FreeBodyData& data, const TossWindow& window, FittedStarts* known)
    : data_(data), window_(window), known_(known) {
  limits_ = FlightLimits::For(data.body, window.times.size());
  if (window.in_flight >= kMinInFlight)
    flight_.assign(window.times.begin(), window.times.begin() + window.in_flight);
  const std::size_t frames = window.times.size();
  poses_.resize(frames);
  trial_poses_.resize(frames);
  flown12_.resize(frames);
  flown4_.resize(frames);
  flown8_.resize(frames);
  flown16_.resize(frames);
  for (Vector* v : {&weight_, &residual_, &trial_residual_}) v->resize(Rows(window));
  const std::size_t half = (flight_.size() + frames) / 2;
  half_.assign(window.times.begin(), window.times.begin() + static_cast<std::ptrdiff_t>(half));
  const Toss& toss = data.tosses[static_cast<std::size_t>(window.toss)];
  for (std::size_t i = 0; i < frames; ++i) {
    for (std::size_t c = 0; c < kPoseChannels; ++c) {
      weight_[static_cast<Eigen::Index>(i * kPoseChannels + c)] =
          data.weight[toss.PhaseOf(window.first + static_cast<int>(i))][c];
    }
  }
  for (Matrix* m : {&jacobian_, &trial_jacobian_}) m->resize(Rows(window), kStartLanes);
}

// Into the trial's places; rows of frames that are not compared now are 0.
Status WindowFit::Evaluate(const FreeBodyNumbers& numbers, const FlightStart& start) {
  SINEW_TRY(Fly(data_.body, numbers.value, numbers.Used(), start, 0, *times_, limits_, flown12_.data()));
  const Pose* measured = data_.tosses[static_cast<std::size_t>(window_.toss)].poses.data() + window_.first;
  trial_residual_.setZero();
  trial_jacobian_.setZero();
  for (std::size_t i = 0; i < times_->size(); ++i) {
    for (std::size_t c = 0; c < kPoseChannels; ++c) {
      const auto row = static_cast<Eigen::Index>(i * kPoseChannels + c);
      trial_poses_[i][c] = flown12_[i][c].value;
      trial_residual_[row] = weight_[row] * (trial_poses_[i][c] - measured[i][c]);
      for (Eigen::Index k = 0; k < kStartLanes; ++k)
        trial_jacobian_(row, k) = weight_[row] * flown12_[i][c].d[static_cast<std::size_t>(k)];
    }
  }
  trial_cost_ = 0.5 * trial_residual_.squaredNorm();
  if (!std::isfinite(trial_cost_)) return Fail("the pose is not finite");
  if (!trial_jacobian_.allFinite()) return Fail("a derivative of the pose is not finite");
  return {};
}

void WindowFit::Accept(const FlightStart& start) {
  start_ = start;
  cost_ = trial_cost_;
  poses_.swap(trial_poses_);
  residual_.swap(trial_residual_);
  jacobian_.swap(trial_jacobian_);
}

// A search evaluates the derivatives at a point after the cost there.
Status WindowFit::Fit(const FreeBodyNumbers& numbers) {
  const Digest::Value asked = Digest().Add(numbers.value.data(), numbers.value.size()).value();
  if (fitted_ == asked) return {};
  fitted_.reset();
  if (const auto start = known_ != nullptr ? known_->Find(asked) : std::nullopt) {
    times_ = &window_.times;
    SINEW_TRY(Evaluate(numbers, *start));
    Accept(*start);
  } else {
    const Status status = FitAnew(numbers);
    limits_.accuracy = data_.body.accuracy;
    SINEW_TRY(status);
    if (known_ != nullptr) known_->Keep(asked, start_);
  }
  fitted_ = asked;
  return {};
}

// The flight before the first touch, where the pose is nearly linear in the state, leads to the right valley
// of the whole window.
Status WindowFit::FitAnew(const FreeBodyNumbers& numbers) {
  start_ = window_.guess;
  limits_.accuracy = kRougher * data_.body.accuracy;
  if (!flight_.empty()) SINEW_TRY(Search(numbers, flight_, kOnTheWay));
  SINEW_TRY(Search(numbers, half_, kOnTheWay));
  SINEW_TRY(Search(numbers, window_.times, kNearly));
  limits_.accuracy = data_.body.accuracy;
  return Search(numbers, window_.times, kEnough);
}

// Levenberg, Marquardt, from start_. Trial points are evaluated with derivatives, since most are accepted.
Status WindowFit::Search(const FreeBodyNumbers& numbers, const std::vector<double>& times, double enough) {
  times_ = &times;
  SINEW_TRY(Evaluate(numbers, start_));
  Accept(start_);
  double damping = kFirstDamping;
  const double least = kNothing * static_cast<double>(residual_.size());
  for (int iteration = 0; iteration < kMaxIterations && damping <= kMaxDamping && cost_ > least;
       ++iteration) {
    using Square = Eigen::Matrix<double, kStartLanes, kStartLanes>;
    using Lanes = Eigen::Matrix<double, kStartLanes, 1>;
    Square normal = jacobian_.transpose() * jacobian_;
    const Lanes gradient = jacobian_.transpose() * residual_;
    const Lanes scale = normal.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    normal = scale.asDiagonal() * normal * scale.asDiagonal();
    normal.diagonal().array() += damping;
    const Eigen::LDLT<Square> factor(normal);
    Vector step = -scale.cwiseProduct(factor.solve(scale.cwiseProduct(gradient)));
    Clamp(data_.body.size, step);
    const double predicted = -gradient.dot(step) - 0.5 * (jacobian_ * step).squaredNorm();
    if (!(predicted > enough * cost_)) break;
    const FlightStart next = start_.Moved(step);
    if (!Evaluate(numbers, next) || !(trial_cost_ < cost_)) {
      if (predicted < kCostNoiseLevel * cost_) break;
      damping = std::max(10 * damping, 1e-4);
      continue;
    }
    Accept(next);
    damping = std::max(0.1 * damping, kFirstDamping);
  }
  return {};
}

void WindowFit::FactoriseStates() {
  Matrix unit = jacobian_;
  for (Eigen::Index k = 0; k < unit.cols(); ++k) {
    const double length = unit.col(k).norm();
    if (length > 0) unit.col(k) /= length;
  }
  Eigen::ColPivHouseholderQR<Matrix> qr(unit);
  qr.setThreshold(kRank);
  basis_ = OrthonormalBasis(qr);
}

template <class T>
Status WindowFit::Pass(const FreeBodyNumbers& numbers, const std::vector<int>& slots, std::size_t first,
                       std::size_t count, std::vector<std::array<T, kPoseChannels>>& flown,
                       Matrix& derivatives) {
  std::array<T, kFreeBodySlots> variables;
  std::array<bool, kFreeBodySlots> used = numbers.Used();
  for (std::size_t i = 0; i < variables.size(); ++i) variables[i] = numbers.value[i];
  for (std::size_t i = 0; i < count; ++i) {
    const auto slot = static_cast<std::size_t>(slots[first + i]);
    variables[slot].d[i] = 1;
    used[slot] = true;
  }
  SINEW_TRY(Fly(data_.body, variables, used, start_, -1, window_.times, limits_, flown.data()));
  for (std::size_t frame = 0; frame < flown.size(); ++frame) {
    for (std::size_t c = 0; c < kPoseChannels; ++c) {
      for (std::size_t i = 0; i < count; ++i)
        derivatives(static_cast<Eigen::Index>(frame * kPoseChannels + c),
                    static_cast<Eigen::Index>(first + i)) = flown[frame][c].d[i];
    }
  }
  return {};
}

Status WindowFit::Differentiate(const FreeBodyNumbers& numbers, const std::vector<int>& slots,
                                Matrix& derivatives) {
  derivatives.resize(Rows(window_), static_cast<Eigen::Index>(slots.size()));
  for (std::size_t first = 0; first < slots.size();) {
    const std::size_t count = std::min<std::size_t>(slots.size() - first, 16);
    if (count <= 4) {
      SINEW_TRY(Pass(numbers, slots, first, count, flown4_, derivatives));
    } else if (count <= 8) {
      SINEW_TRY(Pass(numbers, slots, first, count, flown8_, derivatives));
    } else {
      SINEW_TRY(Pass(numbers, slots, first, count, flown16_, derivatives));
    }
    first += count;
  }
  FactoriseStates();
  derivatives.array().colwise() *= weight_.array();
  derivatives -= ProjectionOnto(basis_, derivatives);
  derivatives.array().colwise() /= weight_.array();
  return {};
}

}  // namespace sinew
