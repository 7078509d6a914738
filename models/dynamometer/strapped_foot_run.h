// The motion of a foot that is strapped to the plate of a dynamometer, as the plate's angle prescribes it.
//
// States: the ankle's angle and velocity, the fibre length of every muscle. One implicit stage is one scalar
// equation in the angle, in which every fibre is in equilibrium. Derivatives follow from the solutions of a
// plain run (implicit function theorem), eight parameters per pass.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/assert.h"
#include "base/error.h"
#include "models/dynamometer/foot_solutions.h"
#include "models/dynamometer/implicit_step.h"
#include "models/dynamometer/strapped_foot.h"
#include "models/muscle/elastic_tendon.h"
#include "models/muscle/force_history.h"

namespace sinew {

/// One trial's run. @tparam T double, or Dual: then the plain run must have been made before with the same
/// numbers, and is followed. Of a muscle, strength, slack length, optimal length and what changes with time
/// may have derivatives.
template <class T>
class StrappedFootRun {
 public:
  /// All must outlive this.
  StrappedFootRun(const FootGeometry& geometry, const MuscleCurves& curves,
                  const std::vector<MusclePath>& paths, const StrappedFoot<T>& foot, FootSolutions& solutions)
      : geometry_(geometry),
        curves_(curves),
        paths_(paths),
        foot_(foot),
        solutions_(solutions),
        muscles_(foot.muscles),
        fibres_(paths.size()),
        lengths_(paths.size()),
        forces_(paths.size()) {
    for (const HillMuscle<T>& muscle : muscles_) sines_.push_back(Sin(muscle.pennation));
    for (std::size_t m = 0; m < muscles_.size(); ++m)
      histories_.emplace_back(foot_.history[m].first, foot_.history[m].second);
    if constexpr (kPlain) {
      solutions_.stages.clear();
      solutions_.fibres.clear();
      solutions_.slopes.clear();
      search_foot_ = Converted<Dual<1>>(foot_);
      length_foot_ = Converted<Dual<2>>(foot_);
      search_.reserve(muscles_.size());
      for (const HillMuscle<Dual<1>>& muscle : search_foot_.muscles) search_.emplace_back(curves_, muscle);
      found_.resize(paths.size());
    } else {
      for (const HillMuscle<T>& m : muscles_) {
        for (const T* fixed : {&m.isometric_force, &m.pennation, &m.length_change, &m.damping,
                               &m.largest_velocity, &m.compliance})
          SINEW_ASSERT(HasNoDerivative(*fixed), "a muscle's property whose derivative is not followed");
        plain_muscles_.push_back(sinew::Plain(m));
        varies_.push_back({true, true, !HasNoDerivative(m.strength), !HasNoDerivative(m.tendon_slack_length),
                           !HasNoDerivative(m.optimal_length), foot.remembers});
      }
    }
  }

  StrappedFootRun(const StrappedFootRun&) = delete;
  StrappedFootRun& operator=(const StrappedFootRun&) = delete;

  /// Static equilibrium of foot and fibres while the plate moves as stated. @param activation [muscles, and
  /// their mean] Errors: there is none within half a radian of the plate's angle.
  Status Settle(double time, const PlateMotion& plate, const std::vector<T>& activation) {
    still_ = true;
    time_ = began_ = time;
    h_ = 0;
    SINEW_TRY(SolveStage(0, plate, activation));
    still_ = false;
    angle_.begin = instant_.ankle_angle;
    velocity_.begin = T(plate.velocity);
    instant_.ankle_velocity = velocity_.begin;
    for (std::size_t m = 0; m < fibres_.size(); ++m) fibres_[m].begin = lengths_[m];
    passive_memory_.begin = angle_.begin;
    boundary_memory_.begin = angle_.begin - plate.angle;
    if (foot_.remembers) {
      for (auto& history : histories_) history.Pass(time, T(0.0));
    }
    return {};
  }

