// One made-up person, fitted in steps: what every step finds, with the errors of what it holds, as JSON. For
// run.py.
//
// usage: ankle_steps SEED NAME=VALUE...   of `sinew data synthesize ankle_on_dynamometer --set`
#include <ctime>
#include <string>

#include "identify/identification/stepwise.h"
#include "problems/ankle_on_dynamometer/laboratory/synthesis.h"
#include "problems/ankle_on_dynamometer/problem.h"

namespace sinew {
namespace {

std::string Json(const std::string& name, const std::vector<Parameter>& parameters,
                 const Uncertainty& found) {
  std::string list;
  for (const ParameterVerdict& v : found.parameters) {
    const Parameter& p = parameters[static_cast<std::size_t>(v.parameter)];
    const auto error = [](double x) {
      return std::isfinite(x) ? fmt::format("{:.17g}", x) : std::string("null");
    };
    list += fmt::format(
        "{}\"{}\":{{\"value\":{:.17g},\"lower\":{:.17g},\"upper\":{:.17g},\"std_error\":{},\"std_error_"
        "robust\":{},"
        "\"ci95\":[{:.17g},{:.17g}],\"verdict\":\"{}\"}}",
        list.empty() ? "" : ",", p.name, v.value, p.lower, p.upper, error(v.std_error),
        error(v.std_error_robust), v.ci95_lower, v.ci95_upper, ToString(v.verdict));
  }
  return fmt::format("{{\"name\":\"{}\",\"parameters\":{{{}}}}}", name, list);
}

Status Run(int count, char** words) {
  if (count < 2) return Fail("usage: ankle_steps SEED NAME=VALUE...");
  SynthesisRequest request;
  request.seed = std::stoull(words[1]);
  for (int i = 2; i < count; ++i) {
    const std::string word = words[i];
    const auto sign = word.find('=');
    if (sign == std::string::npos) return Fail("'{}', expected NAME=VALUE", word);
    request.set[word.substr(0, sign)] = std::stod(word.substr(sign + 1));
  }
  SINEW_ASSIGN(const Dataset data, SynthesizeAnkle(request));
  SINEW_ASSIGN(const YamlReader yaml,
               YamlReader::Parse(data.files.at("ankle_on_dynamometer.yaml"), "ankle_on_dynamometer.yaml"));
  SINEW_ASSIGN(const YamlReader section, yaml.At("ankle_on_dynamometer"));
  SINEW_ASSIGN(AnkleSettings settings, ReadAnkleSettings(section));
  SINEW_ASSIGN(const auto problem, AnkleProblem::Make(data, std::move(settings)));
  IdentificationOptions options;
  options.solver = "lm";
  options.profiles = false;
  options.evaluator.budget.max_evaluations = 500;
  const std::clock_t begun = std::clock();
  SINEW_ASSIGN(const Identification fit, IdentifyStepwise(*problem, {}, options));
  const double seconds = static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  std::string steps;
  for (const FinishedStep& step : fit.steps)
    steps += Json(step.name, problem->parameters(), step.uncertainty) + ",";
  fmt::print("{{\"core_seconds\":{:.3f},\"cost\":{:.17g},\"steps\":[{}{}]}}\n", seconds, fit.result.cost,
             steps, Json("all levels", problem->parameters(), fit.uncertainty));
  return {};
}

}  // namespace
}  // namespace sinew

int main(int count, char** words) {
  const sinew::Status status = sinew::Run(count, words);
  if (!status) fmt::print(stderr, "{}\n", status.error().message);
  return status ? 0 : 2;
}
