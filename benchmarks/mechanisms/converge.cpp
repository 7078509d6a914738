// Writes models/mechanisms/converged_curves.cpp: the motions of A03, A04 and A05 by rk_feldberg, converged
// with respect to accuracy, and their differences to rk_merson (the default) and cpodes_bdf. Takes minutes.
#include <algorithm>
#include <cstdio>

#include "models/mechanisms/mechanism_run.h"

namespace {

struct Recipe {
  const char* name;
  double accuracy;  // of rk_merson and rk_feldberg
  double implicit;  // of cpodes_bdf, which goes no farther
};

constexpr int kSamples = 101;

double Farthest(const sinew::Matrix& a, const sinew::Matrix& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

bool Write(const Recipe& recipe) {
  const sinew::Mechanism mechanism = *sinew::FindMechanism(recipe.name);
  std::vector<double> times;
  for (int i = 0; i < kSamples; ++i) times.push_back(mechanism.duration * i / (kSamples - 1));
  sinew::MechanismOptions options;
  options.longest_seconds = 3600;
  const auto run = [&](const char* integrator, double accuracy) {
    options.integrator = integrator;
    options.accuracy = accuracy;
    return sinew::SimulateMechanism(mechanism, options, times);
  };
  const auto merson = run("rk_merson", recipe.accuracy);
  const auto feldberg = run("rk_feldberg", recipe.accuracy);
  const auto implicit = run("cpodes_bdf", recipe.implicit);
  for (const auto* one : {&merson, &feldberg, &implicit}) {
    if (*one) continue;
    std::fprintf(stderr, "%s\n", one->error().message.c_str());
    return false;
  }
  const double explicit_off = Farthest(merson->values, feldberg->values);
  const double implicit_off = Farthest(feldberg->values, implicit->values);
  std::printf(
      "      {\"%s\",\n       {\"rk_feldberg at accuracy %g; rk_merson at %g differs by %.1e %s at most, \"\n"
      "        \"cpodes_bdf at %g by %.1e %s\",\n        %.1e,\n        %g,\n        %d,\n        {",
      recipe.name, recipe.accuracy, recipe.accuracy, explicit_off, mechanism.unit.c_str(), recipe.implicit,
      implicit_off, mechanism.unit.c_str(), explicit_off, mechanism.duration,
      static_cast<int>(feldberg->values.cols()));
  for (Eigen::Index i = 0; i < feldberg->values.rows(); ++i) {
    for (Eigen::Index j = 0; j < feldberg->values.cols(); ++j)
      std::printf("%s%.13g", i + j > 0 ? (j == 0 && i % 2 == 0 ? ",\n         " : ", ") : "",
                  feldberg->values(i, j));
  }
  std::printf("}}}");
  return true;
}

}  // namespace

int main() {
  std::printf(
      "// Written by benchmarks/mechanisms/converge.cpp.\n// clang-format off\n"
      "#include \"models/mechanisms/converged_curves.h\"\n\n#include <map>\n\nnamespace sinew {\n\n"
      "const ConvergedCurves* FindConvergedCurves(const std::string& name) {\n"
      "  static const std::map<std::string, ConvergedCurves> curves{\n");
  bool first = true;
  for (const Recipe& recipe :
       {Recipe{"A03", 1e-13, 1e-11}, Recipe{"A04", 1e-13, 1e-9}, Recipe{"A05", 1e-12, 1e-11}}) {
    if (!first) std::printf(",\n");
    first = false;
    if (!Write(recipe)) return 1;
    std::fflush(stdout);
  }
  std::printf(
      "};\n  const auto found = curves.find(name);\n"
      "  return found == curves.end() ? nullptr : &found->second;\n}\n\n}  // namespace sinew\n");
  return 0;
}