  /// One step. @param plate, activation of its three stages. Errors: no equilibrium, with the time.
  Status Step(double h, const PlateMotion* plate, const std::vector<T>* activation) {
    h_ = h;
    if (foot_.remembers) Remember();
    for (int stage = 0; stage < ImplicitStep::kStages; ++stage)
      SINEW_TRY(SolveStage(stage, plate[stage], activation[stage]));
    time_ += h;
    angle_.begin = instant_.ankle_angle;
    velocity_.begin = instant_.ankle_velocity;
    for (std::size_t m = 0; m < fibres_.size(); ++m) fibres_[m].begin = lengths_[m];
    passive_memory_.begin = passive_memory_now_;
    boundary_memory_.begin = boundary_memory_now_;
    if (foot_.remembers) {
      for (std::size_t m = 0; m < fibres_.size(); ++m)
        histories_[m].Pass(time_, fibres_[m].slope.back() / muscles_[m].optimal_length);
    }
    return {};
  }

  /// Of the last instant; of a run with derivatives only the ankle's motion and `torque` have them all.
  [[nodiscard]] const FootInstant<T>& instant() const { return instant_; }
  [[nodiscard]] const std::vector<T>& fibre_lengths() const { return lengths_; }
  [[nodiscard]] const std::vector<T>& tendon_forces() const { return forces_; }

  /// What the dynamometer measures: the torque of foot and attachment on the motor [N m].
  [[nodiscard]] T MachineTorque(const PlateMotion& plate) const {
    return instant_.torque + AttachmentTorque(foot_.attachment, geometry_, plate, instant_.torque);
  }

  /// The part of the attachment. @param interaction torque of the foot on the plate [N m]
  static T AttachmentTorque(const Attachment<T>& attachment, const FootGeometry& geometry,
                            const PlateMotion& plate, const T& interaction) {
    return attachment.WeightMoment(plate.angle, geometry.shank_tilt) + attachment.CableMoment(plate.angle) -
           attachment.inertia * plate.acceleration - attachment.Friction(plate.velocity, interaction);
  }

 private:
  static constexpr bool kPlain = std::is_same_v<T, double>;
  static constexpr int kMostIterations = 60;
  static constexpr int kQuickIterations = 12;
  // Where fibre and tendon are nearly slack, slopes change by a part of themselves within the last step: they
  // are taken at the very solution.
  static constexpr double kConverged = 1e-12;  // [rad]; velocities are a thousand times as far off per second
  static constexpr double kLengthConverged = 1e-12;  // of the optimal length
  static constexpr double kLongestTurn = 0.05;       // [rad] of one iteration
  static constexpr double kLongestPull = 0.1;        // of the optimal length, in one iteration
  static constexpr double kReach = 1;                // [rad] of foot and plate against each other
  static constexpr int kRefinements = 2;             // of what the safeguarded search found

  void Remember() {
    for (std::size_t m = 0; m < muscles_.size(); ++m) {
      muscles_[m].active_gain = histories_[m].Factor();
      if constexpr (kPlain) {
        search_foot_.muscles[m].active_gain = Dual<1>(muscles_[m].active_gain);
        length_foot_.muscles[m].active_gain = Dual<2>(muscles_[m].active_gain);
      }
    }
  }

  [[nodiscard]] double Rate() const { return still_ ? 0 : 1 / (h_ * ImplicitStep::kDiagonal); }

  static bool HasNoDerivative(const T& x) {
    if constexpr (kPlain) return true;
    for (const double slope : x.d) {
      if (slope != 0) return false;
    }
    return true;
  }

  // A number of this run in another kind of number, as a constant.
  template <class S>
  static S As(const T& x) {
    if constexpr (std::is_same_v<S, T>) {
      return x;
    } else {
      return S(Value(x));
    }
  }
  template <class S>
  [[nodiscard]] S Past(const StagedState<T>& state, int stage) const {
    return As<S>(state.Past(stage, h_));
  }

  template <class S, class A>
  void Move(int stage, const PlateMotion& plate, const A& angle, FootInstant<S>& instant,
            S& acceleration) const {
    instant.ankle_angle = S(angle);
    instant.ankle_velocity = S(plate.velocity);
    acceleration = S(0.0);
    if (still_) return;
    instant.ankle_velocity = Rate() * (angle - Past<S>(angle_, stage));
    acceleration = Rate() * (instant.ankle_velocity - Past<S>(velocity_, stage));
  }

