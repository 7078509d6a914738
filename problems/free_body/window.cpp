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
constexpr int kMaxRefinements = 6;
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

using StartLanes = Eigen::Matrix<double, kStartLanes, 1>;

// Damped steps of Gauss and Newton.
class StateSteps {
 public:
  // @param jacobian [residuals x kStartLanes] @param damping of columns of unit length
  StateSteps(const Matrix& jacobian, double damping) {
    Square normal = jacobian.transpose() * jacobian;
    scale_ = normal.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    normal = scale_.asDiagonal() * normal * scale_.asDiagonal();
    normal.diagonal().array() += damping;
    factor_.compute(normal);
  }
  [[nodiscard]] Vector From(const StartLanes& gradient) const {
    return -scale_.cwiseProduct(factor_.solve(scale_.cwiseProduct(gradient)));
  }

 private:
  using Square = Eigen::Matrix<double, kStartLanes, kStartLanes>;
  StartLanes scale_;
  Eigen::LDLT<Square> factor_;
};

Digest::Value DigestOf(const FreeBodyNumbers& numbers) {
  return Digest().Add(numbers.value.data(), numbers.value.size()).value();
}

double NearestPower(double base, double x) {
  return x > 0 ? std::pow(base, std::round(std::log(x) / std::log(base))) : 0;
}

// The nearest point of a coarse grid of contact laws, without effects.
FreeBodyNumbers ReferenceOf(const FreeBodyNumbers& numbers) {
  FreeBodyNumbers reference;
  for (const int slot : {kStiffness, kDissipation, kFriction}) {
    const auto i = static_cast<std::size_t>(slot);
    reference.value[i] = NearestPower(slot == kStiffness ? 4 : 2, numbers.value[i]);
  }
  return reference;
}

}  // namespace

std::array<bool, kFreeBodySlots> FreeBodyNumbers::Used() const {
  std::array<bool, kFreeBodySlots> used{};
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = value[i] != 0;
  return used;
}

WindowFit::WindowFit(const FreeBodyData& data, const TossWindow& window, FittedStates* known)
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

// Of the frames that are compared now; rows of others are 0. @pre the trial's poses are those of them
Status WindowFit::Weigh() {
  const Pose* measured = data_.tosses[static_cast<std::size_t>(window_.toss)].poses.data() + window_.first;
  trial_residual_.setZero();
  for (std::size_t i = 0; i < times_->size(); ++i) {
    for (std::size_t c = 0; c < kPoseChannels; ++c) {
      const auto row = static_cast<Eigen::Index>(i * kPoseChannels + c);
      trial_residual_[row] = weight_[row] * (trial_poses_[i][c] - measured[i][c]);
    }
  }
  trial_cost_ = 0.5 * trial_residual_.squaredNorm();
  if (!std::isfinite(trial_cost_)) return Fail("the pose is not finite");
  return {};
}

// Into the trial's places.
Status WindowFit::Evaluate(const FreeBodyNumbers& numbers, const FlightStart& start) {
  SINEW_TRY(Fly(data_.body, numbers.value, numbers.Used(), start, 0, *times_, limits_, flown12_.data()));
  trial_jacobian_.setZero();
  for (std::size_t i = 0; i < times_->size(); ++i) {
    for (std::size_t c = 0; c < kPoseChannels; ++c) {
      const auto row = static_cast<Eigen::Index>(i * kPoseChannels + c);
      trial_poses_[i][c] = flown12_[i][c].value;
      for (Eigen::Index k = 0; k < kStartLanes; ++k)
        trial_jacobian_(row, k) = weight_[row] * flown12_[i][c].d[static_cast<std::size_t>(k)];
    }
  }
  if (!trial_jacobian_.allFinite()) return Fail("a derivative of the pose is not finite");
  return Weigh();
}

// The same without derivatives, in a third of the time.
Status WindowFit::EvaluateValues(const FreeBodyNumbers& numbers, const FlightStart& start) {
  SINEW_TRY(Fly(data_.body, numbers.value, numbers.Used(), start, -1, *times_, limits_, trial_poses_.data()));
  return Weigh();
}

// Half a sum of squares that rounding leaves.
double WindowFit::Nothing() const {
  return kNothing * static_cast<double>(residual_.size());
}

void WindowFit::Accept(const FlightStart& start) {
  AcceptValues(start);
  jacobian_.swap(trial_jacobian_);
  jacobian_is_at_start_ = true;
}

void WindowFit::AcceptValues(const FlightStart& start) {
  start_ = start;
  cost_ = trial_cost_;
  poses_.swap(trial_poses_);
  residual_.swap(trial_residual_);
  jacobian_is_at_start_ = false;
}

