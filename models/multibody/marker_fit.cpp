#include "models/multibody/marker_fit.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/decompositions.h"

namespace sinew {
namespace {

// A column this small [m per rad, or 1] against the weighted markers is rounding: the coordinate moves none.
constexpr double kMovesNothing = 1e-10;

double Limited(const OsimCoordinate& coordinate, double value) {
  return coordinate.clamped ? std::clamp(value, coordinate.lower, coordinate.upper) : value;
}

// (H + damping diag(H)) step = -gradient over the unblocked coordinates; zero for the others. A coordinate
// that moves nothing has a zero row, and the floor keeps it where it is.
Vector DampedStep(const Matrix& hessian, const Vector& gradient, const std::vector<bool>& blocked,
                  double damping) {
  constexpr double kFloor = 1e-12;  // far below the curvature of any coordinate that moves a marker
  Matrix system = hessian;
  Vector right = -gradient;
  const double floor = kFloor * std::max(hessian.diagonal().maxCoeff(), kFloor);
  for (Eigen::Index i = 0; i < system.rows(); ++i) {
    if (blocked[static_cast<std::size_t>(i)]) {
      system.row(i).setZero();
      system.col(i).setZero();
      system(i, i) = 1;
      right[i] = 0;
    } else {
      system(i, i) += damping * hessian(i, i) + floor;
    }
  }
  return system.ldlt().solve(right);
}

}  // namespace

MarkerFit::MarkerFit(const MultibodyModel& model, std::vector<TrackedMarker> markers,
                     std::vector<CoordinateGoal> goals)
    : model_(model), state_(model.simbody()), markers_(std::move(markers)), goals_(std::move(goals)) {
  for (int i = 0; i < static_cast<int>(model.coordinate_names().size()); ++i) {
    if (!model.coordinate(i).locked && !model.IsDependent(i)) free_.push_back(i);
  }
}

bool MarkerFit::SetFrame(const std::vector<Vec3>& observed) {
  seen_.clear();
  observed_.clear();
  root_weights_.clear();
  double total = 0;
  for (const TrackedMarker& marker : markers_) {
    const Vec3& position = observed[marker.in_data];
    if (!position.allFinite()) continue;
    seen_.push_back(marker.in_model);
    observed_.push_back(position);
    root_weights_.push_back(std::sqrt(marker.weight));
    total += marker.weight;
  }
  for (double& root : root_weights_) root /= std::sqrt(total);
  return !seen_.empty();
}

double MarkerFit::PresentWeight(const std::vector<Vec3>& observed) const {
  double total = 0;
  for (const TrackedMarker& marker : markers_)
    total += observed[marker.in_data].allFinite() ? marker.weight : 0;
  return total;
}

void MarkerFit::Place(const Vector& values) {
  Vector coupled = values;
  ApplyCouplers(model_.simbody(), coupled);
  state_.SetValues(coupled);
}

Vector MarkerFit::Residuals(const Vector& values) {
  Place(values);
  Vector residuals(static_cast<Eigen::Index>(3 * seen_.size() + goals_.size()));
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < seen_.size(); ++i, row += 3)
    residuals.segment<3>(row) = root_weights_[i] * (state_.MarkerPosition(seen_[i]) - observed_[i]);
  for (const CoordinateGoal& goal : goals_)
    residuals[row++] = std::sqrt(goal.weight) * (values[goal.coordinate] - goal.target);
  return residuals;
}

MarkerFit::Linearization MarkerFit::Linearize(const Vector& values) {
  Linearization at;
  at.residuals = Residuals(values);
  const auto marker_rows = static_cast<Eigen::Index>(3 * seen_.size());
  Matrix all = Matrix::Zero(at.residuals.size(), values.size());
  all.topRows(marker_rows) = state_.MarkerJacobian(seen_);
  for (std::size_t i = 0; i < seen_.size(); ++i)
    all.middleRows<3>(static_cast<Eigen::Index>(3 * i)) *= root_weights_[i];
  for (std::size_t i = 0; i < goals_.size(); ++i)
    all(marker_rows + static_cast<Eigen::Index>(i), goals_[i].coordinate) = std::sqrt(goals_[i].weight);

  // Chain rule through the couplers, the last dependent coordinate first.
  const auto& couplers = model_.simbody().couplers;
  Vector coupled = values;
  ApplyCouplers(model_.simbody(), coupled);
  for (auto coupler = couplers.rbegin(); coupler != couplers.rend(); ++coupler) {
    const double slope = coupler->function.At(coupled[coupler->independent]).first;
    all.col(coupler->independent) += slope * all.col(coupler->dependent);
  }
  at.jacobian.resize(all.rows(), static_cast<Eigen::Index>(free_.size()));
  for (std::size_t i = 0; i < free_.size(); ++i) {
    at.jacobian.col(static_cast<Eigen::Index>(i)) = all.col(free_[i]);
  }
  return at;
}