  // Imbalance of the foot but for its muscles. @tparam A S, or double: the angle has no derivatives
  template <class S, class A>
  S RestOfMoments(const StrappedFoot<S>& foot, int stage, const PlateMotion& plate, const T& mean_activation,
                  const A& angle, FootInstant<S>& instant) const {
    S acceleration(0.0);
    Move(stage, plate, angle, instant, acceleration);
    const double rate = Rate();
    instant.passive_moment = foot.passive.Moment(angle, instant.ankle_velocity);
    instant.passive_moment -=
        Relaxing(foot.passive_relaxation, S(angle), Past<S>(passive_memory_, stage), rate);
    const double since =
        time_ - began_ + (still_ ? 0 : h_ * ImplicitStep::kNodes[static_cast<std::size_t>(stage)]);
    const FootPose<S> pose{plate.angle, plate.velocity, S(angle), instant.ankle_velocity, since};
    instant.boundary = BoundaryLoadAt(geometry_, foot.boundary, pose);
    const S relaxing =
        Relaxing(foot.boundary_relaxation, S(angle - plate.angle), Past<S>(boundary_memory_, stage), rate);
    instant.torque = instant.boundary.on_plate + relaxing;
    instant.muscle_moment = -(foot.antagonist * As<S>(mean_activation));
    const A weight = WeightOfFoot(geometry_, angle);
    S imbalance = geometry_.inertia * acceleration - instant.muscle_moment - instant.passive_moment - weight -
                  instant.boundary.on_foot + relaxing;
    if (foot.unknown.Acts())
      imbalance -= foot.unknown.Moment(angle, instant.ankle_velocity, As<S>(mean_activation), since);
    return imbalance;
  }

  // Moment of a spring in series with a damper, whose state z follows z' = (x - z) / time.
  template <class S>
  [[nodiscard]] S Relaxing(const Relaxation<S>& law, const S& x, const S& past, double rate) const {
    if (still_) return S(0.0);
    return law.stiffness * (x - Relaxed(law, x, past, rate));
  }
  template <class S>
  [[nodiscard]] static S Relaxed(const Relaxation<S>& law, const S& x, const S& past, double rate) {
    const S per_time = 1.0 / law.time;
    return (rate * past + per_time * x) / (rate + per_time);
  }

  // Forces of fibre m at a length and an angle.
  template <class S>
  elastic_tendon::Balance<S> FibreAt(const HillMuscle<S>& muscle, const S& sine, std::size_t m, int stage,
                                     const std::vector<T>& activation, const S& angle,
                                     const S& length) const {
    return elastic_tendon::BalanceAt(curves_, muscle, sine, paths_[m].template Length<S>(angle), length,
                                     VelocityOf<S>(m, stage, length), As<S>(activation[m]));
  }
  template <class S>
  [[nodiscard]] S VelocityOf(std::size_t m, int stage, const S& length) const {
    return still_ ? S(0.0) : S(Rate() * (length - Past<S>(fibres_[m], stage)));
  }

  Status SolveStage(int stage, const PlateMotion& plate, const std::vector<T>& activation) {
    if constexpr (kPlain) {
      SINEW_TRY(Find(stage, plate, activation));
    } else {
      Follow(stage, plate, activation);
    }
    if (still_) return {};
    const auto at = static_cast<std::size_t>(stage);
    angle_.slope[at] = instant_.ankle_velocity;
    velocity_.slope[at] = Rate() * (instant_.ankle_velocity - velocity_.Past(stage, h_));
    for (std::size_t m = 0; m < fibres_.size(); ++m)
      fibres_[m].slope[at] = Rate() * (lengths_[m] - fibres_[m].Past(stage, h_));
    Memorise(stage, foot_.passive_relaxation, T(instant_.ankle_angle), passive_memory_, passive_memory_now_);
    Memorise(stage, foot_.boundary_relaxation, T(instant_.ankle_angle - plate.angle), boundary_memory_,
             boundary_memory_now_);
    return {};
  }

