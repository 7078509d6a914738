// What the machine's torque is made of, and what passes between person and machine.
#include <utility>

#include "problems/ankle_on_dynamometer/problem.h"
#include "problems/ankle_on_dynamometer/trial_run.h"

namespace sinew {

Status AnkleProblem::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  const std::vector<double> values = ValuesAt(parameters);
  AnkleTrialMemory memory;
  for (const AnkleTrial& trial : data_.trials) {
    Hdf5Node& node = details.At("ankle_on_dynamometer/" + trial.name);
    std::map<std::string, std::vector<double>> series;
    const StrappedFoot<double> foot = FootOf(data_.settings, values);
    const Status run = RunAnkleTrial(
        data_, trial, values, memory, [&](std::size_t s, double torque, const StrappedFootRun<double>* at) {
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
    if (!run) node.attributes["failure"] = run.error().message;
    for (auto& [name, samples] : series) node.At(name).SetVector(std::move(samples));
  }
  return {};
}

}  // namespace sinew