Vector MarkerFit::WithStep(const Vector& values, const Vector& step) const {
  Vector moved = values;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    double& value = moved[free_[i]];
    value = Limited(model_.coordinate(free_[i]), value + step[static_cast<Eigen::Index>(i)]);
  }
  return moved;
}

// Coordinates at an end of their range that the gradient would push beyond it.
std::vector<bool> MarkerFit::Blocked(const Vector& values, const Vector& gradient) const {
  std::vector<bool> blocked(free_.size(), false);
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const OsimCoordinate& coordinate = model_.coordinate(free_[i]);
    if (!coordinate.clamped) continue;
    const double slope = gradient[static_cast<Eigen::Index>(i)];
    const double value = values[free_[i]];
    blocked[i] = (value <= coordinate.lower && slope > 0) || (value >= coordinate.upper && slope < 0);
  }
  return blocked;
}

// Angles without a range are compared up to whole turns.
bool MarkerFit::IsNear(const Vector& values, const Vector& other, double radius) const {
  return std::all_of(free_.begin(), free_.end(), [&](int i) {
    const OsimCoordinate& coordinate = model_.coordinate(i);
    const bool turns = coordinate.motion == MotionType::kRotational && !coordinate.clamped;
    const double difference = values[i] - other[i];
    return std::abs(turns ? std::remainder(difference, 2 * kPi) : difference) <= radius;
  });
}

int MarkerFit::Joined(const Vector& values, const Search& search) const {
  if (search.known == nullptr) return -1;
  const auto found = std::find_if(search.known->begin(), search.known->end(), [&](const Vector& minimum) {
    return IsNear(values, minimum, search.radius);
  });
  return found == search.known->end() ? -1 : static_cast<int>(found - search.known->begin());
}

std::vector<bool> MarkerFit::Determined(const std::vector<Vector>& poses) {
  std::vector<bool> determined(free_.size(), false);
  for (const Vector& pose : poses) {
    const Matrix jacobian = Linearize(pose).jacobian;
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (jacobian.col(static_cast<Eigen::Index>(i)).norm() > kMovesNothing) determined[i] = true;
  }
  return determined;
}

MarkerFit::Solution MarkerFit::Solve(const Vector& start, const Search& search) {
  constexpr double kSmallestDamping = 1e-12;
  constexpr double kFirstDamping = 1e-4;  // when the plain step fails
  Solution solution;
  solution.values = WithStep(start, Vector::Zero(static_cast<Eigen::Index>(free_.size())));
  solution.joined = Joined(solution.values, search);
  if (solution.joined >= 0) return solution;
  Linearization at = Linearize(solution.values);
  solution.cost = at.residuals.squaredNorm();
  double damping = 0;
  for (int iteration = 0; iteration < search.max_iterations; ++iteration) {
    const Matrix hessian = Gram(at.jacobian);
    const Vector gradient = at.jacobian.transpose() * at.residuals;
    const Vector step = DampedStep(hessian, gradient, Blocked(solution.values, gradient), damping);
    const Vector trial = WithStep(solution.values, step);
    const bool is_small = (trial - solution.values).cwiseAbs().maxCoeff() <= search.accuracy;
    const double cost = Residuals(trial).squaredNorm();
    if (cost <= solution.cost) {
      solution.values = trial;
      solution.cost = cost;
      damping = damping < kSmallestDamping ? 0 : damping / 10;
      solution.joined = Joined(solution.values, search);
      if (solution.joined >= 0) break;
      if (!is_small) at = Linearize(solution.values);
    } else {
      damping = std::max(10 * damping, kFirstDamping);
    }
    // A small step that fails is within rounding.
    if (is_small) {
      solution.converged = true;
      break;
    }
  }
  ApplyCouplers(model_.simbody(), solution.values);
  return solution;
}

std::vector<double> MarkerFit::Distances(const Vector& values) {
  Place(values);
  std::vector<double> distances;
  for (std::size_t i = 0; i < seen_.size(); ++i)
    distances.push_back((state_.MarkerPosition(seen_[i]) - observed_[i]).norm());
  return distances;
}

}  // namespace sinew
