// What the nms problem reports at given parameters: warnings, details and residual covariates.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "problems/nms/ceinms/subject.h"
#include "problems/nms/problem.h"

namespace sinew {

std::string NmsProblem::objective() const {
  std::string what = settings_.objective == NmsObjective::kThesis
                         ? "half the sum over trials and joints of the mean squared error of the moment over "
                           "its variance"
                         : Problem::objective();
  if (settings_.fibre_range) {
    const FibreRange& range = *settings_.fibre_range;
    what += fmt::format(", fibres {} {} .. {} optimal lengths", range.strict ? "kept within" : "drawn into",
                        range.lower, range.upper);
  }
  return what;
}

std::vector<Warning> NmsProblem::WarningsAt(const Vector& parameters) const {
  const FibreRange range = settings_.fibre_range.value_or(FibreRange{});
  struct Extent {
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();
  };
  std::vector<Extent> extents(data_.muscles.size());
  std::vector<MuscleTrace<double>> muscles;
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    if (data_.layout[static_cast<std::size_t>(data_.trials[t].first_block)].role != BlockRole::kTrain)
      continue;
    if (!MusclesAt(parameters, t, muscles)) return {};
    Slots slots;
    SlotsAt(parameters, t, slots, nullptr);
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      const auto [least, most] =
          std::minmax_element(muscles[m].fibre_length.begin(), muscles[m].fibre_length.end());
      extents[m].least = std::min(extents[m].least, *least / slots[m][kOptimalLength]);
      extents[m].most = std::max(extents[m].most, *most / slots[m][kOptimalLength]);
    }
  }
  std::vector<std::string> outside;
  for (std::size_t m = 0; m < extents.size(); ++m) {
    const double tolerated = settings_.fibre_range ? range.tolerance : 0;
    if (extents[m].least >= range.lower - tolerated && extents[m].most <= range.upper + tolerated) continue;
    outside.push_back(
        fmt::format("{} {:.2f} .. {:.2f}", data_.muscles[m], extents[m].least, extents[m].most));
  }
  if (outside.empty()) return {};
  return {{WarningKind::kOther,
           {},
           {},
           fmt::format(
               "fibre lengths outside of {} .. {} of the optimal one: {}{}", range.lower, range.upper,
               Join(outside, ", "),
               settings_.fibre_range
                   ? "; the moments fit better there than within fibre_range"
                   : "; at lengths without active force the strength is not determined. fibre_range in the "
                     "settings limits them")}};
}