  void Memorise(int stage, const Relaxation<T>& law, const T& x, StagedState<T>& state, T& now) {
    const T past = state.Past(stage, h_);
    now = Relaxed(law, x, past, Rate());
    state.slope[static_cast<std::size_t>(stage)] = Rate() * (now - past);
  }

  // Newton's method for the angle and all fibres at once, from where they would be at their last velocities;
  // where that does not converge, a safeguarded search.
  Status Find(int stage, const PlateMotion& plate, const std::vector<double>& activation) {
    bool searched = still_;
    bool last = false;  // what the search found is taken as it is
    if (still_) {
      SINEW_TRY(Search(stage, plate, activation));
    } else {
      Guess(stage);
    }
    double angle = guess_;
    for (int i = 0;; ++i) {
      FootInstant<Dual<1>> at;
      const Dual<1> rest =
          RestOfMoments(search_foot_, stage, plate, activation.back(), Dual<1>::Variable(angle, 0), at);
      double sum = rest.value;
      double slope = rest.d[0];
      double moment = 0;
      for (std::size_t m = 0; m < paths_.size(); ++m) {
        const auto turn = Dual<2>::Variable(angle, 1);
        const auto balance = FibreAt(length_foot_.muscles[m], Dual<2>(sines_[m]), m, stage, activation, turn,
                                     Dual<2>::Variable(lengths_[m], 0));
        const Dual<2> pull = paths_[m].template Arm<Dual<2>>(turn) * balance.tendon_force;
        FibreSolution& fibre = found_[m];
        fibre.length = lengths_[m];
        fibre.inverse = 1 / balance.imbalance.d[0];
        fibre.per_angle = balance.imbalance.d[1] * fibre.inverse;
        fibre.lever = -pull.d[0] * fibre.inverse;
        forces_[m] = balance.tendon_force.value;
        imbalance_[m] = balance.imbalance.value;
        moment += pull.value;
        sum += -pull.value - fibre.lever * imbalance_[m];
        slope += -pull.d[1] - fibre.lever * balance.imbalance.d[1];
      }
      double turn = -sum / slope;
      bool converged = slope > 0 && std::abs(turn) < kConverged;
      bool tame = slope > 0 && std::isfinite(turn);
      for (std::size_t m = 0; m < paths_.size(); ++m) {
        const double unit = muscles_[m].optimal_length;
        const double change = -imbalance_[m] * found_[m].inverse - found_[m].per_angle * turn;
        converged = converged && std::abs(change) < kLengthConverged * unit;
        tame = tame && found_[m].inverse > 0 && std::isfinite(change);
        change_[m] = std::clamp(change, -kLongestPull * unit, kLongestPull * unit);
      }
      // Beside a corner of the friction, Newton's method may leave the solution that the search has
      // bracketed.
      if (searched && !converged && !last && (!tame || i == kRefinements)) {
        angle = guess_;
        lengths_ = searched_lengths_;
        last = true;
        continue;
      }
      if (last && !tame) return Fail("t = {:.4g} s: the foot finds no equilibrium", time_);
      if (converged || last) {
        solutions_.stages.push_back({angle, slope, at.torque.d[0]});
        solutions_.fibres.insert(solutions_.fibres.end(), found_.begin(), found_.end());
        instant_.ankle_angle = angle;
        instant_.ankle_velocity = at.ankle_velocity.value;
        instant_.muscle_moment = at.muscle_moment.value + moment;
        instant_.passive_moment = at.passive_moment.value;
        instant_.boundary = Plain(at.boundary);
        instant_.torque = at.torque.value;
        return {};
      }
      if (!searched && (!tame || i == kQuickIterations)) {
        SINEW_TRY(Search(stage, plate, activation));
        searched = true;
        angle = guess_;
        i = -1;
        continue;
      }
      angle += std::clamp(turn, -kLongestTurn, kLongestTurn);
      for (std::size_t m = 0; m < paths_.size(); ++m)
        lengths_[m] = std::max(lengths_[m] + change_[m], kShortestFibre * muscles_[m].optimal_length);
    }
  }

  static BoundaryLoad<double> Plain(const BoundaryLoad<Dual<1>>& load) {
    return {load.on_foot.value, load.on_plate.value, load.sole_on_plate.value,
            load.normal.value,  load.shear.value,    load.strap.value,
            load.stored,        load.dissipated};
  }

