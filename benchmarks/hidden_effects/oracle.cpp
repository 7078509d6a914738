#include "benchmarks/hidden_effects/oracle.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// Central differences of a smooth simulation whose rounding error is about 1e-14: any small step will do.
constexpr double kRelativeStep = 1e-4;

// The motion as the fitted model has it: what followed a reference inside it does so again; else the torque
// that was recorded acts.
DriveTrial Replay(const DriveTrial& trial, const Vector& input) {
  DriveTrial replay = trial;
  if (trial.control == DriveControl::kCascade) return replay;
  replay.control = DriveControl::kTorque;
  replay.command.assign(input.data(), input.data() + input.size());
  return replay;
}

}  // namespace

Result<Oracle> Oracle::Make(const DrivePlan& plan) {
  Oracle oracle;
  oracle.plan_ = plan;
  oracle.grows_ = plan.step < kFineStep;
  if (oracle.grows_) oracle.step_ = plan.step;
  oracle.plan_.trials.resize(plan.train);
  oracle.samples_ = static_cast<Eigen::Index>(plan.trials.front().command.size());
  oracle.extents_ = {0, 0, 0};
  for (const DriveTrial& trial : oracle.plan_.trials) {
    SINEW_ASSIGN(const DriveRecord record, SimulateDrive(plan.truth, trial, oracle.step_));
    oracle.replayed_.push_back(Replay(trial, record.input));
    Extents& extents = oracle.extents_;
    extents.position = std::max(extents.position, record.position.cwiseAbs().maxCoeff());
    extents.speed = std::max(extents.speed, record.speed.cwiseAbs().maxCoeff());
    extents.torque = std::max(extents.torque, record.torque.cwiseAbs().maxCoeff());
  }
  SINEW_ASSIGN(oracle.undisturbed_, oracle.Positions(plan.truth, oracle.replayed_));

  const auto train = static_cast<Eigen::Index>(plan.train);
  Matrix columns = Matrix::Zero(train * oracle.samples_, 3 + 2 * train);
  constexpr int base[] = {kInertia, kViscousFriction, kGravityTorque};
  // Where small differences grow, a step that is small elsewhere turns the joint over once more.
  const auto slope = [&](double step, auto&& readings) -> Result<Vector> {
    constexpr double kLinear = 1e-3;  // [rad]
    constexpr int kMaxTries = 12;
    for (int tries = 0;; ++tries) {
      SINEW_ASSIGN(const Vector above, readings(step));
      SINEW_ASSIGN(const Vector below, readings(-step));
      const double largest = (above - below).cwiseAbs().maxCoeff();
      if (!oracle.grows_ || largest <= kLinear || tries == kMaxTries)
        return Vector((above - below) / (2 * step));
      step *= std::clamp(0.3 * kLinear / largest, 1e-3, 0.3);
    }
  };
  for (int c = 0; c < 3; ++c) {
    SINEW_ASSIGN(columns.col(c), slope(kRelativeStep * plan.truth[base[c]], [&](double by) {
                   DriveTruth moved = plan.truth;
                   moved[base[c]] += by;
                   return oracle.Positions(moved, oracle.replayed_);
                 }));
  }
  for (int s = 0; s < 2; ++s) {
    const auto start = s == 0 ? &DriveTrial::initial_position : &DriveTrial::initial_speed;
    for (Eigen::Index i = 0; i < train; ++i) {
      const std::vector<DriveTrial> one{oracle.replayed_[static_cast<std::size_t>(i)]};
      SINEW_ASSIGN(columns.col(3 + 2 * i + s).segment(i * oracle.samples_, oracle.samples_),
                   slope(kRelativeStep, [&](double by) {
                     std::vector<DriveTrial> moved = one;
                     moved.front().*start += by;
                     return oracle.Positions(plan.truth, moved);
                   }));
    }
  }
  oracle.Whiten(columns);
  columns.colwise().normalize();
  const Eigen::HouseholderQR<Matrix> qr(columns);
  oracle.basis_ = qr.householderQ() * Matrix::Identity(columns.rows(), columns.cols());
  return oracle;
}

Result<Matrix> Oracle::Change(const DriveTruth& truth) const {
  const bool closed = plan_.trials.front().control == DriveControl::kTracking;
  const bool other_input = closed || truth[kInputOffset] != 0 || truth[kInputDrift] != 0 ||
                           truth[kInputGain] != 1 || truth[kInputTimeOffset] != 0 ||
                           truth[kInputLowPass] != 0;
  Matrix change(samples_ * static_cast<Eigen::Index>(plan_.train), 1);
  for (std::size_t i = 0; i < plan_.train; ++i) {
    const Eigen::Index at = static_cast<Eigen::Index>(i) * samples_;
    SINEW_ASSIGN(DriveRecord record, SimulateDrive(truth, plan_.trials[i], step_));
    ReadPosition(truth, record.position);
    if (other_input) {  // the base model is driven by what was recorded
      SINEW_ASSIGN(const DriveRecord bare,
                   SimulateDrive(plan_.truth, Replay(plan_.trials[i], record.input), step_));
      change.col(0).segment(at, samples_) = record.position - bare.position;
    } else {
      change.col(0).segment(at, samples_) = record.position - undisturbed_.segment(at, samples_);
    }
  }
  return change;
}

