// Frames per second of the modes that find excitations, on one core: 121 frames, 11 muscles, knee and ankle
// (CEINMS takes 1.6 s for them by annealing). The muscles are synthetic, with the strengths and lengths of
// CEINMS's example and otherwise equal.
#include <benchmark/benchmark.h>

#include <cmath>

#include "identify/fit_setup.h"
#include "problems/nms/excitation/search.h"

namespace sinew {
namespace {

struct Made {
  const char* name;
  double isometric_force;  // [N]
  double optimal_length;   // [m]
  double slack_length;     // [m]
  double knee;             // moment arm [m]
  double ankle;            // [m]
};
constexpr Made kMuscles[] = {
    {"rect_fem", 1169, 0.114, 0.31, 0.04, 0},     {"vas_int", 1365, 0.107, 0.116, 0.04, 0},
    {"vas_lat", 1871, 0.104, 0.137, 0.04, 0},     {"vas_med", 1294, 0.109, 0.106, 0.04, 0},
    {"bifemlh", 896, 0.109, 0.326, -0.03, 0},     {"semimem", 1288, 0.08, 0.359, -0.035, 0},
    {"bifemsh", 804, 0.173, 0.089, -0.03, 0},     {"med_gas", 1558, 0.09, 0.36, -0.02, -0.045},
    {"lat_gas", 683, 0.064, 0.38, -0.02, -0.045}, {"soleus", 3549, 0.05, 0.25, 0, -0.045},
    {"tib_ant", 905, 0.098, 0.223, 0, 0.04}};
constexpr int kFrames = 121;
constexpr double kStep = 0.01;  // [s]

double Phase(int frame) {
  return 2 * M_PI * frame / kFrames;
}

Subject MakeSubject() {
  Subject subject;
  subject.curves[kActiveForceLength] = {{0, 0.4, 0.7, 1, 1.3, 1.6, 2}, {0, 0, 0.8, 1, 0.7, 0, 0}};
  subject.curves[kPassiveForceLength] = {{0, 1, 1.2, 1.4, 1.6}, {0, 0, 0.08, 0.35, 1}};
  subject.curves[kForceVelocity] = {{-10, -1, -0.5, 0, 0.5, 1, 10}, {0, 0, 0.3, 1, 1.4, 1.5, 1.5}};
  subject.curves[kTendonForceStrain] = {{0, 0.01, 0.02, 0.04, 0.06, 0.1}, {0, 0.1, 0.35, 1.1, 1.8, 3.2}};
  subject.dofs = {{"knee", {}}, {"ankle", {}}};
  for (const Made& made : kMuscles) {
    SubjectMuscle muscle;
    muscle.name = made.name;
    muscle.shape_factor = -1.5;
    muscle.delay = 0.015;
    muscle.optimal_fibre_length = made.optimal_length;
    muscle.tendon_slack_length = made.slack_length;
    muscle.maximal_isometric_force = made.isometric_force;
    subject.muscles.push_back(muscle);
    if (made.knee != 0) subject.dofs[0].second.emplace_back(made.name);
    if (made.ankle != 0) subject.dofs[1].second.emplace_back(made.name);
  }
  return subject;
}

Dataset MakeData() {
  Dataset data;
  Trial& trial = data.trials["stride"];
  const auto add = [&](const std::string& grid, const std::string& channel, const char* unit,
                       const std::function<double(int)>& value) {
    trial.grids[grid].time.clear();
    Channel& made = trial.grids[grid].channels[channel];
    made.unit = unit;
    for (int i = 0; i < kFrames; ++i) {
      trial.grids[grid].time.push_back(kStep * i);
      made.values.push_back(value(i));
    }
  };
  int place = 0;
  for (const Made& made : kMuscles) {
    const double offset = ++place;
    add("excitations", made.name, "1",
        [&](int i) { return 0.05 + 0.4 * std::pow(std::sin(0.5 * Phase(i) + offset), 4); });
    add("lengths", made.name, "m", [&](int i) {
      return made.slack_length + made.optimal_length - 0.3 * made.knee * std::sin(Phase(i)) -
             0.2 * made.ankle * std::cos(Phase(i));
    });
    add("moment_arms.knee", made.name, "m", [&](int) { return made.knee; });
    add("moment_arms.ankle", made.name, "m", [&](int) { return made.ankle; });
  }
  add("moments", "knee_moment", "N*m", [](int i) { return 10 + 30 * std::sin(Phase(i)); });
  add("moments", "ankle_moment", "N*m", [](int i) { return -40 + 40 * std::cos(2 * Phase(i)); });
  return data;
}

void Find(benchmark::State& state, TendonMode tendon, NmsModeType type) {
  const Dataset data = MakeData();
  NmsSettings settings;
  settings.subject = MakeSubject();
  settings.joints = {"knee", "ankle"};
  settings.model.tendon = tendon;
  NmsParameterSetting strength;
  strength.group = strength.muscles.emplace_back("soleus");
  strength.lower = 0.5;
  strength.upper = 2;
  settings.parameters.push_back(strength);
  settings.mode.type = type;
  if (type == NmsModeType::kAssisted) settings.mode.synthesise = {"bifemsh"};
  const auto free =
      ChooseFreeMuscles(settings.mode, MusclesOf(settings.subject, settings.joints), settings.subject, data);
  if (!free) return state.SkipWithError(free.error().message.c_str());
  const auto problem = NmsProblem::Make(data, settings, free->synthesised);
  if (!problem) return state.SkipWithError(problem.error().message.c_str());
  const Vector parameters = MakeFitSetup(**problem, {})->rest;
  for (auto _ : state) {
    const auto found = FindExcitations(**problem, parameters, settings.mode, *free);
    if (!found) return state.SkipWithError(found.error().message.c_str());
    benchmark::DoNotOptimize(found->data());
  }
  state.counters["frames_per_s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kFrames, benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(Find, rigid_assisted, TendonMode::kRigid, NmsModeType::kAssisted)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Find, rigid_optimised, TendonMode::kRigid, NmsModeType::kOptimised)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Find, elastic_assisted, TendonMode::kElastic, NmsModeType::kAssisted)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew
