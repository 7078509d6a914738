#include "problems/ankle_on_dynamometer/laboratory/simulation.h"

#include <algorithm>
#include <cmath>

#include "models/muscle/elastic_tendon.h"
#include "models/muscle/force_history.h"

namespace sinew {
namespace {

constexpr double kStep = 1e-4;   // [s]
constexpr int kFiner = 6;        // times as many springs under the sole
constexpr double kSettling = 1;  // [s] in which the plate is held before a trial begins

// Plate and foot with their velocities, two relaxing angles, the servo's reference, then fibre lengths.
enum State { kPlate, kPlateRate, kFoot, kFootRate, kRelaxedFoot, kRelaxedBoundary, kReference, kFibres };

struct Forces {
  double on_foot = 0;
  double on_plate = 0;
  double normal = 0;
  double strap = 0;
  double stored = 0;
  double lost = 0;
};

class Laboratory {
 public:
  Laboratory(const FootGeometry& geometry, const MuscleCurves& curves, const std::vector<MusclePath>& paths,
             const StrappedFoot<double>& truth, const LaboratoryTrial& trial)
      : geometry_(geometry), curves_(curves), paths_(paths), truth_(truth), trial_(trial) {
    muscles_ = truth.muscles;
    activation_.assign(paths.size() + 1, 0.0);
    velocity_.assign(paths.size(), 0.0);
    stretch_.assign(paths.size(), 0.0);
    shortening_.assign(paths.size(), 0.0);
  }

  Status Run(double apart, const std::function<void(const LaboratoryInstant&)>& see) {
    SINEW_TRY(Begin());
    const auto every = static_cast<long>(std::lround(apart / kStep));
    const auto steps = static_cast<long>(std::lround(trial_.duration / kStep));
    const auto settling = static_cast<long>(std::lround(kSettling / kStep));
    for (long i = -settling; i <= steps; ++i) {
      const double t = static_cast<double>(i) * kStep;
      if (i >= 0 && i % every == 0) see(Instant(t));
      if (i < steps) SINEW_TRY(Step(t));
    }
    return {};
  }

 private:
  using Values = std::vector<double>;

  Status Begin() {
    state_.assign(kFibres + paths_.size(), 0.0);
    state_[kPlate] = trial_.program.BeginAngle();
    state_[kFoot] = state_[kPlate];
    state_[kRelaxedFoot] = state_[kFoot];
    state_[kReference] = state_[kPlate];
    trial_.activation(0, activation_);
    for (std::size_t m = 0; m < paths_.size(); ++m) {
      EquilibriumSearch<double> search(curves_, muscles_[m]);
      SINEW_ASSIGN(state_[kFibres + m],
                   search.Length(paths_[m].Length<double>(state_[kFoot]), activation_[m], {}, 0));
    }
    return {};
  }

