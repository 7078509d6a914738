#include "problems/emg_shape/settings.h"

#include <algorithm>

#include "base/text.h"
#include "base/yaml_choice.h"
#include "models/emg/shape_basis.h"

namespace sinew {
namespace {

Result<CycleSettings> ReadCycles(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"begins_at", "swing", "shortest", "duration_tolerance", "longest_gap"}));
  CycleSettings cycles;
  SINEW_ASSIGN(cycles.begins_at,
               ReadChoice<CycleBegin>(yaml, "begins_at",
                                      {{"highest", CycleBegin::kHighest}, {"lowest", CycleBegin::kLowest}}));
  SINEW_ASSIGN(cycles.swing, yaml.NumberOr("swing", cycles.swing, 0.05, 0.9));
  SINEW_ASSIGN(cycles.shortest_s, yaml.NumberOr("shortest", cycles.shortest_s, 0, 1e6));
  SINEW_ASSIGN(cycles.duration_tolerance,
               yaml.NumberOr("duration_tolerance", cycles.duration_tolerance, 1e-6, 1e6));
  SINEW_ASSIGN(cycles.longest_gap_s, yaml.NumberOr("longest_gap", cycles.longest_gap_s, 0, 1e6));
  return cycles;
}

Status ReadLaws(const YamlReader& yaml, EmgShapeSettings& settings) {
  if (!yaml.Has("laws")) return {};
  settings.amplitude_law = settings.lead_law = false;
  SINEW_ASSIGN(const YamlReader list, yaml.At("laws"));
  SINEW_ASSIGN(const auto laws, list.Texts());
  for (const std::string& law : laws) {
    if (law == "amplitude") {
      settings.amplitude_law = true;
    } else if (law == "lead") {
      settings.lead_law = true;
    } else {
      return FailAt(list.file(), list.line(), "laws: '{}'{}", law, Suggestion(law, {"amplitude", "lead"}));
    }
  }
  return {};
}

Result<EmgReference> ReadReference(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"speed", "period"}));
  for (const char* key : {"speed", "period"}) SINEW_TRY(yaml.At(key));
  EmgReference reference;
  SINEW_ASSIGN(reference.speed, yaml.NumberOr("speed", 1, 1e-6, 1e6));
  SINEW_ASSIGN(reference.period, yaml.NumberOr("period", 1, 1e-3, 1e6));
  return reference;
}

}  // namespace

Result<EmgShapeSettings> ReadEmgShapeSettings(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"angle", "muscles", "model", "cycles", "laws", "timing", "cycle_scatter",
                           "low_pass", "knots", "rate", "same_speed", "hold_out", "reference", "jitter"}));
  EmgShapeSettings settings;
  SINEW_ASSIGN(const YamlReader angle, yaml.At("angle"));
  SINEW_ASSIGN(settings.angle, angle.Text());
  if (yaml.Has("muscles")) {
    SINEW_ASSIGN(const YamlReader list, yaml.At("muscles"));
    SINEW_ASSIGN(settings.muscles, list.Texts());
    std::vector<std::string> sorted = settings.muscles;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end()) return FailAt(list.file(), list.line(), "muscles: '{}' comes twice", *twice);
    if (sorted.empty()) return FailAt(list.file(), list.line(), "muscles: none, expected at least one");
  }
  SINEW_ASSIGN(settings.model, ReadChoice<EmgShapeModel>(yaml, "model",
                                                         {{"shape", EmgShapeModel::kShape},
                                                          {"averaging", EmgShapeModel::kAveraging}}));
  if (yaml.Has("cycles")) {
    SINEW_ASSIGN(const YamlReader cycles, yaml.At("cycles"));
    SINEW_ASSIGN(settings.cycles, ReadCycles(cycles));
  }
  SINEW_TRY(ReadLaws(yaml, settings));
  SINEW_ASSIGN(settings.timing_per_muscle,
               ReadChoice<bool>(yaml, "timing", {{"per_muscle", true}, {"shared", false}}));
  SINEW_ASSIGN(settings.cycle_scatter,
               ReadChoice<bool>(yaml, "cycle_scatter", {{"true", true}, {"false", false}}));
  SINEW_ASSIGN(settings.low_pass, yaml.NumberOr("low_pass", settings.low_pass, 0, 1000));
  if (yaml.Has("knots")) {
    SINEW_ASSIGN(const double knots, yaml.NumberOr("knots", kMinKnots, kMinKnots, 200));
    if (knots != static_cast<int>(knots)) {
      SINEW_ASSIGN(const YamlReader value, yaml.At("knots"));
      return FailAt(value.file(), value.line(), "knots: {}, expected a whole number", knots);
    }
    settings.knots = static_cast<int>(knots);
  }
  SINEW_ASSIGN(settings.rate, yaml.NumberOr("rate", settings.rate, 1, 1000));
  SINEW_ASSIGN(settings.same_speed, yaml.NumberOr("same_speed", settings.same_speed, 0, 0.5));
  if (yaml.Has("hold_out")) {
    SINEW_ASSIGN(const YamlReader list, yaml.At("hold_out"));
    SINEW_ASSIGN(settings.hold_out, list.Texts());
  }
  if (yaml.Has("reference")) {
    SINEW_ASSIGN(const YamlReader reference, yaml.At("reference"));
    SINEW_ASSIGN(settings.reference, ReadReference(reference));
  }
  if (yaml.Has("jitter")) {
    SINEW_ASSIGN(const YamlReader jitter, yaml.At("jitter"));
    SINEW_ASSIGN(const auto muscles, jitter.Keys());
    for (const std::string& muscle : muscles) {
      SINEW_ASSIGN(settings.jitter[muscle], jitter.NumberOr(muscle, 0, 0, 0.25));
    }
  }
  return settings;
}

}  // namespace sinew