// A search evaluates the derivatives at a point after the cost there.
Status WindowFit::Fit(const FreeBodyNumbers& numbers) {
  const Digest::Value asked = DigestOf(numbers);
  if (fitted_ == asked) return {};
  fitted_.reset();
  times_ = &window_.times;
  if (const auto start = known_ != nullptr ? known_->starts.Find(asked) : std::nullopt) {
    SINEW_TRY(EvaluateValues(numbers, *start));
    AcceptValues(*start);
  } else {
    limits_.accuracy = kRougher * data_.body.accuracy;
    Status status = Approach(numbers);
    limits_.accuracy = data_.body.accuracy;
    if (status) status = Refine(numbers);
    SINEW_TRY(status);
    if (known_ != nullptr) known_->starts.Keep(asked, start_);
  }
  fitted_ = asked;
  return {};
}

// The flight before the first touch, where the pose is nearly linear in the state, leads to the right valley
// of the whole window.
Status WindowFit::FitFlight(const FreeBodyNumbers& numbers) {
  start_ = window_.guess;
  if (flight_.empty()) return {};
  return Search(numbers, flight_, kOnTheWay);
}

Status WindowFit::FitWhole(const FreeBodyNumbers& numbers) {
  SINEW_TRY(Search(numbers, half_, kOnTheWay));
  return Search(numbers, window_.times, kNearly);
}

StateChange WindowFit::ChangeAt(const FreeBodyNumbers& reference) {
  const Digest::Value asked = DigestOf(reference);
  if (const auto known = known_->changes.Find(asked)) return *known;
  StateChange change;
  if (FitFlight(reference)) {
    const FlightStart flown = start_;
    if (FitWhole(reference)) change = flown.MoveTo(start_);
  }
  known_->changes.Keep(asked, change);
  return change;
}

Result<double> WindowFit::CostFrom(const FreeBodyNumbers& numbers, const FlightStart& start) {
  times_ = &window_.times;
  SINEW_TRY(EvaluateValues(numbers, start));
  return trial_cost_;
}

// Most of the way from the flight's state to the window's is the same at a point nearby.
Status WindowFit::Approach(const FreeBodyNumbers& numbers) {
  StateChange change;
  if (known_ != nullptr) change = ChangeAt(ReferenceOf(numbers));
  SINEW_TRY(FitFlight(numbers));
  if (change) {
    const FlightStart moved = start_.Moved(*change);
    const auto with = CostFrom(numbers, moved);
    const auto without = CostFrom(numbers, start_);
    if (with && !(without && *without <= *with)) {
      start_ = moved;
      return Search(numbers, window_.times, kNearly);
    }
  }
  return FitWhole(numbers);
}

// From the solution of the rougher integrator, whose derivatives serve for the short steps that are left.
Status WindowFit::Refine(const FreeBodyNumbers& numbers) {
  times_ = &window_.times;
  SINEW_TRY(EvaluateValues(numbers, start_));
  AcceptValues(start_);
  const StateSteps steps(jacobian_, kFirstDamping);
  for (int iteration = 0; iteration < kMaxRefinements; ++iteration) {
    const StartLanes gradient = jacobian_.transpose() * residual_;
    Vector step = steps.From(gradient);
    Clamp(data_.body.size, step);
    const double predicted = -gradient.dot(step) - 0.5 * (jacobian_ * step).squaredNorm();
    if (!(predicted > kEnough * cost_) || cost_ <= Nothing()) return {};
    const FlightStart next = start_.Moved(step);
    if (!EvaluateValues(numbers, next) || !(trial_cost_ < cost_)) {
      if (predicted < kCostNoiseLevel * cost_) return {};
      break;
    }
    AcceptValues(next);
  }
  return Search(numbers, window_.times, kEnough);
}

// Levenberg, Marquardt, from start_. Trial points are evaluated with derivatives, since most are accepted;
// but where one was refused, at a kink of contact, more are.
Status WindowFit::Search(const FreeBodyNumbers& numbers, const std::vector<double>& times, double enough) {
  times_ = &times;
  SINEW_TRY(Evaluate(numbers, start_));
  Accept(start_);
  double damping = kFirstDamping;
  bool refused = false;  // a step from this point
  for (int iteration = 0; iteration < kMaxIterations && damping <= kMaxDamping && cost_ > Nothing();
       ++iteration) {
    const StartLanes gradient = jacobian_.transpose() * residual_;
    Vector step = StateSteps(jacobian_, damping).From(gradient);
    Clamp(data_.body.size, step);
    const double predicted = -gradient.dot(step) - 0.5 * (jacobian_ * step).squaredNorm();
    if (!(predicted > enough * cost_)) break;
    const FlightStart next = start_.Moved(step);
    const Status status = refused ? EvaluateValues(numbers, next) : Evaluate(numbers, next);
    const bool better = status && trial_cost_ < cost_ && (!refused || Evaluate(numbers, next));
    if (!better) {
      if (predicted < kCostNoiseLevel * cost_) break;
      damping = std::max(10 * damping, 1e-4);
      refused = true;
      continue;
    }
    refused = false;
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
  if (!jacobian_is_at_start_) {
    times_ = &window_.times;
    SINEW_TRY(Evaluate(numbers, start_));
    Accept(start_);
  }
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