  // Sole and straps, in the frame of the shank.
  [[nodiscard]] Forces Boundary(const Values& x, double since) const {
    Forces sum;
    if (!trial_.foot) return sum;
    const BoundaryLaw<double>& law = truth_.boundary;
    const double cp = std::cos(x[kPlate]);
    const double sp = std::sin(x[kPlate]);
    const double cq = std::cos(x[kFoot]);
    const double sq = std::sin(x[kFoot]);
    const double plate_y = law.sole_compression - geometry_.ankle_height - law.axis_y;  // in the plate
    const auto act = [&](double px, double py, double fx, double fy) {
      sum.on_foot += px * fy - py * fx;
      sum.on_plate -= (px - law.axis_x) * fy - (py - law.axis_y) * fx;
    };
    const int strips = geometry_.strips * kFiner;
    const double length = (geometry_.heel + geometry_.toe) / strips;
    for (int i = 0; i < strips; ++i) {
      const double fx = -geometry_.heel + (i + 0.5) * length;
      const double fy = -geometry_.ankle_height;
      const double px = cq * fx - sq * fy;
      const double py = sq * fx + cq * fy;
      // Distance below the plate along its normal (-sp, cp).
      const double rx = px - law.axis_x;
      const double ry = py - law.axis_y;
      const double depth = plate_y - (cp * ry - sp * rx);
      if (depth <= 0) continue;
      const double vx = -x[kFootRate] * py + x[kPlateRate] * ry;
      const double vy = x[kFootRate] * px - x[kPlateRate] * rx;
      const double away = cp * vy - sp * vx;
      const double slip = cp * vx + sp * vy;
      double elastic = law.sole_stiffness * geometry_.width * length * depth;
      const double grown = law.sole_exponent == 0 ? 1 : std::pow(depth / 0.005, law.sole_exponent);
      elastic *= grown;
      const double normal = std::max(0.0, elastic * (1 - law.sole_dissipation * away));
      const double shear =
          -normal * law.friction * std::clamp(slip / geometry_.transition_velocity, -1.0, 1.0);
      act(px, py, shear * cp - normal * sp, shear * sp + normal * cp);
      sum.normal += normal;
      sum.stored += elastic * depth / (2 + law.sole_exponent);
      sum.lost -= (normal - elastic) * away + shear * slip;
    }
    for (const FootStrap& strap : geometry_.straps) {
      const double px = cq * strap.foot_x - sq * strap.foot_y;
      const double py = sq * strap.foot_x + cq * strap.foot_y;
      const double ax = strap.plate_x - law.axis_x;
      const double qx = law.axis_x + cp * ax - sp * plate_y;
      const double qy = law.axis_y + sp * ax + cp * plate_y;
      const double dx = qx - px;
      const double dy = qy - py;
      const double now = std::hypot(dx, dy);
      const double rest = std::hypot(strap.plate_x - strap.foot_x, geometry_.ankle_height + strap.foot_y);
      const double stretch = now - rest + law.sole_compression - law.strap_loosening * since;
      const double soft = law.strap_stiffness / law.strap_exponent;  // [N]
      const double slack = std::log1p(-std::min(law.strap_pretension / soft, 1 - 1e-12)) / law.strap_exponent;
      const double used = std::max(stretch, slack);
      sum.stored += (law.strap_pretension - soft) * used +
                    soft * std::expm1(law.strap_exponent * used) / law.strap_exponent;
      const double elastic = law.strap_pretension + soft * std::expm1(law.strap_exponent * stretch);
      if (elastic <= 0) continue;
      const double vx = -x[kPlateRate] * (qy - law.axis_y) + x[kFootRate] * py;
      const double vy = x[kPlateRate] * (qx - law.axis_x) - x[kFootRate] * px;
      const double rate = (dx * vx + dy * vy) / now;
      const double pull = std::max(0.0, elastic * (1 + law.strap_damping * rate));
      act(px, py, pull * dx / now, pull * dy / now);
      sum.strap += pull;
      sum.lost += (pull - elastic) * rate;
    }
    return sum;
  }

  // Velocity at which the fibre's force along the tendon is the tendon's.
  [[nodiscard]] double FibreVelocity(std::size_t m, double unit_length, double length, double& force) const {
    const HillMuscle<double>& muscle = muscles_[m];
    const double sine = std::sin(muscle.pennation);
    const double cosine = PennationCosine(muscle, sine, length);
    force = TendonForce(curves_, muscle, unit_length, length, cosine);
    const double per_speed = 1 / (muscle.optimal_length * muscle.largest_velocity);
    double low = -20 / per_speed;
    double high = 20 / per_speed;
    double v = velocity_[m];
    for (int i = 0; i < 60; ++i) {
      const double f = FibreForce(curves_, muscle, length, v, activation_[m]) * cosine - force;
      (f > 0 ? high : low) = v;
      const double step = 1e-6 / per_speed;
      const double slope =
          (FibreForce(curves_, muscle, length, v + step, activation_[m]) * cosine - force - f) / step;
      double next = slope > 0 ? v - f / slope : high + 1;
      if (!(next >= low && next <= high)) next = 0.5 * (low + high);
      if (std::abs(next - v) < 1e-10) return next;
      v = next;
    }
    return v;
  }