std::vector<DerivedQuantity> NmsProblem::DerivedQuantities() const {
  // The numbers that give a muscle's coefficients, and where they come from.
  struct Filter {
    std::array<const NmsPlace*, 2> place{};  // of mean and spread; nullptr: the subject's
    std::array<double, 2> fixed{};           // the subject's where there is no parameter
    std::vector<std::string> muscles;

    [[nodiscard]] bool Equals(const Filter& other) const {
      for (std::size_t i = 0; i < place.size(); ++i) {
        if ((place[i] == nullptr) != (other.place[i] == nullptr)) return false;
        if (place[i] == nullptr ? fixed[i] != other.fixed[i]
                                : place[i]->parameter != other.place[i]->parameter ||
                                      place[i]->factor != other.place[i]->factor)
          return false;
      }
      return true;
    }
    [[nodiscard]] double At(std::size_t i, const Vector& parameters) const {
      return place[i] == nullptr ? fixed[i] : place[i]->factor * parameters[place[i]->parameter];
    }
  };
  static constexpr std::array<MuscleSlot, 2> kSlots{kFilterMean, kFilterSpread};
  std::vector<Filter> filters;
  for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
    Filter filter;
    for (std::size_t i = 0; i < kSlots.size(); ++i) {
      filter.fixed[i] = rest_[m][kSlots[i]];
      for (const NmsPlace& place : list_.places) {
        if (place.way == NmsPlace::kSets && place.muscle == static_cast<int>(m) && place.slot == kSlots[i])
          filter.place[i] = &place;
      }
    }
    if (filter.place[0] == nullptr && filter.place[1] == nullptr) continue;
    auto same =
        std::find_if(filters.begin(), filters.end(), [&](const Filter& f) { return f.Equals(filter); });
    if (same == filters.end()) same = filters.insert(filters.end(), filter);
    same->muscles.push_back(data_.muscles[m]);
  }
  std::vector<DerivedQuantity> quantities;
  for (const Filter& filter : filters) {
    DerivedQuantity quantity;
    quantity.unit = "1";
    std::string owner = filter.muscles.front();
    for (const NmsPlace* place : filter.place) {
      if (place == nullptr) continue;
      quantity.parameters.push_back(place->parameter);
      const Parameter& p = list_.parameters[static_cast<std::size_t>(place->parameter)];
      if (filter.muscles.size() > 1 && p.shared_by == filter.muscles)
        owner = p.name.substr(0, p.name.rfind('.'));
    }
    std::sort(quantity.parameters.begin(), quantity.parameters.end());
    for (const auto& [name, coefficient] :
         {std::pair{"C1", &SubjectMuscle::c1}, std::pair{"C2", &SubjectMuscle::c2}}) {
      quantity.name = owner + "." + name;
      quantity.meaning = "coefficient of the activation filter, as CEINMS has it; C1 and C2 may be exchanged";
      quantity.value = [this, filter, coefficient = coefficient](const Vector& parameters) {
        std::array<double, kMuscleSlots> slots{};
        for (std::size_t i = 0; i < kSlots.size(); ++i) slots[kSlots[i]] = filter.At(i, parameters);
        SubjectMuscle muscle;
        StoreSlots(slots, settings_.model.as_ceinms, data_.rate, muscle);
        return muscle.*coefficient;
      };
      quantities.push_back(quantity);
    }
  }
  return quantities;
}

std::vector<FigureOfMerit> NmsProblem::FiguresOfMerit(const Vector& /*parameters*/,
                                                      const std::vector<Vector>& predicted) const {
  double sum = 0;
  for (const NmsTrial& trial : data_.trials) {
    for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
      const std::size_t b = static_cast<std::size_t>(trial.first_block) + j;
      const Block& block = data_.layout[b];
      const auto samples = static_cast<Eigen::Index>(block.measured.size());
      if (block.role != BlockRole::kTrain || samples < 2) continue;
      const Eigen::Map<const Vector> measured(block.measured.data(), samples);
      const double variance =
          (measured.array() - measured.mean()).square().sum() / static_cast<double>(samples - 1);
      double squares = 0;
      for (Eigen::Index i = 0; i < samples; ++i)
        squares += std::pow(predicted[b][block.sample[static_cast<std::size_t>(i)]] - measured[i], 2);
      sum += squares / (static_cast<double>(samples) * variance);
    }
  }
  return {{"CEINMS's f",
           "sum over fitted trials and joints of the mean squared error of the moment over its variance",
           sum}};
}

std::vector<Problem::Signal> NmsProblem::ResidualCovariates(int block) const {
  const Block& of = data_.layout[static_cast<std::size_t>(block)];
  const auto trial = std::find_if(data_.trials.begin(), data_.trials.end(),
                                  [&](const NmsTrial& t) { return t.name == of.trial; });
  const auto j = static_cast<std::size_t>(block - trial->first_block);
  std::vector<Signal> signals;
  const auto add = [&](const std::string& name, const char* unit, const Vector& values) {
    Signal signal{name, unit, {}};
    for (const int at : of.sample) signal.values.push_back(values[at]);
    signals.push_back(std::move(signal));
  };
  if (trial->motion[j].angle.size() > 0) {
    add("angle", "rad", trial->motion[j].angle);
    add("velocity", "rad/s", trial->motion[j].velocity);
  }
  if (trial->pull_plus[j].any()) add("activation_plus", "1", trial->pull_plus[j]);
  if (trial->pull_minus[j].any()) add("activation_minus", "1", trial->pull_minus[j]);
  return signals;
}