  void Guess(int stage) {
    const auto before = static_cast<std::size_t>(std::max(stage - 1, 0));
    const double way = h_ * ImplicitStep::kDiagonal;
    const auto last = [&](const StagedState<double>& state) {
      return stage == 0 ? state.slope.back() : state.slope[before];
    };
    guess_ = angle_.Past(stage, h_) + way * (stage == 0 ? velocity_.begin : last(angle_));
    guess_ += way * way * last(velocity_);
    for (std::size_t m = 0; m < fibres_.size(); ++m)
      lengths_[m] = fibres_[m].Past(stage, h_) + way * last(fibres_[m]);
  }

  // The derivatives of what was found.
  void Follow(int stage, const PlateMotion& plate, const std::vector<T>& activation) {
    const StageSolution& solved = solutions_.stages[place_];
    const std::size_t first = place_ * paths_.size();
    const FibreSolution* fibres = solutions_.fibres.data() + first;
    ++place_;
    T sum = Tangent(RestOfMoments(foot_, stage, plate, activation.back(), solved.angle, instant_));
    for (std::size_t m = 0; m < paths_.size(); ++m) {
      const T velocity = VelocityOf<T>(m, stage, T(fibres[m].length));
      if (solutions_.slopes.size() == first + m)
        solutions_.slopes.push_back(
            SlopesOf(m, solved.angle, fibres[m].length, Value(velocity), Value(activation[m])));
      const MuscleSlopes& slopes = solutions_.slopes[first + m];
      const HillMuscle<T>& muscle = muscles_[m];
      const std::array<const T*, MuscleSlopes::kCount> inputs{&velocity,
                                                              &activation[m],
                                                              &muscle.strength,
                                                              &muscle.tendon_slack_length,
                                                              &muscle.optimal_length,
                                                              &muscle.active_gain};
      const double arm = paths_[m].template Arm<double>(solved.angle);
      lengths_[m] = T(fibres[m].length);
      for (std::size_t k = 0; k < inputs.size(); ++k) {
        if (!varies_[m][k]) continue;
        const auto& input = inputs[k]->d;
        const double of_sum = -arm * slopes.tendon_force[k] - fibres[m].lever * slopes.imbalance[k];
        const double of_length = -fibres[m].inverse * slopes.imbalance[k];
        for (std::size_t i = 0; i < input.size(); ++i) {
          sum.d[i] += of_sum * input[i];
          lengths_[m].d[i] += of_length * input[i];
        }
      }
    }
    const T turn = sum * (-1 / solved.per_angle);
    for (std::size_t m = 0; m < paths_.size(); ++m) lengths_[m] -= fibres[m].per_angle * turn;
    instant_.torque += solved.torque_per_angle * turn;
    instant_.ankle_angle = solved.angle + turn;
    T acceleration(0.0);
    Move(stage, plate, T(instant_.ankle_angle), instant_, acceleration);
  }

  // Once for all derivatives of a trial.
  [[nodiscard]] MuscleSlopes SlopesOf(std::size_t m, double angle, double length, double velocity,
                                      double activation) const {
    using S = Dual<MuscleSlopes::kCount>;
    const HillMuscle<double>& from = plain_muscles_[m];
    HillMuscle<S> muscle{S(from.optimal_length),  S(from.tendon_slack_length),
                         S(from.isometric_force), S(from.strength),
                         S(from.pennation),       S(from.length_change),
                         S(from.damping),         S(from.largest_velocity),
                         S(from.compliance),      S(Value(muscles_[m].active_gain))};
    muscle.optimal_length.d[MuscleSlopes::kOptimalLength] = 1;
    muscle.tendon_slack_length.d[MuscleSlopes::kSlackLength] = 1;
    muscle.strength.d[MuscleSlopes::kStrength] = 1;
    muscle.active_gain.d[MuscleSlopes::kActiveGain] = 1;
    const auto balance = elastic_tendon::BalanceAt(
        curves_, muscle, S(Value(sines_[m])), paths_[m].template Length<double>(angle), S(length),
        S::Variable(velocity, MuscleSlopes::kVelocity), S::Variable(activation, MuscleSlopes::kActivation));
    return {balance.imbalance.d, balance.tendon_force.d};
  }