  void Derivative(double since, const Values& x, Values& rate, LaboratoryInstant* instant) {
    const Attachment<double>& attachment = truth_.attachment;
    const Forces forces = Boundary(x, std::max(since, 0.0));
    const double between = x[kFoot] - x[kPlate];
    const double relaxing =
        trial_.foot ? truth_.boundary_relaxation.stiffness * (between - x[kRelaxedBoundary]) : 0;
    const double interaction = forces.on_plate + relaxing;
    MachineProgram program = trial_.program;
    if (since < 0) {
      program.mode = MachineMode::kIsometric;
    }
    const double begun = std::max(since, 0.0);
    const double motor = program.Torque(begun, x[kPlate], x[kPlateRate], x[kReference]);
    rate[kReference] = program.ReferenceRate(begun, x[kPlate], x[kPlateRate], x[kReference]);
    const double friction = attachment.Friction(x[kPlateRate], interaction);
    rate[kPlate] = x[kPlateRate];
    rate[kPlateRate] =
        (motor + interaction - friction + attachment.WeightMoment(x[kPlate], geometry_.shank_tilt) +
         attachment.CableMoment(x[kPlate])) /
        attachment.inertia;
    rate[kFoot] = x[kFootRate];
    const PassiveAnkle<double>& passive = truth_.passive;
    const double memory = truth_.passive_relaxation.stiffness * (x[kFoot] - x[kRelaxedFoot]);
    double moment = 0;
    double fibres_store = 0;
    for (std::size_t m = 0; m < paths_.size(); ++m) {
      double force = 0;
      rate[kFibres + m] = FibreVelocity(m, paths_[m].Length<double>(x[kFoot]), x[kFibres + m], force);
      velocity_[m] = rate[kFibres + m];
      moment += paths_[m].Arm<double>(x[kFoot]) * force;
    }
    moment -= truth_.antagonist * activation_.back();
    const double weight_angle = x[kFoot] - geometry_.shank_tilt;
    const double weight =
        -geometry_.mass * geometry_.gravity *
        (geometry_.mass_x * std::cos(weight_angle) - geometry_.mass_y * std::sin(weight_angle));
    rate[kFootRate] = trial_.foot ? (moment + passive.Moment(x[kFoot], x[kFootRate]) - memory + weight +
                                     forces.on_foot - relaxing) /
                                        geometry_.inertia
                                  : 0;
    if (!trial_.foot) rate[kFoot] = 0;
    rate[kRelaxedFoot] = (x[kFoot] - x[kRelaxedFoot]) / truth_.passive_relaxation.time;
    rate[kRelaxedBoundary] = (between - x[kRelaxedBoundary]) / truth_.boundary_relaxation.time;
    if (instant == nullptr) return;
    instant->motor_torque = motor;
    instant->interaction = interaction;
    instant->sole_normal = forces.normal;
    instant->strap = forces.strap;
    instant->muscle_power = moment * x[kFootRate];
    instant->lost_power = friction * x[kPlateRate];
    instant->energy =
        0.5 * attachment.inertia * x[kPlateRate] * x[kPlateRate] +
        attachment.gravity * std::sin(attachment.gravity_angle + x[kPlate] - geometry_.shank_tilt) +
        0.5 * attachment.stiffness * x[kPlate] * x[kPlate] + fibres_store;
    if (!trial_.foot) return;
    instant->lost_power += forces.lost + passive.Dissipated(x[kFootRate]) +
                           truth_.passive_relaxation.stiffness / truth_.passive_relaxation.time *
                               std::pow(x[kFoot] - x[kRelaxedFoot], 2) +
                           truth_.boundary_relaxation.stiffness / truth_.boundary_relaxation.time *
                               std::pow(between - x[kRelaxedBoundary], 2);
    instant->energy +=
        0.5 * geometry_.inertia * x[kFootRate] * x[kFootRate] + passive.Stored(x[kFoot]) + forces.stored +
        geometry_.mass * geometry_.gravity *
            (geometry_.mass_x * std::sin(weight_angle) + geometry_.mass_y * std::cos(weight_angle)) +
        0.5 * truth_.passive_relaxation.stiffness * std::pow(x[kFoot] - x[kRelaxedFoot], 2) +
        0.5 * truth_.boundary_relaxation.stiffness * std::pow(between - x[kRelaxedBoundary], 2);
  }

