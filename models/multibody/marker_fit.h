// The least-squares problem of one frame of inverse kinematics, and its solver. Internal to models/.
#pragma once

#include <vector>

#include "models/multibody/kinematic_state.h"
#include "models/multibody/multibody_model.h"

namespace sinew {

/// A marker that is tracked.
struct TrackedMarker {
  std::size_t in_model = 0;
  std::size_t in_data = 0;
  double weight = 1;  ///< > 0
};

/// A coordinate that is drawn to a value.
struct CoordinateGoal {
  int coordinate = 0;
  double target = 0;
  double weight = 0;
};

/// Weighted distance between a model's markers and those of one frame.
class MarkerFit {
 public:
  struct Solution {
    Vector values;  ///< all coordinates
    double cost = 0;
    bool converged = false;
    int joined = -1;  ///< index of the known minimum that stopped the search; -1: none did
  };
  struct Search {
    double accuracy = 1e-9;  ///< stops when no coordinate would move by more than this [rad or m]
    int max_iterations = 200;
    /// Minima that need not be found again: within `radius` [rad or m] of one the search stops.
    const std::vector<Vector>* known = nullptr;
    double radius = 1e-2;
  };

  MarkerFit(const MultibodyModel& model, std::vector<TrackedMarker> markers,
            std::vector<CoordinateGoal> goals);

  /// @param observed  [markers of the data, m], NaN where missing.
  /// @return whether any tracked marker is present.
  bool SetFrame(const std::vector<Vec3>& observed);

  /// Sum of the weights of the tracked markers that are present in a frame.
  [[nodiscard]] double PresentWeight(const std::vector<Vec3>& observed) const;

  /// Minimises from `start` (all coordinates).
  Solution Solve(const Vector& start, const Search& search);

  /// Per free coordinate: whether it moves a marker of this frame at one of `poses`, or has a goal.
  std::vector<bool> Determined(const std::vector<Vector>& poses);

  /// Distances [m] of the markers present, unweighted.
  std::vector<double> Distances(const Vector& values);
  /// Those markers, as in the model.
  [[nodiscard]] const std::vector<std::size_t>& present() const { return seen_; }

  /// Coordinates that are neither locked nor dependent by a coupler.
  [[nodiscard]] const std::vector<int>& free_coordinates() const { return free_; }

 private:
  struct Linearization {
    Vector residuals;
    Matrix jacobian;  // [residuals x free]
  };

  void Place(const Vector& values);
  [[nodiscard]] bool IsNear(const Vector& values, const Vector& other, double radius) const;
  [[nodiscard]] int Joined(const Vector& values, const Search& search) const;
  [[nodiscard]] Vector Residuals(const Vector& values);
  [[nodiscard]] Linearization Linearize(const Vector& values);
  [[nodiscard]] Vector WithStep(const Vector& values, const Vector& step) const;
  [[nodiscard]] std::vector<bool> Blocked(const Vector& values, const Vector& gradient) const;

  const MultibodyModel& model_;
  KinematicState state_;
  std::vector<TrackedMarker> markers_;
  std::vector<CoordinateGoal> goals_;
  std::vector<int> free_;

  // Of the present frame.
  std::vector<std::size_t> seen_;  // markers, as in the model
  std::vector<Vec3> observed_;
  std::vector<double> root_weights_;
};

}  // namespace sinew
