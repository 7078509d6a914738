#include "problems/nms/muscle/muscle_force.h"

#include <algorithm>
#include <cmath>

#include "models/muscle/cross_talk.h"
#include "models/muscle/elastic_tendon.h"
#include "models/muscle/force_history.h"
#include "models/muscle/spline_end.h"
#include "models/muscle/spline_slopes.h"
#include "problems/nms/muscle/tendon_compliance.h"

namespace sinew {
namespace {

constexpr double kSameTime = 1e-9;  // [s]

// Whether a number is 0 and stays so whatever the parameters do.
bool IsAbsent(double x) {
  return x == 0;
}
template <int N>
bool IsAbsent(const Dual<N>& x) {
  return x.value == 0 && std::all_of(x.d.begin(), x.d.end(), [](double d) { return d == 0; });
}

template <class T>
class MuscleForce {
 public:
  MuscleForce(const MuscleCurves& curves, const MuscleModel& model, const std::array<T, kMuscleSlots>& p,
              const MuscleSignals& signals, MuscleTrace<T>& trace, FoundLengths* found)
      : curves_(curves), model_(model), p_(p), signals_(signals), trace_(trace), found_(found) {
    muscle_ = {p[kOptimalLength], p[kTendonSlackLength], p[kIsometricForce], p[kStrength],
               p[kPennation],     p[kLengthChange],      p[kDamping],        p[kLargestVelocity]};
    sine_ = Sin(p[kPennation]);
    thickness_ = p[kOptimalLength] * sine_;
    strength_ = p[kIsometricForce] * p[kStrength];
    remembers_ = !IsAbsent(p[kEnhancement]) || !IsAbsent(p[kDepression]);
    excited_as_measured_ = IsAbsent(p[kEmgGain]) && IsAbsent(p[kEmgDrift]) && IsAbsent(p[kCoContraction]) &&
                           IsAbsent(p[kCrossTalk]);
    for (auto* values :
         {&trace_.activation, &trace_.fibre_length, &trace_.fibre_velocity, &trace_.tendon_force})
      values->assign(signals_.time.size(), T(0.0));
  }

  Status Compute() {
    PlaceUnit();
    if (model_.as_ceinms) {
      FilterAsCeinms(false, trace_.activation);
    } else {
      Filter();
    }
    if (model_.tendon == TendonMode::kRigid) return Rigid();
    return model_.tendon == TendonMode::kEquilibrium ? InEquilibrium() : Integrated();
  }

 private:
  [[nodiscard]] std::size_t frames() const { return signals_.time.size(); }

  // Sample k of the excitation as it was, given the measured one.
  [[nodiscard]] T Excitation(std::size_t k) const {
    if (excited_as_measured_) return T(signals_.excitation[k]);
    const double measured = signals_.excitation[k];
    const T own =
        signals_.others.empty() || IsAbsent(p_[kCrossTalk])
            ? T(measured)
            : WithoutCrossTalk(measured, signals_.others[k], signals_.number_of_others, p_[kCrossTalk]);
    const double since = signals_.excitation_time[k] - signals_.excitation_time.front();
    const T excitation = own + own * p_[kEmgGain] + own * since * p_[kEmgDrift] + p_[kCoContraction];
    return Value(excitation) >= 0 ? excitation : T(0.0);
  }

  // Lengths of the unit at the angles as they were. A muscle shortens by its moment arm per angle.
  void PlaceUnit() {
    length_.assign(signals_.unit_length.begin(), signals_.unit_length.end());
    for (std::size_t j = 0; j < signals_.arms.size(); ++j) {
      const T& offset = p_[kAngleOffset + j];
      if (IsAbsent(offset)) continue;
      turned_ = true;
      for (std::size_t i = 0; i < frames(); ++i) length_[i] -= ShorteningAt(signals_, j, i, offset);
    }
  }

  // The filter at the rate of the excitation; straight lines between its samples.
  void Filter() {
    const auto& t = signals_.excitation_time;
    const double step = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
    ExcitationFilter<T> filter(FilterOfTimes(p_[kFilterMean], p_[kFilterSpread], step));
    filter.Settle(Excitation(0));
    neural_.resize(t.size());
    for (std::size_t k = 0; k < t.size(); ++k) neural_[k] = filter.Next(Excitation(k));
    const T late = p_[kDelay] + FilterLead(p_[kFilterMean], step);
    for (std::size_t i = 0; i < frames(); ++i) {
      const T at = signals_.time[i] - late;
      const auto after = std::upper_bound(t.begin() + 1, t.end() - 1, Value(at));
      const auto k = static_cast<std::size_t>(after - t.begin());
      // Before the first sample and after the last one the excitation stays as it was there.
      T u = Value(at) <= t.front() ? neural_.front() : neural_.back();
      if (Value(at) > t.front() && Value(at) < t.back()) {
        const T share = (at - t[k - 1]) * (1 / (t[k] - t[k - 1]));
        u = neural_[k - 1] + share * (neural_[k] - neural_[k - 1]);
      }
      trace_.activation[i] = Shaped(model_.shape, u, p_[kShape]);
    }
  }

