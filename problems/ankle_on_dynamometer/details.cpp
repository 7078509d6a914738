// What the machine's torque is made of, and what passes between person and machine.
#include <algorithm>
#include <utility>

#include "problems/ankle_on_dynamometer/problem.h"
#include "problems/ankle_on_dynamometer/trial_run.h"

namespace sinew {
namespace {

// What is not of the active muscles in the torque that the machine measures: attachment, passive ankle and
// weight of the foot, where foot and plate have one axis.
template <class T>
T WithoutMuscles(const AnkleSettings& settings, const StrappedFoot<T>& foot, const PlateMotion& plate,
                 const StrappedFootRun<T>& run) {
  const FootInstant<T>& now = run.instant();
  return StrappedFootRun<T>::AttachmentTorque(foot.attachment, settings.foot, plate, now.torque) +
         foot.passive.Moment(now.ankle_angle, now.ankle_velocity) +
         WeightOfFoot(settings.foot, now.ankle_angle);
}

}  // namespace

// The inverse view: measured torque less attachment, passive ankle and weight of the foot, with its
// derivatives for the parameters, from which its error follows. SCIENCE section 6.
Status AnkleProblem::WriteInverseView(const AnkleTrial& trial, const Vector& parameters,
                                      FootSolutions& solutions, Hdf5Node& node) const {
  using Number = Dual<8>;
  const auto torque = std::find_if(trial.blocks.begin(), trial.blocks.end(), [](const AnkleBlock& block) {
    return block.quantity == AnkleQuantity::kMachineTorque;
  });
  const Block& block = data_.layout[static_cast<std::size_t>(torque->block)];
  const std::vector<double> values = ValuesAt(parameters);
  const double zero = trial.zero >= 0 ? parameters[trial.zero] : 0;
  std::vector<int> columns;
  for (const int index : trial.columns) {
    if (list_.parameters[static_cast<std::size_t>(index)].kind == ParameterKind::kBase)
      columns.push_back(index);
  }
  const std::size_t samples = block.measured.size();
  std::vector<double> removed(samples);
  std::vector<double> slopes(samples * columns.size());
  for (std::size_t first = 0; first < columns.size(); first += 8) {
    const std::size_t count = std::min<std::size_t>(8, columns.size() - first);
    std::vector<Number> dual(values.begin(), values.end());
    for (std::size_t slot = 0; slot < list_.index.size(); ++slot) {
      for (std::size_t lane = 0; lane < count; ++lane) {
        if (list_.index[slot] == columns[first + lane])
          dual[slot] = Number::Variable(values[slot], static_cast<int>(lane));
      }
    }
    const StrappedFoot<Number> foot = FootOf(data_.settings, dual);
    std::vector<Number> at_stop(trial.stops.size());
    SINEW_TRY(RunAnkleTrial(data_, trial, dual, solutions,
                            [&](std::size_t s, const Number&, const StrappedFootRun<Number>* run) {
                              if (run != nullptr)
                                at_stop[s] = WithoutMuscles(data_.settings, foot, trial.plate[s], *run);
                            }));
    for (std::size_t i = 0; i < samples; ++i) {
      const Number& at = at_stop[torque->stop[static_cast<std::size_t>(block.sample[i])]];
      removed[i] = at.value + zero;
      for (std::size_t lane = 0; lane < count; ++lane)
        slopes[i * columns.size() + first + lane] = -at.d[lane];
    }
  }
  std::vector<double> time;
  std::vector<double> interaction;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < samples; ++i) {
    time.push_back(block.prediction_time[static_cast<std::size_t>(block.sample[i])]);
    interaction.push_back(block.measured[i] - removed[i]);
  }
  for (const int index : columns) names.push_back(list_.parameters[static_cast<std::size_t>(index)].name);
  Hdf5Node& inverse = node.At("inverse");
  inverse.At("time").SetVector(std::move(time));
  inverse.At("torque_of_muscles").SetVector(std::move(interaction));
  inverse.At("torque_removed").SetVector(std::move(removed));
  inverse.At("parameters").data = std::move(names);
  inverse.At("slopes").SetMatrix(samples, columns.size(), std::move(slopes));
  return {};
}

