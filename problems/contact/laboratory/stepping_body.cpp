#include "problems/contact/laboratory/stepping_body.h"

#include <fmt/format.h>

#include <cstdlib>

#include "problems/contact/laboratory/nao_like_osim.h"

namespace sinew {
namespace {

// What a settings file says of a body that steps.
struct BodySettings {
  std::string body;  // as comments call it
  std::string objective;
  std::string fit;   // channels
  std::string sole;  // position and mesh of each sole
  std::string parameters;
};

std::string SettingsText(const BodySettings& settings) {
  std::string regions;
  for (const std::string side : {"right", "left"}) {
    regions += fmt::format("    - name: {}_sole\n      body: calcn_{}\n      plate: {}\n{}", side, side[0],
                           side, settings.sole);
  }
  return fmt::format(
      R"(# How the contact problem sees this {}: one box per sole, both with the same parameters.
contact:
  model: model.osim
  floor_height: 0.0
  transition_velocity: 0.01
  objective: {}
  fit: [{}]
  regions:
{}  parameters:
{})",
      settings.body, settings.objective, settings.fit, regions, settings.parameters);
}

const BodySettings kRobotSettings{"robot", "thesis", "force_y",
                                  R"(      position: [0.02, -0.04519, 0.0]
      mesh: {box: {size: [0.16, 0.02, 0.09], strips: [12, 7]}}
)",
                                  R"(    stiffness: {lower: 1.0e4, upper: 1.0e7, start: 1.0e5}
    dissipation: {lower: 0, upper: 600, start: 10}
)"};

const BodySettings kPersonSettings{"body", "likelihood", "force_x, force_y, force_z, cop_x, cop_z, moment_y",
                                   R"(      position: [0.0325, -0.07343375, 0.0]
      mesh: {box: {size: [0.26, 0.0325, 0.14625], strips: [18, 10]}}
)",
                                   R"(    stiffness: {lower: 1.0e4, upper: 1.0e8, start: 1.0e6}
    dissipation: {lower: 0, upper: 100, start: 1}
)"};

const Vec3 kRobotSole(0.16, 0.02, 0.09);
const Vec3 kRobotSolePosition(0.02, -0.04519, 0);

// The text with every number between <element> and </element> multiplied.
std::string ScaleElement(const std::string& text, const std::string& element, double factor) {
  const std::string begin = "<" + element + ">";
  const std::string end = "</" + element + ">";
  std::string scaled;
  std::size_t at = 0;
  for (std::size_t found = text.find(begin); found != std::string::npos; found = text.find(begin, at)) {
    found += begin.size();
    scaled += text.substr(at, found - at);
    at = text.find(end, found);
    const char* number = text.c_str() + found;
    const char* const last = text.c_str() + at;
    for (const char* separator = ""; number < last; separator = " ") {
      char* next = nullptr;
      const double value = std::strtod(number, &next);
      if (next == number) break;
      scaled += fmt::format("{}{:.10g}", separator, factor * value);
      number = next;
    }
  }
  return scaled + text.substr(at);
}

}  // namespace

SteppingBody RobotThatSteps() {
  SteppingBody body;
  body.title = "a small humanoid robot stepping";
  body.subject = "robot with the proportions of NAO, 5.8 kg, 0.573 m";
  body.osim = kNaoLikeOsim;
  body.settings = SettingsText(kRobotSettings);
  body.sole_size = kRobotSole;
  body.sole_position = kRobotSolePosition;
  body.squares = {12, 7};
  return body;
}

SteppingBody PersonThatSteps() {
  constexpr double kSize = 1.625;
  constexpr double kMass = 70 / 5.8;
  SteppingBody body;
  body.title = "a body with the feet and the load of a person stepping";
  body.subject = "proportions of NAO, 70 kg, sole of 0.26 m";
  body.osim = kNaoLikeOsim;
  for (const char* length : {"mass_center", "translation", "location"})
    body.osim = ScaleElement(body.osim, length, kSize);
  body.osim = ScaleElement(body.osim, "mass", kMass);
  body.osim = ScaleElement(body.osim, "inertia", kMass * kSize * kSize);
  body.settings = SettingsText(kPersonSettings);
  body.size = kSize;
  body.step.size = kSize;
  body.step.depth = 0.010;
  body.step.walking_speed = 0.2;
  body.step.pelvis_height = 0.21;  // bent knees: the leg reaches where a recorded foot may be in error
  body.sole_size = kSize * kRobotSole;
  body.sole_position = kSize * kRobotSolePosition;
  body.squares = {18, 10};
  body.defaults = {{"stiffness", 1.9e6}, {"dissipation", 2.5}, {"force_noise", 3},
                   {"moments", 1},       {"cop_noise", 0.001}, {"moment_noise", 0.3}};
  return body;
}

}  // namespace sinew
