// How long one evaluation of a two-foot stance takes: 32 instants per foot, 212 faces per sole, by the fast
// path for more and more of the wrench, with and without Jacobian, and by Simbody's own force.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "models/contact/simbody_contact.h"
#include "problems/contact/laboratory/synthesis.h"
#include "problems/contact/problem.h"

namespace sinew {
namespace {

constexpr const char* kSettings = R"(
regions:
  - {name: right_sole, body: calcn_r, plate: right, position: [0.02, -0.04519, 0.0], springs: all,
     mesh: {box: {size: [0.16, 0.02, 0.09], strips: [8, 5]}}}
  - {name: left_sole, body: calcn_l, plate: left, position: [0.02, -0.04519, 0.0], springs: all,
     mesh: {box: {size: [0.16, 0.02, 0.09], strips: [8, 5]}}}
)";

std::unique_ptr<ContactProblem> TwoFootStance() {
  SynthesisRequest request;
  request.set = {{"train", 2}, {"validate", 0}, {"encoders", 1}};
  const auto data = SynthesizeContact(request);
  const auto yaml = YamlReader::Parse(kSettings, "benchmark");
  return *ContactProblem::Make(*data, *ReadContactSettings(*yaml, {}));
}

// @param channels how many of kContactChannels are wanted: 0 for force_y alone, 3 for the force, 6 for all.
// @param effects derivatives for the contact effects too, which need the path face by face.
void Evaluate(benchmark::State& state, int channels, bool derivatives, bool effects = false) {
  const auto problem = TwoFootStance();
  const Layout& layout = problem->layout();
  std::vector<bool> wanted(layout.size(), false);
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const std::size_t kind = b % kContactChannels.size();
    wanted[b] = channels == 0 ? kContactChannels[kind] == "force_y" : static_cast<int>(kind) < channels;
  }
  const auto workspace = problem->NewWorkspace();
  Prediction prediction(layout);
  const Vector parameters = RestPoint(*problem);
  std::vector<bool> differentiate;
  for (const Parameter& p : problem->parameters())
    differentiate.push_back(effects || p.kind == ParameterKind::kBase);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        problem->Predict({parameters, wanted, derivatives, &differentiate}, *workspace, prediction));
  }
  int faces = 0;
  for (const auto& region : problem->settings().regions) faces += region.region.mesh.face_count();
  state.counters["faces"] = faces;
  state.counters["instants"] = static_cast<double>(problem->data().stances.front().time.size());
}

BENCHMARK_CAPTURE(Evaluate, vertical_force, 0, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, vertical_force_with_jacobian, 0, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, full_force, 3, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, full_force_with_jacobian, 3, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, force_moment_and_centre, 6, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, force_moment_and_centre_with_jacobian, 6, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Evaluate, all_with_jacobian_of_effects, 6, true, true)->Unit(benchmark::kMicrosecond);

// One stance of a person with everything free: 31 frames, 180 springs, six channels, five parameters of the
// contact and the deviations of the foot's pose (10 Hz).
void EvaluateWithMotionErrors(benchmark::State& state, bool derivatives) {
  SynthesisRequest request;
  request.set = {{"person", 1},           {"train", 1},
                 {"validate", 0},         {"encoders", 1},
                 {"motion_error", 0.005}, {"rotation_error", 0.0262}};
  const auto data = SynthesizeContact(request);
  std::string text = data->files.at("contact.yaml");
  text.insert(text.find("  regions:"), "  motion_errors: {position: 0.005, rotation: 0.0262}\n");
  const auto yaml = YamlReader::Parse(text, "benchmark");
  const auto problem = *ContactProblem::Make(*data, *ReadContactSettings(*yaml->At("contact"), {}));
  const std::vector<bool> all(problem->layout().size(), true);
  const auto workspace = problem->NewWorkspace();
  Prediction prediction(problem->layout());
  const Vector parameters = RestPoint(*problem);
  std::vector<bool> differentiate;
  for (const Parameter& p : problem->parameters()) differentiate.push_back(p.kind != ParameterKind::kEffect);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        problem->Predict({parameters, all, derivatives, &differentiate}, *workspace, prediction));
  }
  state.counters["parameters"] =
      static_cast<double>(std::count(differentiate.begin(), differentiate.end(), true));
  state.counters["instants"] = static_cast<double>(problem->data().stances.front().time.size());
}

BENCHMARK_CAPTURE(EvaluateWithMotionErrors, value, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(EvaluateWithMotionErrors, with_jacobian, true)->Unit(benchmark::kMicrosecond);

// The same stance by Simbody: its parameters belong to the topology, so every evaluation builds the system
// anew.
void SimbodyForce(benchmark::State& state) {
  const auto problem = TwoFootStance();
  std::vector<ContactRegion> regions;
  std::vector<ElasticFoundation> parameters;
  for (const auto& region : problem->settings().regions) {
    regions.push_back(region.region);
    parameters.push_back(ContactProblem::Foundation(RestPoint(*problem), 0));
  }
  // The soles rest flat at the depth of mid-stance: as many faces touch as in the stance itself.
  BodyMotion flat;
  flat.position = Vec3(0, 0.04519 - 0.0045, 0);
  const std::vector<BodyMotion> motion(regions.size(), flat);
  for (auto _ : state) {
    SimbodyContact contact(regions, parameters, 0.01, 0);
    for (int instant = 0; instant < 32; ++instant) benchmark::DoNotOptimize(contact.WrenchesAt(motion));
  }
}
BENCHMARK(SimbodyForce)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sinew