NmsParts NmsProblem::PartsAt(const Vector& parameters, std::size_t trial) const {
  const NmsTrial& of = data_.trials[trial];
  NmsParts parts;
  SlotsAt(parameters, trial, parts.slots, nullptr);
  parts.arms = of.arms;
  for (std::size_t j = 0; j < parts.arms.size(); ++j) {
    parts.beyond.emplace_back(Vector::Zero(static_cast<Eigen::Index>(of.time.size())));
    for (std::size_t k = 0; k < parts.arms[j].size(); ++k) {
      const auto m = static_cast<std::size_t>(data_.joint_muscles[j][k]);
      const auto& crosses = data_.muscle_joints[m];
      const auto crossed = static_cast<std::size_t>(
          std::find(crosses.begin(), crosses.end(), static_cast<int>(j)) - crosses.begin());
      for (Eigen::Index i = 0; i < parts.arms[j][k].size(); ++i) {
        parts.arms[j][k][i] = ArmAt(of.muscles[m], crossed, static_cast<std::size_t>(i),
                                    parts.slots[m][kAngleOffset + crossed]);
      }
      if (list_.arm_offset[j] >= 0) parts.arms[j][k].array() += parameters[list_.arm_offset[j]];
    }
  }
  for (const NmsMoment& moment : list_.moments) {
    const double value = parameters[moment.parameter];
    if (value != 0) parts.beyond[static_cast<std::size_t>(moment.joint)] += value * moment.by_trial[trial];
  }
  return parts;
}

Status NmsProblem::MusclesAt(const Vector& parameters, std::size_t trial,
                             std::vector<MuscleTrace<double>>& muscles) const {
  Slots slots;
  SlotsAt(parameters, trial, slots, nullptr);
  muscles.resize(slots.size());
  for (std::size_t m = 0; m < slots.size(); ++m) {
    const Status status =
        ComputeMuscleForce(curves_, settings_.model, slots[m], data_.trials[trial].muscles[m], muscles[m]);
    if (!status) return Fail("{}: {}", data_.muscles[m], status.error().message);
  }
  return {};
}

Status NmsProblem::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    Hdf5Node& node = details.At("nms/" + data_.trials[t].name);
    node.At("time").SetVector(data_.trials[t].time);
    std::vector<MuscleTrace<double>> muscles;
    const Status status = MusclesAt(parameters, t, muscles);
    if (!status) {
      node.attributes["failure"] = status.error().message;
      continue;
    }
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      Hdf5Node& muscle = node.At(data_.muscles[m]);
      muscle.At("activation").SetVector(muscles[m].activation);
      muscle.At("fibre_length").SetVector(muscles[m].fibre_length);
      muscle.At("fibre_velocity").SetVector(muscles[m].fibre_velocity);
      muscle.At("force").SetVector(muscles[m].tendon_force);
    }
  }
  const std::vector<SubjectMuscle> muscles = SubjectAt(parameters).muscles;
  SINEW_ASSIGN(
      std::string subject,
      settings_.subject_original.empty()
          ? WriteCeinmsSubject(settings_.subject_text, settings_.subject_file, muscles)
          : WriteOriginalSubject(settings_.subject_original, OriginalSubjectName(settings_.subject_file),
                                 settings_.subject, muscles));
  details.At("subject").data = std::move(subject);
  return {};
}

Subject NmsProblem::SubjectAt(const Vector& parameters) const {
  Subject subject = settings_.subject;
  Slots slots = rest_;
  std::vector<bool> fitted_filter(slots.size());
  for (const NmsPlace& place : list_.places) {
    if (place.way != NmsPlace::kSets) continue;
    const auto m = static_cast<std::size_t>(place.muscle);
    slots[m][place.slot] = place.factor * parameters[place.parameter];
    if (place.slot == kFilterMean || place.slot == kFilterSpread) fitted_filter[m] = true;
  }
  for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
    for (SubjectMuscle& muscle : subject.muscles) {
      if (muscle.name != data_.muscles[m]) continue;
      const SubjectMuscle before = muscle;
      StoreSlots(slots[m], settings_.model.as_ceinms, data_.rate, muscle);
      if (fitted_filter[m]) continue;
      muscle.c1 = before.c1;  // exactly, not by way of mean and spread
      muscle.c2 = before.c2;
    }
  }
  return subject;
}

}  // namespace sinew
