#include "models/mechanisms/mechanism_run.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>

#include "base/text.h"
#include "models/mechanisms/integrator.h"
#include "models/mechanisms/integrator_of.h"
#include "models/mechanisms/mechanism_system.h"

namespace sinew {
namespace {

constexpr int kMaxWindows = 1000;
constexpr long kStepsAtOnce = 500;  // between two looks at the clock

Result<std::string> FormulationOf(const Mechanism& mechanism, const std::string& wanted) {
  std::vector<std::string> names;
  for (const MechanismFormulation& formulation : mechanism.formulations) {
    if (wanted.empty() || formulation.name == wanted) return formulation.name;
    names.push_back(formulation.name);
  }
  return Fail("{} has no formulation '{}'{}", mechanism.name, wanted, Suggestion(wanted, names));
}

std::unique_ptr<MechanismSystem> Build(const Mechanism& mechanism, const std::string& formulation,
                                       int windows) {
  if (mechanism.name == "A01") return BuildPendulum();
  if (mechanism.name == "A02") return BuildWindows(windows, formulation);
  if (mechanism.name == "A03") return BuildAndrews(false);
  if (mechanism.name == "A03-IVP") return BuildAndrews(true);
  if (mechanism.name == "A04") return BuildBricard(formulation);
  return BuildGovernor();
}

double CpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

class Integration {
 public:
  Integration(MechanismSystem& mechanism, const MechanismOptions& options, const std::string& integrator)
      : mechanism_(mechanism), options_(options), integrator_(NewIntegrator(integrator, mechanism.system)) {
    integrator_->setAccuracy(options.accuracy);
    integrator_->setConstraintTolerance(options.accuracy);
    // Every sample is a step: what is compared is the integrator, not its interpolation.
    integrator_->setAllowInterpolation(false);
    integrator_->setInternalStepLimit(kStepsAtOnce);
  }

  Result<MechanismRun> Run(const std::vector<double>& times) {
    MechanismRun run;
    run.values.resize(static_cast<Eigen::Index>(times.size()), 0);
    const double begin = CpuSeconds();
    integrator_->initialize(mechanism_.state);
    mechanism_.system.realize(integrator_->getState(), SimTK::Stage::Dynamics);
    const double energy = EnergyLessWork();
    for (std::size_t i = 0; i < times.size(); ++i) {
      while (integrator_->getTime() < times[i]) {
        const auto status = integrator_->stepTo(times[i], times[i]);
        if (status == SimTK::Integrator::EndOfSimulation)
          return Fail("the integrator ended at t = {} s", integrator_->getTime());
        if (CpuSeconds() - begin > options_.longest_seconds)
          return Fail("stopped at t = {} s of {} s after {:.0f} s of CPU time", integrator_->getTime(),
                      times.back(), CpuSeconds() - begin);
      }
      Record(energy, static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(times.size()), run);
      if (!run.values.row(static_cast<Eigen::Index>(i)).allFinite())
        return Fail("the state is not finite at t = {} s", times[i]);
    }
    run.seconds = CpuSeconds() - begin;
    run.steps = integrator_->getNumStepsTaken();
    run.evaluations = integrator_->getNumRealizations();
    return run;
  }

 private:
  [[nodiscard]] double EnergyLessWork() const {
    const SimTK::State& state = integrator_->getState();
    return mechanism_.system.calcEnergy(state) - (mechanism_.work ? mechanism_.work(state) : 0);
  }

  void Record(double energy_at_start, Eigen::Index sample, Eigen::Index samples, MechanismRun& run) const {
    const SimTK::State& state = integrator_->getState();
    mechanism_.system.realize(state, SimTK::Stage::Dynamics);
    const Vector values = mechanism_.coordinates(state);
    if (run.values.cols() == 0) run.values.setZero(samples, values.size());
    run.values.row(sample) = values.transpose();
    run.energy_drift = std::max(run.energy_drift, std::abs(EnergyLessWork() - energy_at_start));
    run.kinetic_energy = std::max(run.kinetic_energy, mechanism_.system.calcKineticEnergy(state));
    if (state.getNQErr() > 0)
      run.position_violation = std::max(run.position_violation, state.getQErr().normInf());
    if (state.getNUErr() > 0)
      run.velocity_violation = std::max(run.velocity_violation, state.getUErr().normInf());
  }

  MechanismSystem& mechanism_;
  const MechanismOptions& options_;
  std::unique_ptr<SimTK::Integrator> integrator_;
};

}  // namespace

SimTK::MassProperties SlenderRod(double mass, const SimTK::Vec3& end) {
  const SimTK::Vec3 middle = end / 2;
  // m (|r|^2 1 - r r') / 12 about the middle.
  const double third = mass / 12;
  const SimTK::Inertia inertia(third * (end[1] * end[1] + end[2] * end[2]),
                               third * (end[0] * end[0] + end[2] * end[2]),
                               third * (end[0] * end[0] + end[1] * end[1]), -third * end[0] * end[1],
                               -third * end[0] * end[2], -third * end[1] * end[2]);
  return {mass, middle, inertia.shiftFromMassCenter(middle, mass)};
}

Status CheckMechanismOptions(const Mechanism& mechanism, const MechanismOptions& options) {
  SINEW_TRY(FormulationOf(mechanism, options.formulation));
  if (!options.integrator.empty()) SINEW_TRY(CheckIntegrator(options.integrator));
  if (!(options.accuracy >= 1e-14 && options.accuracy <= 0.1))
    return Fail("accuracy {}: expected 1e-14 .. 0.1", options.accuracy);
  if (!(options.longest_seconds > 0))
    return Fail("at most {} s of CPU time: expected a time above 0", options.longest_seconds);
  if (options.windows < 1 || options.windows > kMaxWindows)
    return Fail("{} windows: expected 1 .. {}", options.windows, kMaxWindows);
  return {};
}

Result<MechanismRun> SimulateMechanism(const Mechanism& mechanism, const MechanismOptions& options,
                                       const std::vector<double>& times) {
  SINEW_TRY(CheckMechanismOptions(mechanism, options));
  SINEW_ASSIGN(const std::string formulation, FormulationOf(mechanism, options.formulation));
  const std::string integrator =
      options.integrator.empty() ? IntegratorRegistry().front().name : options.integrator;
  if (times.empty() || times.front() < 0 || !std::is_sorted(times.begin(), times.end()))
    return Fail("{}: no times, or times that do not increase from 0 on", mechanism.name);
  const auto failed = [&](const std::string& why) {
    return Fail("{} with {} at accuracy {}: {}", mechanism.name, integrator, options.accuracy, why);
  };
  try {
    const auto built = Build(mechanism, formulation, options.windows);
    auto run = Integration(*built, options, integrator).Run(times);
    if (!run) return failed(run.error().message);
    return run;
  } catch (const std::exception& exception) {
    return failed(OneLine(exception.what()));
  }
}

}  // namespace sinew
