// The state at the begin of a window, found from the window's own frames: it is fitted anew for every set of
// parameters, so that the search has only what the states cannot explain (variable projection, Golub,
// Pereyra 1973, with the derivative of Kaufman 1975).
//
// That makes multiple shooting cheap: the windows of a toss need no parameters of their own, and bounces,
// after which small differences grow without limit, stay identifiable.
#pragma once

#include <array>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "base/digest.h"
#include "base/error.h"
#include "problems/free_body/data.h"

namespace sinew {

/// Values of all slots, and which of them are wanted to change.
struct FreeBodyNumbers {
  std::array<double, kFreeBodySlots> value{};
  [[nodiscard]] std::array<bool, kFreeBodySlots> Used() const;
};

/// What was found for a window, by the numbers that it belongs to. It follows from its numbers alone, so what
/// is kept changes no answer. May be used from several threads.
template <class T>
class KeptByNumbers {
 public:
  [[nodiscard]] std::optional<T> Find(const Digest::Value& numbers) const {
    const std::lock_guard lock(mutex_);
    const auto found = kept_.find(numbers);
    if (found == kept_.end()) return std::nullopt;
    return found->second;
  }
  void Keep(const Digest::Value& numbers, const T& what) {
    const std::lock_guard lock(mutex_);
    if (kept_.size() >= kMost) kept_.clear();
    kept_.emplace(numbers, what);
  }

 private:
  static constexpr std::size_t kMost = 4096;  // then it begins anew
  mutable std::mutex mutex_;
  std::map<Digest::Value, T> kept_;
};

/// By how much the state that fits a whole window differs from the one that fits its flight before the first
/// touch, where these are found; [kStartLanes] as in FlightStart::Moved.
using StateChange = std::optional<Eigen::Matrix<double, kStartLanes, 1>>;

/// Shared by the fits of one window: several fits of a diagnosis begin at the same point.
struct FittedStates {
  KeptByNumbers<FlightStart> starts;
  KeptByNumbers<StateChange> changes;  ///< of reference points
};

/// Fits and predicts one window; one per window and thread, allocates nothing once made.
class WindowFit {
 public:
  /// @param known of the same window; may be null
  WindowFit(const FreeBodyData& data, const TossWindow& window, FittedStates* known = nullptr);

  /// Errors: no prediction from the guess.
  Status Fit(const FreeBodyNumbers& numbers);

  /// @pre Fit succeeded. Poses [frames] at the fitted state.
  [[nodiscard]] const std::vector<Pose>& poses() const { return poses_; }
  [[nodiscard]] const FlightStart& start() const { return start_; }
  /// Half the sum of squared weighted residuals.
  [[nodiscard]] double cost() const { return cost_; }

  /// Derivatives of the poses for one slot each, less what the state takes up; into `derivatives` [7 frames x
  /// slots], pose by pose. Errors: the model's own.
  Status Differentiate(const FreeBodyNumbers& numbers, const std::vector<int>& slots, Matrix& derivatives);

 private:
  Status Approach(const FreeBodyNumbers& numbers);
  Status FitFlight(const FreeBodyNumbers& numbers);
  Status FitWhole(const FreeBodyNumbers& numbers);
  Status Refine(const FreeBodyNumbers& numbers);
  StateChange ChangeAt(const FreeBodyNumbers& reference);
  Result<double> CostFrom(const FreeBodyNumbers& numbers, const FlightStart& start);
  Status Search(const FreeBodyNumbers& numbers, const std::vector<double>& times, double enough);
  Status Evaluate(const FreeBodyNumbers& numbers, const FlightStart& start);
  Status EvaluateValues(const FreeBodyNumbers& numbers, const FlightStart& start);
  Status Weigh();
  void Accept(const FlightStart& start);
  void AcceptValues(const FlightStart& start);
  [[nodiscard]] double Nothing() const;
  void FactoriseStates();
  template <class T>
  Status Pass(const FreeBodyNumbers& numbers, const std::vector<int>& slots, std::size_t first,
              std::size_t count, std::vector<std::array<T, kPoseChannels>>& flown, Matrix& derivatives);

  const FreeBodyData& data_;
  const TossWindow& window_;
  FittedStates* known_;
  std::optional<Digest::Value> fitted_;  // the numbers that all below belongs to
  std::vector<double> flight_;           // times of the frames before the first touch; empty if too few
  std::vector<double> half_;             // and of half of the others too
  const std::vector<double>* times_ = nullptr;  // of the frames that are compared now
  FlightLimits limits_;
  FlightStart start_;
  double cost_ = 0;
  std::vector<Pose> poses_;
  Vector weight_;    // [7 frames]
  Vector residual_;  // [7 frames] weighted, at start_
  Matrix jacobian_;  // [7 frames x kStartLanes] weighted, at start_ or near it
  bool jacobian_is_at_start_ = false;
  double trial_cost_ = 0;
  std::vector<Pose> trial_poses_;
  Vector trial_residual_;
  Matrix trial_jacobian_;
  Matrix basis_;  // orthonormal, of the columns of jacobian_
  std::vector<std::array<Dual<12>, kPoseChannels>> flown12_;
  std::vector<std::array<Dual<4>, kPoseChannels>> flown4_;
  std::vector<std::array<Dual<8>, kPoseChannels>> flown8_;
  std::vector<std::array<Dual<16>, kPoseChannels>> flown16_;
};

}  // namespace sinew
