#include "problems/contact/motion/motion_priors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

// Of feet without markers (Leardini et al. 2005, Gait & Posture 21:212; Jackson et al. 2016, J. Biomech. Eng.
// 138: 3 to 6 mm, 0.5 to 2 degrees).
constexpr double kPosition = 0.005;
constexpr double kRotation = 0.035;
constexpr double kJoint = 0.1;  // [rad] few markers, if any, are beyond the joint

// Highest frequency of what stances have in common over that of what they do not: a mean is smoother.
constexpr double kCommonCutoff = 0.6;

// Root mean squares over the stances, where they have markers.
MarkerAccuracy PooledAccuracy(const std::vector<Stance>& stances) {
  MarkerAccuracy pooled;
  double with_markers = 0;
  for (const Stance& stance : stances) {
    if (!stance.measured) continue;
    const MarkerAccuracy one = AccuracyOf(stance.markers, stance.foot);
    if (!(one.position > 0)) continue;
    with_markers += 1;
    pooled.markers = std::max(pooled.markers, one.markers);
    pooled.residual += one.residual * one.residual;
    pooled.position += one.position * one.position;
    pooled.rotation += one.rotation * one.rotation;
  }
  if (with_markers == 0) return {};
  for (double* squares : {&pooled.residual, &pooled.position, &pooled.rotation})
    *squares = std::sqrt(*squares / with_markers);
  return pooled;
}

Eigen::Matrix<double, kPoseComponents, 1> Along(int component) {
  Eigen::Matrix<double, kPoseComponents, 1> direction = Eigen::Matrix<double, kPoseComponents, 1>::Zero();
  direction[component] = 1;
  return direction;
}

// A velocity moves nothing at the instant.
std::shared_ptr<const CurveBasis> FloorBasis(std::size_t instants) {
  const auto rows = static_cast<Eigen::Index>(instants);
  return std::make_shared<const CurveBasis>(CurveBasis{Matrix::Zero(rows, 1), Matrix::Ones(rows, 1)});
}

}  // namespace

void AddMotionErrors(const MotionErrorSettings& settings, const std::array<double, 2>& floor_error,
                     std::vector<Stance>& stances, int& next_parameter, std::vector<std::string>& notes) {
  const MarkerAccuracy markers = PooledAccuracy(stances);
  // Markers that a rigid foot follows exactly say nothing of how the foot bends, or moves in its shoe.
  const double position = settings.position.value_or(std::max(markers.position, kPosition));
  const double rotation = settings.rotation.value_or(std::max(markers.rotation, kRotation));
  const double joint = settings.joint.value_or(kJoint);
  const bool has_joint =
      std::any_of(stances.begin(), stances.end(), [](const Stance& stance) { return stance.foot.has_joint; });
  // Steps without a plate leave the fit of the others as it is.
  const auto measured =
      std::count_if(stances.begin(), stances.end(), [](const Stance& stance) { return stance.measured; });
  double duration = 0;
  for (const Stance& stance : stances) {
    if (stance.measured) duration += (stance.loaded[1] - stance.loaded[0]) / static_cast<double>(measured);
  }

  const auto stated = [&](int component) {
    return component <= kShiftZ ? position : component <= kTurnZ ? rotation : joint;
  };
  const int spectrum = next_parameter;
  next_parameter += kSpectrumParameters;
  std::vector<int> components;
  for (int c = 0; c < (has_joint ? kPoseComponents : kJointAngle); ++c) components.push_back(c);
  for (Stance& stance : stances) {
    StanceMotionErrors& errors = stance.motion_errors;
    errors.components = components;
    const auto directions = FootDirections(stance.forward, stance.side);
    std::vector<double> phase_time;  // phase times the mean duration
    const double stretch = duration / (stance.loaded[1] - stance.loaded[0]);
    for (const double t : stance.time) phase_time.push_back((t - stance.loaded[0]) * stretch);
    errors.spectrum = spectrum;
    errors.common_curves = std::make_shared<const DeviationCurves>(phase_time, 0, duration,
                                                                   kCommonCutoff * settings.cutoff, stretch);
    errors.own_curves = std::make_shared<const DeviationCurves>(stance.time, stance.recorded[0],
                                                                stance.recorded[1], settings.cutoff);
    errors.floor = FloorBasis(stance.time.size());
    errors.noise_time = stance.pose_noise.time;
    for (const int component : components) {
      const double of = stance.pose_noise.deviation[static_cast<std::size_t>(component)];
      errors.noise += std::pow(of / stated(component), 2) / static_cast<double>(components.size());
    }
    int first = next_parameter;
    const auto add = [&](PoseTerm term) {
      term.first = first;
      first += term.weights;
      errors.terms.push_back(std::move(term));
    };
    for (const int component : components) {
      const auto c = static_cast<std::size_t>(component);
      errors.deviation[c] = stated(component);
      add({errors.deviation[c] * directions[c], static_cast<PoseComponent>(component), DeviationOf::kAll, -1,
           errors.common_curves->weights()});
    }
    for (const PoseComponent along : {kShiftX, kShiftZ}) {
      if (floor_error[along == kShiftX ? 0 : 1] > 0)
        add({-Along(along), along, DeviationOf::kFloor, -1, 1});  // the foot's, relative to the floor
    }
    errors.own = static_cast<int>(errors.terms.size());
    for (const int component : components) {
      const auto c = static_cast<std::size_t>(component);
      add({errors.deviation[c] * Along(component), static_cast<PoseComponent>(component),
           DeviationOf::kStance, -1, errors.own_curves->weights()});
    }
  }
  // What is of all stances once, then the own ones of each stance and the places of its markers.
  for (int i = 0; i < stances.front().motion_errors.own; ++i)
    next_parameter += stances.front().motion_errors.terms[static_cast<std::size_t>(i)].weights;
  for (Stance& stance : stances) {
    StanceMotionErrors& errors = stance.motion_errors;
    for (std::size_t i = static_cast<std::size_t>(errors.own); i < errors.terms.size(); ++i) {
      errors.terms[i].first = next_parameter;
      next_parameter += errors.terms[i].weights;
    }
  }
  notes.push_back(fmt::format(
      "the pose of a foot may deviate from the recorded one by {:.1f} mm and {:.1f} degrees (standard "
      "deviations of the prior, {}){}",
      1e3 * position, rotation * 180 / kPi,
      settings.position && settings.rotation ? std::string("as set")
      : markers.markers == 0                 ? std::string("published ones: no marker is on it")
      : markers.position > kPosition ? fmt::format("from the residuals of {} markers on it, {:.1f} mm",
                                                   markers.markers, 1e3 * markers.residual)
                                     : fmt::format("published ones: {} markers on it leave {:.1f} mm",
                                                   markers.markers, 1e3 * markers.residual),
      settings.between_steps ? fmt::format(", of which {:.0f} % of the variance differs from step to step",
                                           100 / (1 + std::pow(*settings.between_steps, -2)))
                             : std::string()));
}

}  // namespace sinew