Vector Oracle::Project(Matrix change) const {
  Whiten(change);
  const Vector whitened = change.col(0);
  return whitened - basis_ * (basis_.transpose() * whitened);
}

Result<Vector> Oracle::Signature(const DriveTruth& truth) const {
  SINEW_ASSIGN(Matrix change, Change(truth));
  return Project(std::move(change));
}

Vector Oracle::Noise() const {
  Matrix noise(samples_ * static_cast<Eigen::Index>(plan_.train), 1);
  for (std::size_t i = 0; i < plan_.train; ++i) {
    noise.col(0).segment(static_cast<Eigen::Index>(i) * samples_, samples_) =
        DrawPositionNoise(plan_, i, samples_);
  }
  Whiten(noise);
  const Vector whitened = noise.col(0);
  return whitened - basis_ * (basis_.transpose() * whitened);
}

Result<std::optional<Oracle::Sized>> Oracle::SmallAmplitude(const HiddenEffect& effect, double norm) const {
  constexpr int kMaxSteps = 25;
  constexpr double kLinear = 1e-3;  // [rad]
  double amplitude = std::min(effect.guess, effect.most);
  for (int step = 0; step < kMaxSteps; ++step) {
    DriveTruth truth = plan_.truth;
    effect.apply(amplitude, truth);
    SINEW_ASSIGN(const Matrix change, Change(truth));
    const double largest = change.cwiseAbs().maxCoeff();
    const double share = largest / kLinear;
    const bool most = amplitude >= effect.most;
    if (share <= 1 && (share > 0.1 || most)) {
      Vector signature = Project(change);
      const double factor = norm / std::max(signature.norm(), 1e-12);
      if (amplitude * factor > effect.most) return std::optional<Sized>();
      return std::optional<Sized>(Sized{amplitude * factor, signature * factor, factor});
    }
    if (most && share < 1) break;
    amplitude = std::min(amplitude * std::clamp(0.5 / std::max(share, 1e-9), 0.02, 8.0), effect.most);
  }
  return std::optional<Sized>();
}

Result<std::optional<Oracle::Sized>> Oracle::Amplitude(const HiddenEffect& effect, double norm) const {
  double guess = effect.guess;
  if (grows_) {
    SINEW_ASSIGN(auto small, SmallAmplitude(effect, norm));
    if (!small || small->factor >= 1) return small;
    guess = small->amplitude / small->factor;  // smaller ones are found by trial: some do nothing
  }
  constexpr int kMaxSteps = 30;
  constexpr double kTolerance = 0.01;
  double amplitude = std::min(guess, effect.most);
  double below = 0;
  double above = 0;  // 0: none known yet
  for (int step = 0; step < kMaxSteps; ++step) {
    DriveTruth truth = plan_.truth;
    effect.apply(amplitude, truth);
    SINEW_ASSIGN(const Vector signature, Signature(truth));
    const double found = signature.norm();
    if (std::abs(found - norm) < kTolerance * norm)
      return std::optional<Sized>(Sized{amplitude, signature, 1});
    if (found < norm) {
      if (amplitude >= effect.most) return std::optional<Sized>();
      below = amplitude;
    } else {
      above = amplitude;
    }
    double next = amplitude * std::clamp(norm / std::max(found, 1e-9), 0.05, 8.0);
    if (above > 0 && (next >= above || next <= below || step > 8)) next = 0.5 * (below + above);
    amplitude = std::min(next, effect.most);
  }
  return std::optional<Sized>();  // the norm jumps over this value
}

Result<double> Oracle::Correlation(const Vector& signature, const std::string& effect) const {
  double largest = 0;
  for (const auto& group : CandidateColumns(effect, extents_)) {
    Matrix columns(signature.size(), static_cast<Eigen::Index>(group.size()));
    Eigen::Index count = 0;
    for (const HiddenEffect& member : group) {
      double amplitude = std::min(member.guess, member.most);
      Vector column;
      for (int round = 0; round < 2; ++round) {  // a secant of about unit size
        DriveTruth truth = plan_.truth;
        member.apply(amplitude, truth);
        SINEW_ASSIGN(column, Signature(truth));
        if (round == 0 && column.norm() > 0) {
          amplitude = std::min(amplitude * std::clamp(kUnitNorm / column.norm(), 0.01, 30.0), member.most);
        }
      }
      if (column.norm() > 0) columns.col(count++) = column.normalized();
    }
    if (count == 0) continue;
    const Matrix kept = columns.leftCols(count);
    const Vector weights = kept.colPivHouseholderQr().solve(signature);
    largest = std::max(largest, (kept * weights).norm() / signature.norm());
  }
  return std::min(largest, 1.0);
}

void Oracle::Whiten(Matrix& stacked) const {
  for (Eigen::Index at = 0; at < stacked.rows(); at += samples_) {
    plan_.position_noise.Whiten(stacked.middleRows(at, samples_));
  }
}

Result<Vector> Oracle::Positions(const DriveTruth& truth, const std::vector<DriveTrial>& trials) const {
  Vector positions(samples_ * static_cast<Eigen::Index>(trials.size()));
  for (std::size_t i = 0; i < trials.size(); ++i) {
    SINEW_ASSIGN(const DriveRecord record, SimulateDrive(truth, trials[i], step_));
    positions.segment(static_cast<Eigen::Index>(i) * samples_, samples_) = record.position;
  }
  return positions;
}

}  // namespace sinew