  Status Step(double t) {
    constexpr double kNode[4] = {0, 0.5, 0.5, 1};
    constexpr double kWeight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    Values next = state_;
    Values at = state_;
    Values rate(state_.size(), 0.0);
    for (int stage = 0; stage < 4; ++stage) {
      if (stage > 0) {
        for (std::size_t i = 0; i < at.size(); ++i) at[i] = state_[i] + kStep * kNode[stage] * rate[i];
      }
      trial_.activation(std::max(0.0, t + kNode[stage] * kStep), activation_);
      Derivative(t + kNode[stage] * kStep, at, rate, nullptr);
      for (std::size_t i = 0; i < next.size(); ++i) next[i] += kStep * kWeight[stage] * rate[i];
    }
    state_ = std::move(next);
    for (const double value : state_) {
      if (!std::isfinite(value)) return Fail("the laboratory's simulation is not finite at t = {:.4g} s", t);
    }
    if (truth_.remembers && t >= 0) Remember();
    return {};
  }

  // Force enhancement and depression, with the memory of ForceHistory.
  void Remember() {
    const double kept = std::exp(-kStep / ForceHistory<double>::kTimeConstant);
    for (std::size_t m = 0; m < paths_.size(); ++m) {
      const double speed = velocity_[m] / muscles_[m].optimal_length;
      stretch_[m] = kept * stretch_[m] + kStep * std::max(speed, 0.0);
      shortening_[m] = kept * shortening_[m] + kStep * std::max(-speed, 0.0);
      muscles_[m].active_gain =
          std::max(ForceHistory<double>::kMinimum, (1 + truth_.history[m].first * stretch_[m]) *
                                                       (1 - truth_.history[m].second * shortening_[m]));
    }
  }

  LaboratoryInstant Instant(double t) {
    LaboratoryInstant instant;
    instant.time = t;
    instant.plate_angle = state_[kPlate];
    instant.plate_velocity = state_[kPlateRate];
    instant.ankle_angle = state_[kFoot];
    instant.ankle_velocity = state_[kFootRate];
    Values rate(state_.size(), 0.0);
    trial_.activation(t, activation_);
    Derivative(t, state_, rate, &instant);
    instant.fibre_lengths.assign(state_.begin() + kFibres, state_.end());
    return instant;
  }

  const FootGeometry& geometry_;
  const MuscleCurves& curves_;
  const std::vector<MusclePath>& paths_;
  const StrappedFoot<double>& truth_;
  const LaboratoryTrial& trial_;
  std::vector<HillMuscle<double>> muscles_;
  Values state_;
  Values activation_;
  Values velocity_;
  Values stretch_;
  Values shortening_;
};

}  // namespace

Status SimulateLaboratory(const FootGeometry& geometry, const MuscleCurves& curves,
                          const std::vector<MusclePath>& paths, const StrappedFoot<double>& truth,
                          const LaboratoryTrial& trial, double apart,
                          const std::function<void(const LaboratoryInstant&)>& see) {
  return Laboratory(geometry, curves, paths, truth, trial).Run(apart, see);
}

}  // namespace sinew
