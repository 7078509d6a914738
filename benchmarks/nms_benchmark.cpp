// A minute of a leg: 11 muscles and two joints at 1 kHz, predicted, and with the derivatives for 50
// parameters.
#include <benchmark/benchmark.h>

#include <cmath>

#include "problems/ankle_study/study.h"
#include "problems/nms/problem.h"

namespace sinew {
namespace {

constexpr int kMuscles = 11;
constexpr double kSeconds = 60;
constexpr double kRate = 1000;

std::string NameOf(int muscle) {
  return fmt::format("muscle_{}", muscle);
}

// The study's subject with eleven muscles: those beyond seven begin again.
std::string SubjectXml() {
  std::string text = StudySubjectXml();
  const std::string head = text.substr(0, text.find("  <mtuSet>"));
  std::string muscles;
  std::string names;
  for (int m = 0; m < kMuscles; ++m) {
    const StudyMuscle& like = StudyMuscles()[static_cast<std::size_t>(m % kStudyMuscles)];
    muscles += fmt::format(
        "<mtu><name>{}</name><c1>-0.7</c1><c2>-0.7</c2><shapeFactor>-0.5</shapeFactor>"
        "<optimalFibreLength>{}</optimalFibreLength><pennationAngle>{}</pennationAngle>"
        "<tendonSlackLength>{}</tendonSlackLength><maxIsometricForce>{}</maxIsometricForce>"
        "<strengthCoefficient>1</strengthCoefficient></mtu>",
        NameOf(m), like.optimal_length, like.pennation, like.slack_length, like.isometric_force);
    names += " " + NameOf(m);
  }
  return head + "<mtuSet>" + muscles + "</mtuSet><dofSet><dof><name>knee</name><mtuNameSet>" + names +
         "</mtuNameSet></dof><dof><name>ankle</name><mtuNameSet>" + names +
         "</mtuNameSet></dof></dofSet></subject>\n";
}

Dataset Minute() {
  Dataset data;
  data.files["subject.xml"] = SubjectXml();
  Trial& trial = data.trials["minute"];
  const auto frames = static_cast<std::size_t>(kSeconds * kRate) + 1;
  std::vector<double> time;
  for (std::size_t i = 0; i < frames; ++i) time.push_back(static_cast<double>(i) / kRate);
  for (const char* grid : {"excitations", "lengths", "moment_arms.knee", "moment_arms.ankle", "moments"})
    trial.grids[grid].time = time;
  for (int m = 0; m < kMuscles; ++m) {
    const StudyMuscle& like = StudyMuscles()[static_cast<std::size_t>(m % kStudyMuscles)];
    Channel e{"1", ChannelKind::kInput, {}, {}};
    Channel length{"m", ChannelKind::kInput, {}, {}};
    Channel arm{"m", ChannelKind::kInput, {}, {}};
    for (const double t : time) {
      const double angle = 0.3 * std::sin(5 * t + 0.1 * m);
      e.values.push_back(0.05 + 0.5 * std::pow(std::sin(2.5 * t + 0.3 * m), 4));
      length.values.push_back(UnitLength(like, angle));
      arm.values.push_back(MomentArm(like, angle));
    }
    trial.grids["excitations"].channels[NameOf(m)] = std::move(e);
    trial.grids["lengths"].channels[NameOf(m)] = std::move(length);
    trial.grids["moment_arms.knee"].channels[NameOf(m)] = arm;
    trial.grids["moment_arms.ankle"].channels[NameOf(m)] = std::move(arm);
  }
  for (const char* joint : {"knee", "ankle"}) {
    Channel moment{"N*m", ChannelKind::kMeasured, {}, {}};
    for (const double t : time) moment.values.push_back(20 * std::sin(5 * t));
    trial.grids["moments"].channels[std::string(joint) + "_moment"] = std::move(moment);
  }
  return data;
}

// Four parameters per muscle, and six groups of strengths: 50.
std::unique_ptr<NmsProblem> Leg(const std::string& tendon) {
  std::string groups;
  for (int g = 0; g < 6; ++g) {
    std::string members;
    for (int m = g; m < kMuscles; m += 6) members += (members.empty() ? "" : ", ") + NameOf(m);
    groups += fmt::format("{}group_{}: [{}]", g > 0 ? ", " : "", g, members);
  }
  const std::string text = fmt::format(
      "nms:\n  subject: subject.xml\n  tendon: {}\n  parameters:\n"
      "    filter_mean: {{share: single, lower: 0.005, upper: 0.2}}\n"
      "    filter_spread: {{share: single, lower: 0, upper: 0.8}}\n"
      "    shape: {{share: single, lower: -3, upper: 0}}\n"
      "    tendon_slack_length: {{share: single, lower: 0.85, upper: 1.15, relative: true}}\n"
      "    strength: {{groups: {{{}}}, lower: 0.5, upper: 2.5}}\n",
      tendon, groups);
  const Dataset data = Minute();
  auto yaml = YamlReader::Parse(text, "nms.yaml");
  auto settings = ReadNmsSettings(yaml->At("nms").value(), data.files);
  return std::move(NmsProblem::Make(data, std::move(settings.value())).value());
}

void Minutes(benchmark::State& state, const std::string& tendon, bool derivatives) {
  const auto problem = Leg(tendon);
  const Vector at = RestPoint(*problem);
  std::vector<bool> base;
  for (const Parameter& p : problem->parameters()) base.push_back(p.kind == ParameterKind::kBase);
  Prediction prediction(problem->layout());
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  for (auto _ : state) {
    if (!problem->Predict({at, all, derivatives, &base}, *workspace, prediction))
      state.SkipWithError("no prediction");
  }
  state.counters["parameters"] = static_cast<double>(std::count(base.begin(), base.end(), true));
  state.counters["muscle steps/s"] =
      benchmark::Counter(kMuscles * kSeconds * kRate, benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK_CAPTURE(Minutes, rigid, "rigid", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Minutes, rigid_with_jacobian, "rigid", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Minutes, elastic, "elastic", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Minutes, elastic_with_jacobian, "elastic", true)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew
