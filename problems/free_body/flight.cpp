#include "problems/free_body/flight.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// Dormand, Prince 1980, table 2; the last stage is the first of the next step.
constexpr double kStage[6][6] = {{1.0 / 5},
                                 {3.0 / 40, 9.0 / 40},
                                 {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                 {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                 {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                 {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr double kError[7] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                              -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
constexpr double kStable = 2.5;         // step times rate; the method is stable on the real axis up to 3.3
constexpr double kFirstStep = 1e-3;     // [s]
constexpr double kGrowth = 2;           // of a step over the one before: after a kink more are refused
constexpr double kShortestStep = 1e-9;  // [s]

template <class T, class P>
class Flight {
 public:
  static constexpr int L = kLanesOf<T>;

  Flight(const FreeBody& body, const std::array<P, kFreeBodySlots>& variables,
         const std::array<bool, kFreeBodySlots>& used, const FlightLimits& limits)
      : dynamics_(body, variables, used), p_(variables), used_(used), limits_(limits) {
    time_scale_ = 1.0 + p_[kClockShare];
    length_scale_ = 1.0 + p_[kLengthShare];
    turn_ = SmallTurn(Triple<P>{p_[kFrameTurnX], p_[kFrameTurnY], p_[kFrameTurnZ]});
    for (int i = 0; i < 3; ++i) point_[i] = p_[kFramePointX + i] - p_[kMassCentreX + i];
    scale_.fill(1);
    for (int i = 0; i < 3; ++i) scale_[kPlace + i] = body.size;
    for (int i = 0; i < 3; ++i) scale_[kSpin + i] = 1 / body.size;
  }

  void Begin(const FlightStart& start, int lane) {
    std::array<T, kStartLanes> by;
    for (int i = 0; i < kStartLanes; ++i) by[i] = T(0);
    if constexpr (!std::is_same_v<T, double>) {
      if (lane >= 0) {
        for (int i = 0; i < kStartLanes; ++i) by[i].d[static_cast<std::size_t>(lane + i)] = 1;
      }
    }
    std::array<T, 4> q;
    for (int i = 0; i < 4; ++i) q[i] = T(start.pose[3 + static_cast<std::size_t>(i)]);
    const auto own = SmallTurn(Triple<T>{by[3], by[4], by[5]});
    const auto recorded = Product(q.data(), own.data());
    const std::array<P, 4> back{turn_[0], -turn_[1], -turn_[2], -turn_[3]};
    const auto truth = Product(recorded.data(), back.data());
    BodyState<T> state;
    std::copy(truth.begin(), truth.end(), state.begin() + kQuaternion);
    const Triple<T> point = Times(RotationOf(truth.data()), point_);
    for (int i = 0; i < 3; ++i) {
      state[kPlace + i] = (start.pose[static_cast<std::size_t>(i)] + by[i]) / length_scale_ - point[i];
      state[kVelocity + i] = start.velocity[i] + by[6 + i];
      state[kSpin + i] = start.spin[i] + by[9 + i];
    }
    for (std::size_t i = 0; i < state.size(); ++i) {
      state_.value[i] = Value(state[i]);
      if constexpr (L > 0) state_.slope[i] = Eigen::Map<const Lanes<L>>(state[i].d.data());
    }
    Rate(state_, rates_[0], &fastest_);
    if (!used_[kPoseLowPass]) return;
    // The camera is on before the window begins: smoothing starts with the lag of the first motion.
    true_pose_ = TruePose();
    pose_rate_ = PoseRate();
    for (int i = 0; i < kPoseChannels; ++i) smoothed_[i] = true_pose_[i] - p_[kPoseLowPass] * pose_rate_[i];
  }

  Status To(double from, double to) {
    double now = from;
    const double longest = to - from;
    while (now < to) {
      // A rest that is hardly a step of its own is taken along.
      double step = std::min({next_step_, longest, kStable / std::max(fastest_, 1e-300)});
      if (now + 1.0001 * step >= to) step = to - now;
      if (++steps_ > limits_.most_steps)
        return Fail("more than {} steps of the integrator at t = {:.4g} s", limits_.most_steps, now);
      const double error = Try(step) / limits_.accuracy;
      if (!std::isfinite(error)) {
        next_step_ = 0.1 * step;
      } else {
        next_step_ = step * std::clamp(0.9 * std::pow(std::max(error, 1e-10), -0.2), 0.2, kGrowth);
      }
      if (!(error <= 1)) {
        if (next_step_ < kShortestStep)
          return Fail("the state is not finite, or changes too fast, at t = {:.4g} s", now);
        continue;
      }
      now = step == to - now ? to : now + step;
      state_ = trial_;
      std::swap(rates_[0], rates_[6]);
      fastest_ = next_fastest_;
      if (used_[kPoseLowPass]) Smooth(step);
    }
    return {};
  }

  [[nodiscard]] std::array<T, kPoseChannels> Recorded() const {
    return used_[kPoseLowPass] ? smoothed_ : TruePose();
  }

 private:
  void Rate(const Motion<L>& state, Motion<L>& rate, double* fastest = nullptr) const {
    dynamics_.Derivative(state, rate, fastest);
    if (!used_[kClockShare]) return;
    for (std::size_t i = 0; i < rate.value.size(); ++i) {
      if constexpr (L > 0) {
        rate.slope[i] *= Value(time_scale_);
        if constexpr (!std::is_same_v<P, double>)
          rate.slope[i] += rate.value[i] * Eigen::Map<const Lanes<L>>(time_scale_.d.data());
      }
      rate.value[i] *= Value(time_scale_);
    }
  }

  // The state at a stage, into trial_.
  template <std::size_t kIndex>
  void Advance(double step) {
    for (std::size_t i = 0; i < 13; ++i) {
      double& x = trial_.value[i];
      x = state_.value[i];
      for (std::size_t k = 0; k <= kIndex; ++k) {
        if (kStage[kIndex][k] != 0) x += (step * kStage[kIndex][k]) * rates_[k].value[i];
      }
    }
    if constexpr (L > 0) {
      // One expression each, so that a lane is read and written once.
      constexpr auto& a = kStage[kIndex];
      for (std::size_t i = 0; i < 13; ++i) {
        const auto r = [&](std::size_t k) { return (step * a[k]) * rates_[k].slope[i]; };
        if constexpr (kIndex == 0) trial_.slope[i] = state_.slope[i] + r(0);
        if constexpr (kIndex == 1) trial_.slope[i] = state_.slope[i] + r(0) + r(1);
        if constexpr (kIndex == 2) trial_.slope[i] = state_.slope[i] + r(0) + r(1) + r(2);
        if constexpr (kIndex == 3) trial_.slope[i] = state_.slope[i] + r(0) + r(1) + r(2) + r(3);
        if constexpr (kIndex == 4) trial_.slope[i] = state_.slope[i] + r(0) + r(1) + r(2) + r(3) + r(4);
        if constexpr (kIndex == 5) trial_.slope[i] = state_.slope[i] + r(0) + r(2) + r(3) + r(4) + r(5);
      }
    }
    Rate(trial_, rates_[kIndex + 1], kIndex == 5 ? &next_fastest_ : nullptr);
  }

  // Error of the step as a share of the scales.
  double Try(double step) {
    Advance<0>(step);
    Advance<1>(step);
    Advance<2>(step);
    Advance<3>(step);
    Advance<4>(step);
    Advance<5>(step);
    double largest = 0;
    for (std::size_t i = 0; i < 13; ++i) {
      double error = 0;
      for (std::size_t k = 0; k < 7; ++k) error += kError[k] * rates_[k].value[i];
      const double share = std::abs(step * error) / scale_[i];
      if (!std::isfinite(share)) return share;
      largest = std::max(largest, share);
    }
    return largest;
  }

  // With its derivatives as a dual number.
  static BodyState<T> Full(const Motion<L>& motion) {
    if constexpr (L == 0) {
      return motion.value;
    } else {
      BodyState<T> full;
      for (std::size_t i = 0; i < full.size(); ++i) {
        full[i].value = motion.value[i];
        Eigen::Map<Lanes<L>>(full[i].d.data()) = motion.slope[i];
      }
      return full;
    }
  }

  [[nodiscard]] std::array<T, kPoseChannels> TruePose() const {
    std::array<T, kPoseChannels> pose;
    const BodyState<T> state = Full(state_);
    const Triple<T> point = Times(RotationOf(&state[kQuaternion]), point_);
    for (int i = 0; i < 3; ++i) pose[i] = length_scale_ * (state[kPlace + i] + point[i]);
    const auto q = Product(&state[kQuaternion], turn_.data());
    std::copy(q.begin(), q.end(), pose.begin() + 3);
    return pose;
  }

  [[nodiscard]] std::array<T, kPoseChannels> PoseRate() const {
    std::array<T, kPoseChannels> rate;
    const BodyState<T> state = Full(state_);
    const BodyState<T> change = Full(rates_[0]);
    const auto rotation = RotationOf(&state[kQuaternion]);
    const Triple<T> spin = Times(rotation, Triple<T>{state[kSpin], state[kSpin + 1], state[kSpin + 2]});
    const Triple<T> turning = Cross(spin, Times(rotation, point_));
    for (int i = 0; i < 3; ++i) rate[i] = length_scale_ * (change[kPlace + i] + time_scale_ * turning[i]);
    const auto q = Product(&change[kQuaternion], turn_.data());
    std::copy(q.begin(), q.end(), rate.begin() + 3);
    return rate;
  }

  // First-order low-pass of the cubic x through poses and rates at both ends of the step, exactly: with lag
  // c, x - c dx + c^2 ddx - c^3 dddx solves dy = (x - y) / c, and what differs from it at the begin fades.
  void Smooth(double step) {
    const auto pose = TruePose();
    const auto rate = PoseRate();
    const P& lag = p_[kPoseLowPass];
    const P fading = Value(lag) > 0 ? Exp(-step / lag) : P(0);
    const double h = 1 / step;
    for (int i = 0; i < kPoseChannels; ++i) {
      const T way = (pose[i] - true_pose_[i]) * h;
      const T third = (6 * h * h) * (pose_rate_[i] + rate[i] - 2.0 * way);
      const T second = (2 * h) * (3.0 * way - 2.0 * pose_rate_[i] - rate[i]);  // at the begin
      const T begins = true_pose_[i] - lag * (pose_rate_[i] - lag * (second - lag * third));
      const T ends = pose[i] - lag * (rate[i] - lag * (second + step * third - lag * third));
      smoothed_[i] = ends + (smoothed_[i] - begins) * fading;
    }
    true_pose_ = pose;
    pose_rate_ = rate;
  }

  FreeBodyDynamics<L, P> dynamics_;
  const std::array<P, kFreeBodySlots>& p_;
  const std::array<bool, kFreeBodySlots>& used_;
  const FlightLimits& limits_;
  P time_scale_;
  P length_scale_;
  std::array<P, 4> turn_;
  Triple<P> point_;
  std::array<double, 13> scale_;
  Motion<L> state_;
  Motion<L> trial_;
  std::array<Motion<L>, 7> rates_;
  std::array<T, kPoseChannels> true_pose_;
  std::array<T, kPoseChannels> pose_rate_;
  std::array<T, kPoseChannels> smoothed_;
  double fastest_ = 0;       // rate of contact at state_ [1/s]
  double next_fastest_ = 0;  // and at trial_
  double next_step_ = kFirstStep;
  long steps_ = 0;
};

}  // namespace

FlightStart FlightStart::Moved(const Eigen::Ref<const Vector>& by) const {
  FlightStart moved = *this;
  const std::array<double, 4> own = SmallTurn(Triple<double>{by[3], by[4], by[5]});
  const auto q = Product(pose.data() + 3, own.data());
  for (std::size_t i = 0; i < 3; ++i) moved.pose[i] += by[static_cast<Eigen::Index>(i)];
  for (std::size_t i = 0; i < 4; ++i) moved.pose[3 + i] = q[i];
  moved.velocity += by.segment<3>(6);
  moved.spin += by.segment<3>(9);
  return moved;
}

Eigen::Matrix<double, kStartLanes, 1> FlightStart::MoveTo(const FlightStart& other) const {
  const std::array<double, 4> back{pose[3], -pose[4], -pose[5], -pose[6]};
  const auto q = Product(back.data(), other.pose.data() + 3);
  Eigen::Matrix<double, kStartLanes, 1> by;
  for (std::size_t i = 0; i < 3; ++i) {
    by[static_cast<Eigen::Index>(i)] = other.pose[i] - pose[i];
    by[static_cast<Eigen::Index>(3 + i)] = 2 * q[1 + i] / q[0];
  }
  by.segment<3>(6) = other.velocity - velocity;
  by.segment<3>(9) = other.spin - spin;
  return by;
}

template <class T, class P>
Status Fly(const FreeBody& body, const std::array<P, kFreeBodySlots>& variables,
           const std::array<bool, kFreeBodySlots>& used, const FlightStart& start, int start_lane,
           const std::vector<double>& times, const FlightLimits& limits,
           std::array<T, kPoseChannels>* poses) {
  Flight<T, P> flight(body, variables, used, limits);
  flight.Begin(start, start_lane);
  poses[0] = flight.Recorded();
  for (std::size_t i = 1; i < times.size(); ++i) {
    SINEW_TRY(flight.To(times[i - 1], times[i]));
    poses[i] = flight.Recorded();
  }
  return {};
}

#define SINEW_FLY(T, P)                                                                       \
  template Status Fly<T, P>(const FreeBody&, const std::array<P, kFreeBodySlots>&,            \
                            const std::array<bool, kFreeBodySlots>&, const FlightStart&, int, \
                            const std::vector<double>&, const FlightLimits&, std::array<T, kPoseChannels>*)
SINEW_FLY(double, double);
SINEW_FLY(Dual<4>, Dual<4>);
SINEW_FLY(Dual<8>, Dual<8>);
SINEW_FLY(Dual<12>, double);
SINEW_FLY(Dual<16>, Dual<16>);
#undef SINEW_FLY

}  // namespace sinew