  // A safeguarded search for the angle, with every fibre in equilibrium at every angle; into guess_ and
  // searched_lengths_.
  Status Search(int stage, const PlateMotion& plate, const std::vector<double>& activation) {
    double low = plate.angle - kReach;
    double high = plate.angle + kReach;
    double angle = still_ ? plate.angle : angle_.begin;
    if (!(angle > low && angle < high)) angle = plate.angle;
    bool below = false;  // an angle with a negative imbalance was seen, and one with a positive one
    bool above = false;
    for (int i = 0; i < kMostIterations; ++i) {
      FootInstant<Dual<1>> at;
      Dual<1> sum =
          RestOfMoments(search_foot_, stage, plate, activation.back(), Dual<1>::Variable(angle, 0), at);
      for (std::size_t m = 0; m < paths_.size(); ++m) {
        FibreVelocity<Dual<1>> velocity;
        velocity.rate = Rate();
        if (!still_) velocity.past = -(Rate() * Past<Dual<1>>(fibres_[m], stage));
        const auto turn = Dual<1>::Variable(angle, 0);
        const auto fibre = search_[m].Next(paths_[m].template Length<Dual<1>>(turn), Dual<1>(activation[m]),
                                           velocity, still_ ? 0 : fibres_[m].begin);
        if (!fibre) return Fail("t = {:.4g} s: {}", time_, fibre.error().message);
        sum -= paths_[m].template Arm<Dual<1>>(turn) * fibre->tendon_force;
        lengths_[m] = fibre->length.value;
      }
      if (!std::isfinite(sum.value)) return Fail("t = {:.4g} s: the moment on the foot is not finite", time_);
      // The imbalance rises with the angle.
      (sum.value > 0 ? high : low) = angle;
      (sum.value > 0 ? above : below) = true;
      const double before = angle;
      angle = sum.d[0] > 0 ? angle - sum.value / sum.d[0] : high;
      if (!(angle > low && angle < high)) angle = 0.5 * (low + high);
      if (std::abs(angle - before) < kConverged) {
        // Otherwise it is an end of the range that was searched.
        const bool bracketed = (above && below) || std::abs(sum.value) < kConverged * std::abs(sum.d[0]);
        if (!bracketed) break;
        guess_ = before;
        searched_lengths_ = lengths_;
        return {};
      }
    }
    return Fail("t = {:.4g} s: the foot finds no equilibrium within {} rad of the plate", time_, kReach);
  }

  const FootGeometry& geometry_;
  const MuscleCurves& curves_;
  const std::vector<MusclePath>& paths_;
  const StrappedFoot<T>& foot_;
  FootSolutions& solutions_;
  std::vector<HillMuscle<T>> muscles_;
  std::vector<HillMuscle<double>> plain_muscles_;               // of a run with derivatives
  std::vector<std::array<bool, MuscleSlopes::kCount>> varies_;  // what has derivatives
  std::vector<T> sines_;
  std::vector<ForceHistory<T>> histories_;
  bool still_ = false;
  double began_ = 0;
  double time_ = 0;
  double h_ = 0;
  std::size_t place_ = 0;
  StagedState<T> angle_;
  StagedState<T> velocity_;
  std::vector<StagedState<T>> fibres_;
  StagedState<T> passive_memory_;
  StagedState<T> boundary_memory_;
  T passive_memory_now_{0.0};
  T boundary_memory_now_{0.0};
  FootInstant<T> instant_;
  std::vector<T> lengths_;
  std::vector<T> forces_;
  // Of the search.
  StrappedFoot<Dual<1>> search_foot_;
  StrappedFoot<Dual<2>> length_foot_;
  std::vector<EquilibriumSearch<Dual<1>>> search_;
  std::vector<FibreSolution> found_;
  std::vector<double> imbalance_ = std::vector<double>(paths_.size());
  std::vector<double> change_ = std::vector<double>(paths_.size());
  std::vector<double> searched_lengths_;
  double guess_ = 0;
};

}  // namespace sinew
