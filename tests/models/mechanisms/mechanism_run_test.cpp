#include "models/mechanisms/mechanism_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "models/mechanisms/integrator.h"
#include "models/mechanisms/mechanism_error.h"

namespace sinew {
namespace {

struct Case {
  MechanismRun run;
  MechanismError error;
};

Case Simulated(const std::string& name, const MechanismOptions& options, double until = 1e9) {
  const Mechanism mechanism = *FindMechanism(name);
  MechanismReference reference = BuiltInReference(mechanism, options.windows);
  for (ReferenceCurve& curve : reference.curves) {
    while (curve.time.back() > until) {
      curve.time.pop_back();
      curve.values.pop_back();
    }
  }
  const std::vector<double> times = TimesOf(reference);
  auto run = SimulateMechanism(mechanism, options, times);
  EXPECT_TRUE(run) << run.error().message;
  if (!run) return {};
  const MechanismError error = ErrorOf(mechanism, *run, times, reference);
  return {std::move(*run), error};
}

MechanismOptions At(double accuracy, const std::string& integrator = "",
                    const std::string& formulation = "") {
  MechanismOptions options;
  options.accuracy = accuracy;
  options.integrator = integrator;
  options.formulation = formulation;
  return options;
}

// A tenth of the total errors of the thesis, table 8.
TEST(Mechanisms, AreTenTimesBetterThanTheThesis) {
  EXPECT_LT(Simulated("A01", At(1e-9)).error.total, 3.6e-6);
  EXPECT_LT(Simulated("A02", At(1e-10)).error.total, 9.8e-7);
  EXPECT_LT(Simulated("A03", At(1e-9)).error.total, 4.7e-5);
  EXPECT_LT(Simulated("A04", At(1e-10), 5).error.total, 6.4e-7);
  EXPECT_LT(Simulated("A05", At(1e-9), 3).error.total, 7.3e-8);
}

TEST(Mechanisms, AndrewsAnglesAreThoseOfTheTestSet) {
  const Case one = Simulated("A03-IVP", At(1e-10));
  ASSERT_EQ(one.error.peak.size(), 7U);
  for (const double off : one.error.peak) EXPECT_LT(off, 1e-6);
}

TEST(Mechanisms, KeepEnergyAndConstraints) {
  for (const char* name : {"A01", "A02", "A03", "A04", "A05"}) {
    const Case rough = Simulated(name, At(1e-5), 2);
    const Case fine = Simulated(name, At(1e-8), 2);
    EXPECT_LT(fine.run.energy_drift, 1e-5 * fine.run.kinetic_energy) << name;
    EXPECT_LT(fine.run.energy_drift, rough.run.energy_drift) << name;
    EXPECT_LE(fine.run.position_violation, 1e-7) << name;
    EXPECT_GT(fine.run.kinetic_energy, 0) << name;
    EXPECT_GT(fine.run.steps, rough.run.steps) << name;
  }
}

// Three windows, whose links lie flat for the first time at about a second.
TEST(Mechanisms, FormulationsOfTheWindowsAgree) {
  for (const char* formulation : {"merged", "couplers"}) {
    MechanismOptions options = At(1e-8, "", formulation);
    options.windows = 3;
    EXPECT_LT(Simulated("A02", options, 5).error.total, 1e-3) << formulation;
  }
}

TEST(Mechanisms, FormulationsOfBricardAgree) {
  const Case end = Simulated("A04", At(1e-9, "", "end"), 3);
  const Case middle = Simulated("A04", At(1e-9, "", "middle"), 3);
  EXPECT_LT((end.run.values - middle.run.values).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Mechanisms, EveryIntegratorConvergesWithAccuracy) {
  for (const IntegratorEntry& entry : IntegratorRegistry()) {
    const double rough = Simulated("A01", At(1e-2, entry.name), 1).error.total;
    const double fine = Simulated("A01", At(1e-7, entry.name), 1).error.total;
    EXPECT_LT(fine, rough) << entry.name;
    EXPECT_LT(fine, 0.01) << entry.name;
  }
}

TEST(Mechanisms, ErrorsNameTheCause) {
  const Mechanism windows = *FindMechanism("A02");
  const auto message = [](const auto& result) { return result ? std::string() : result.error().message; };
  EXPECT_NE(message(FindMechanism("A1")).find("mechanism 'A1' does not exist"), std::string::npos);
  EXPECT_NE(message(SimulateMechanism(windows, At(1e-6, "euler"), {0, 1}))
                .find("integrator 'euler' does not exist"),
            std::string::npos);
  EXPECT_NE(message(SimulateMechanism(windows, At(1e-6, "", "loop"), {0, 1})).find("did you mean 'loops'"),
            std::string::npos);
  EXPECT_NE(message(SimulateMechanism(windows, At(1), {0, 1})).find("expected 1e-14 .. 0.1"),
            std::string::npos);
  EXPECT_NE(message(SimulateMechanism(windows, At(std::nan("")), {0, 1})).find("expected"),
            std::string::npos);
  EXPECT_FALSE(SimulateMechanism(windows, At(1e-6), {}));
  EXPECT_FALSE(SimulateMechanism(windows, At(1e-6), {1, 0}));
  MechanismOptions none = At(1e-6);
  none.windows = 0;
  EXPECT_FALSE(SimulateMechanism(windows, none, {0, 1}));
}

TEST(Mechanisms, EndInTime) {
  MechanismOptions options = At(1e-13, "semi_explicit_euler2");
  options.longest_seconds = 0.2;
  const auto run = SimulateMechanism(*FindMechanism("A01"), options, {0, 10});
  ASSERT_FALSE(run);
  EXPECT_NE(run.error().message.find("stopped at t ="), std::string::npos) << run.error().message;
}

}  // namespace
}  // namespace sinew
