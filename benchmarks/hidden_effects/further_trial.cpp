#include "benchmarks/hidden_effects/further_trial.h"

#include "base/random.h"
#include "problems/drive/laboratory/excitation.h"

namespace sinew {
namespace {

constexpr double kSharper = 10;  // sampling rate of sharp trials, of the plan's

Result<DriveTrial> Draw(const DrivePlan& plan, const std::string& kind, Random& random) {
  const DriveTrial& own = plan.trials.front();
  const double duration = static_cast<double>(own.command.size() - 1) / own.rate;
  if (kind == "rest") return DrawRest(duration, own.rate, random);
  if (kind == "creep") return DrawCreep(plan.truth, duration, own.rate, random);
  if (kind == "hold") return DrawHold(plan.truth, duration, own.rate, random);
  if (kind == "fast") return DrawFast(plan.truth, duration, own.rate, random);
  if (kind == "sharp") return DrawSharp(plan.truth, duration, kSharper * own.rate, random);
  if (own.control == DriveControl::kTracking) return DrawTrapezoid(plan.truth, duration, own.rate, random);
  return DrawMultiSine(plan.truth, duration, own.rate, random);
}

}  // namespace

const std::vector<std::string>& FurtherKinds() {
  static const std::vector<std::string> kinds{"same", "rest", "creep", "hold", "fast", "sharp"};
  return kinds;
}

Result<DrivePlan> PlanFurther(const DrivePlan& plan, const std::vector<std::string>& kinds,
                              std::uint64_t seed) {
  DrivePlan further = plan;
  further.trials.clear();
  further.train = kinds.size();
  further.seed = seed;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    Random random(Random::StreamSeed(seed, i));
    SINEW_ASSIGN(DriveTrial trial, Draw(plan, kinds[i], random));
    trial.command_scale = plan.trials.front().command_scale;
    further.trials.push_back(std::move(trial));
  }
  return further;
}

}  // namespace sinew