  // Samples that are due before the first length pass the filter one by one, from then on one per length: the
  // last one that is due.
  void FilterAsCeinms(bool forgetful, std::vector<T>& activation) const {
    ExcitationFilter<T> filter(FilterOfCoefficients(p_[kFilterMean], p_[kFilterSpread]));
    filter.Settle(T(0.0));
    const double delay = Value(p_[kDelay]);
    const auto due = [&](std::size_t k) { return signals_.excitation_time[k] + delay; };
    std::size_t k = 0;
    for (std::size_t i = 0; i < frames(); ++i) {
      while (k + 1 < signals_.excitation.size() && due(k) < signals_.time[i] - kSameTime) {
        if (i == 0) filter.Next(Excitation(k));
        ++k;
      }
      activation[i] = Shaped(model_.shape, filter.Next(Excitation(k)), p_[kShape]);
      if (forgetful) filter.DropPreviousState();
    }
  }

  void PullAll(const std::vector<T>& lengths, const std::vector<T>& velocities) {
    ForceHistory<T> history(p_[kEnhancement], p_[kDepression]);
    for (std::size_t i = 0; i < frames(); ++i) {
      if (remembers_) {
        history.Pass(signals_.time[i], velocities[i] / p_[kOptimalLength]);
        muscle_.active_gain = history.Factor();
      }
      trace_.fibre_length[i] = lengths[i];
      trace_.fibre_velocity[i] = velocities[i];
      trace_.tendon_force[i] = AlongTendon(lengths[i], velocities[i], trace_.activation[i]);
    }
  }

  // Force of the fibre along the tendon [N].
  T AlongTendon(const T& length, const T& velocity, const T& activation) const {
    if constexpr (std::is_same_v<T, double>) {
      return FibreForce(curves_, muscle_, length, velocity, activation) *
             PennationCosine(muscle_, sine_, length);
    } else {
      const Pull by =
          PullAt(curves_, Plain(muscle_), sine_.value, length.value, velocity.value, activation.value);
      T force(by.value);
      for (std::size_t i = 0; i < force.d.size(); ++i) {
        force.d[i] = by.length * length.d[i] + by.velocity * velocity.d[i] + by.activation * activation.d[i] +
                     ByMuscle(by, muscle_, thickness_, strength_, i);
      }
      return force;
    }
  }

  Status Rigid() {
    std::vector<T> lengths(frames());
    for (std::size_t i = 0; i < frames(); ++i) lengths[i] = RigidFibreLength(muscle_, sine_, length_[i]);
    if (model_.as_ceinms) {
      PullAll(lengths, SplineSlopes(signals_.time, lengths));
    } else {
      // Along the tendon the fibre is as fast as the unit.
      std::vector<T> velocities(frames());
      if (turned_) {
        velocities = SplineSlopes(signals_.time, length_);
      } else {
        const std::vector<double> unit = SplineSlopes(signals_.time, signals_.unit_length);
        velocities.assign(unit.begin(), unit.end());
      }
      for (std::size_t i = 0; i < frames(); ++i)
        velocities[i] = velocities[i] * PennationCosine(muscle_, sine_, lengths[i]);
      PullAll(lengths, velocities);
    }
    if (IsAbsent(p_[kTendonCompliance])) return {};
    muscle_.active_gain = 1.0;
    return AddCompliance(curves_, muscle_, p_[kTendonCompliance], signals_.time, length_, trace_.activation,
                         trace_.tendon_force);
  }

  // v = rate l + past of the spline through the lengths so far that ends here.
  static FibreVelocity<T> VelocityAtEnd(const double* weights, const std::vector<T>& lengths, std::size_t i) {
    FibreVelocity<T> velocity;
    velocity.rate = weights[kSplinePoints - 1];
    const std::size_t before = std::min(i, kSplinePoints - 1);
    for (std::size_t k = 1; k <= before; ++k)
      velocity.past += weights[kSplinePoints - 1 - k] * lengths[i - k];
    return velocity;
  }

  // Whether the lengths of all passes are known for these parameters; if not, they are forgotten.
  bool KnowsLengths(std::size_t passes) {
    if (found_ == nullptr) return false;
    bool known = true;
    for (std::size_t i = 0; i < kMuscleSlots; ++i) known = known && found_->parameters[i] == Value(p_[i]);
    for (std::size_t pass = 0; pass < passes; ++pass)
      known = known && found_->lengths[pass].size() == frames();
    if (known) return true;
    for (std::size_t i = 0; i < kMuscleSlots; ++i) found_->parameters[i] = Value(p_[i]);
    for (auto& lengths : found_->lengths) lengths.clear();
    return false;
  }

