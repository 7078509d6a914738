// One person's model: five muscles at six speeds, nine cycles each.
#include <benchmark/benchmark.h>

#include "identify/execution/evaluator.h"
#include "identify/fit_setup.h"
#include "identify/solvers/solver.h"
#include "problems/ankle_study/emg_shape_synthesis.h"
#include "problems/emg_shape/problem.h"

namespace sinew {
namespace {

const Dataset& Person() {
  static const Dataset data = [] {
    SynthesisRequest request;
    request.seed = 1;
    request.set = {{"raw", 0}, {"moments", 0}};
    return SynthesizeEmgShape(request).value();
  }();
  return data;
}

std::unique_ptr<EmgShapeProblem> Bind() {
  const auto& text = Person().files.at("emg_shape.yaml");
  const auto yaml = YamlReader::Parse(text, "emg_shape.yaml").value();
  return EmgShapeProblem::Make(Person(), ReadEmgShapeSettings(yaml.At("emg_shape").value()).value()).value();
}

void Prepare(benchmark::State& state) {
  Person();
  for (auto _ : state) benchmark::DoNotOptimize(Bind());
}

void Predict(benchmark::State& state, bool derivatives) {
  const auto problem = Bind();
  const std::vector<bool> all(problem->layout().size(), true);
  Vector start(static_cast<Eigen::Index>(problem->parameters().size()));
  for (Eigen::Index i = 0; i < start.size(); ++i)
    start[i] = problem->parameters()[static_cast<std::size_t>(i)].start;
  Prediction prediction(problem->layout());
  const auto workspace = problem->NewWorkspace();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        problem->Predict({start, all, derivatives, nullptr}, *workspace, prediction).has_value());
  state.counters["parameters"] = static_cast<double>(start.size());
}

void Fit(benchmark::State& state) {
  const auto problem = Bind();
  const FitSetup setup = MakeFitSetup(*problem, {}).value();
  const LeastSquares fit(*problem, setup);
  const auto solver = MakeSolver("lm", {}).value();
  for (auto _ : state) {
    Evaluator evaluator(fit, {});
    const SolverResult result = solver->Solve(evaluator, fit.Start());
    if (!result.stop.converged()) state.SkipWithError("did not converge");
    state.counters["evaluations"] = static_cast<double>(evaluator.evaluations());
  }
  state.counters["free"] = static_cast<double>(setup.free.size());
}

BENCHMARK(Prepare)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Predict, plain, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Predict, with_derivatives, true)->Unit(benchmark::kMillisecond);
BENCHMARK(Fit)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sinew