// Of the values that a fit starts from. Nothing where there is no prediction.
void AnkleProblem::WriteBefore(const AnkleTrial& trial, FootSolutions& solutions, Hdf5Node& node) const {
  std::map<std::string, std::vector<double>> series;
  const Status run =
      RunAnkleTrial(data_, trial, ValuesAt(RestPoint(*this)), solutions,
                    [&](std::size_t /*stop*/, double torque, const StrappedFootRun<double>* at) {
                      const double interaction = at != nullptr ? at->instant().torque : 0;
                      const double sole = at != nullptr ? at->instant().boundary.sole_on_plate : 0;
                      series["machine_torque"].push_back(torque);
                      series["torque_of_attachment"].push_back(torque - interaction);
                      series["torque_of_sole"].push_back(sole);
                      series["torque_of_straps"].push_back(interaction - sole);
                    });
  if (!run) return;
  for (auto& [name, samples] : series) node.At("before/" + name).SetVector(std::move(samples));
}

Status AnkleProblem::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  const std::vector<double> values = ValuesAt(parameters);
  FootSolutions solutions;
  for (const AnkleTrial& trial : data_.trials) {
    Hdf5Node& node = details.At("ankle_on_dynamometer/" + trial.name);
    std::map<std::string, std::vector<double>> series;
    const StrappedFoot<double> foot = FootOf(data_.settings, values);
    const Status run =
        RunAnkleTrial(data_, trial, values, solutions,
                      [&](std::size_t s, double torque, const StrappedFootRun<double>* at) {
                        const PlateMotion& plate = trial.plate[s];
                        series["time"].push_back(trial.stops[s]);
                        series["machine_angle"].push_back(plate.angle);
                        series["machine_torque"].push_back(torque);
                        if (at == nullptr) {
                          series["torque_of_attachment"].push_back(torque);
                          return;
                        }
                        const FootInstant<double>& now = at->instant();
                        const double interaction = now.torque;
                        series["interaction_torque"].push_back(interaction);
                        series["torque_of_attachment"].push_back(torque - interaction);
                        series["torque_of_sole"].push_back(now.boundary.sole_on_plate);
                        series["torque_of_straps"].push_back(interaction - now.boundary.sole_on_plate);
                        series["ankle_angle"].push_back(now.ankle_angle);
                        series["moment_of_muscles"].push_back(now.muscle_moment);
                        series["moment_passive"].push_back(now.passive_moment);
                        series["sole_force_normal"].push_back(now.boundary.normal);
                        series["sole_force_shear"].push_back(now.boundary.shear);
                        series["strap_force"].push_back(now.boundary.strap);
                        series["power_of_muscles"].push_back(now.muscle_moment * now.ankle_velocity);
                        series["power_to_machine"].push_back(interaction * plate.velocity);
                        series["power_lost_in_boundary"].push_back(now.boundary.dissipated);
                        series["power_lost_in_ankle"].push_back(foot.passive.Dissipated(now.ankle_velocity));
                        series["energy_in_boundary"].push_back(now.boundary.stored);
                        for (std::size_t m = 0; m < data_.paths.size(); ++m) {
                          const std::string& name = data_.settings.muscles[m].name;
                          series["muscle_force/" + name].push_back(at->tendon_forces()[m]);
                          series["fibre_length/" + name].push_back(at->fibre_lengths()[m]);
                        }
                      });
    if (!run) {
      node.attributes["failure"] = run.error().message;
    } else if (trial.task != AnkleTask::kAttachmentAlone) {
      SINEW_TRY(WriteInverseView(trial, parameters, solutions, node));
    }
    for (auto& [name, samples] : series) node.At(name).SetVector(std::move(samples));
    WriteBefore(trial, solutions, node);
  }
  return {};
}

}  // namespace sinew