  Status Equilibrate(const std::vector<T>& activation, bool known, std::size_t pass,
                     std::vector<T>& lengths) {
    const bool prepared = signals_.end_weights != nullptr;
    const std::vector<double> own = prepared ? std::vector<double>() : SplineEndWeights(signals_.time);
    const double* weights = prepared ? signals_.end_weights->data() : own.data();
    lengths.assign(frames(), T(0.0));
    EquilibriumSearch<T> search(curves_, muscle_);
    double guess = 0;
    for (std::size_t i = 0; i < frames(); ++i) {
      if constexpr (std::is_same_v<T, double>) {
        if (known) {
          lengths = found_->lengths[pass];
          return {};
        }
      }
      const auto velocity = VelocityAtEnd(weights + i * kSplinePoints, lengths, i);
      if (known) {
        lengths[i] = search.Known(found_->lengths[pass][i], length_[i], activation[i], velocity);
        continue;
      }
      auto length = search.Length(length_[i], activation[i], velocity, guess);
      if (!length) return Fail("t = {:.4g} s: {}", signals_.time[i], length.error().message);
      lengths[i] = *length;
      guess = Value(*length);
    }
    if (found_ != nullptr && !known) {
      for (const T& length : lengths) found_->lengths[pass].push_back(Value(length));
    }
    return {};
  }

  Status InEquilibrium() {
    std::vector<T> lengths;
    const bool known = KnowsLengths(model_.as_ceinms ? 2 : 1);
    SINEW_TRY(Equilibrate(trace_.activation, known, 0, lengths));
    if (!model_.as_ceinms) {
      PullAll(lengths, SplineSlopes(signals_.time, lengths));
      return {};
    }
    std::vector<T> other_activation(frames());
    std::vector<T> other_lengths;
    FilterAsCeinms(true, other_activation);
    SINEW_TRY(Equilibrate(other_activation, known, 1, other_lengths));
    PullAll(lengths, SplineSlopes(signals_.time, other_lengths));
    return {};
  }

  Status Integrated() {
    ElasticFibre<T> state(curves_, muscle_);
    ForceHistory<T> history(p_[kEnhancement], p_[kDepression]);
    for (std::size_t i = 0; i < frames(); ++i) {
      if (remembers_) muscle_.active_gain = history.Factor();
      auto fibre = state.Next(signals_.time[i], length_[i], trace_.activation[i]);
      if (!fibre) return Fail("t = {:.4g} s: {}", signals_.time[i], fibre.error().message);
      trace_.fibre_length[i] = fibre->length;
      trace_.fibre_velocity[i] = fibre->velocity;
      trace_.tendon_force[i] = fibre->tendon_force;
      // What is remembered changes slowly: of this sample it counts from the next one on.
      if (remembers_) history.Pass(signals_.time[i], fibre->velocity / p_[kOptimalLength]);
    }
    return {};
  }

  const MuscleCurves& curves_;
  const MuscleModel& model_;
  const std::array<T, kMuscleSlots>& p_;
  const MuscleSignals& signals_;
  MuscleTrace<T>& trace_;
  FoundLengths* found_;
  HillMuscle<T> muscle_;
  T sine_{0.0};
  T thickness_{0.0};
  T strength_{0.0};
  bool remembers_ = false;
  bool excited_as_measured_ = true;
  bool turned_ = false;    // a joint's angle was not as measured
  std::vector<T> length_;  // of the unit
  std::vector<T> neural_;
};

}  // namespace

template <class T>
Status ComputeMuscleForce(const MuscleCurves& curves, const MuscleModel& model,
                          const std::array<T, kMuscleSlots>& parameters, const MuscleSignals& signals,
                          MuscleTrace<T>& trace, FoundLengths* found) {
  return MuscleForce<T>(curves, model, parameters, signals, trace, found).Compute();
}

#define SINEW_MUSCLE_FORCE(T)                                                                     \
  template Status ComputeMuscleForce<T>(const MuscleCurves&, const MuscleModel&,                  \
                                        const std::array<T, kMuscleSlots>&, const MuscleSignals&, \
                                        MuscleTrace<T>&, FoundLengths*)
SINEW_MUSCLE_FORCE(double);
SINEW_MUSCLE_FORCE(Dual<kFewLanes>);
SINEW_MUSCLE_FORCE(Dual<kSomeLanes>);
SINEW_MUSCLE_FORCE(Dual<kMuscleSlots>);
#undef SINEW_MUSCLE_FORCE

}  // namespace sinew
