#include "cli/data/soles_text.h"

#include <algorithm>

#include "base/constants.h"
#include "base/numbers.h"
#include "base/text.h"
#include "cli/terminal.h"
#include "problems/contact/settings.h"

namespace sinew {
namespace {

constexpr double kDegrees = 180 / kPi;

// A sentence as comment lines.
std::string Comment(const std::string& sentence, int indent) {
  constexpr int kWidth = 118;
  const std::string blanks(static_cast<std::size_t>(indent), ' ');
  std::string lines;
  const std::string wrapped = Wrapped(sentence, 0, kWidth - indent - 2);
  for (const auto line : Split(wrapped, '\n')) {
    if (!Trim(line).empty()) lines += fmt::format("{}# {}\n", blanks, Trim(line));
  }
  return lines;
}

// For plain YAML scalars of names that a laboratory chose.
std::string Quoted(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

std::string Mm(double metres) {
  return fmt::format("{:.1f}", 1e3 * metres);
}

std::string SourceOf(const ProposedFoot& foot) {
  const std::string stances = Join(foot.estimate.trials, ", ");
  switch (foot.source) {
    case SoleSource::kOwn:
      return fmt::format(
          "from its own stances ({}){}", stances,
          foot.differs_angle == 0
              ? ""
              : fmt::format(
                    "; not averaged with '{}' mirrored, whose plane differs by {:.1f} degrees and {} mm",
                    foot.other, foot.differs_angle * kDegrees, Mm(foot.differs_height)));
    case SoleSource::kBoth:
      return fmt::format("mean of this foot ({}) and '{}' mirrored", stances, foot.other);
    case SoleSource::kNoPlate:
      return fmt::format("no plate measures it: '{}' ({}) mirrored; `sinew data steps` finds its steps",
                         foot.other, stances);
    case SoleSource::kOther:
      return fmt::format("no training stance of its own: '{}' ({}) mirrored", foot.other, stances);
  }
  return "";
}

const char* SourceName(SoleSource source) {
  switch (source) {
    case SoleSource::kOwn:
      return "own";
    case SoleSource::kBoth:
      return "both";
    case SoleSource::kOther:
      return "other";
    case SoleSource::kNoPlate:
      return "no_plate";
  }
  return "";
}

const char* EndText(SoleEnd end) {
  switch (end) {
    case SoleEnd::kMarker:
      return "marker";
    case SoleEnd::kCop:
      return "centre_of_pressure";
    case SoleEnd::kRatio:
      return "proportion";
  }
  return "";
}

const char* WidthText(SoleWidth width) {
  switch (width) {
    case SoleWidth::kMarkers:
      return "markers";
    case SoleWidth::kRatio:
      return "proportion";
    case SoleWidth::kCop:
      return "centre_of_pressure";
  }
  return "";
}

std::string HeelText(const FootEstimate& foot) {
  return foot.heel_from == SoleEnd::kMarker
             ? fmt::format("heel end {} mm in front of the hindmost marker (its radius and base)",
                           Mm(SoleRules::kMarkerStandOff))
             : fmt::format("heel end {} mm behind the hindmost 5 % of the centre of pressure",
                           Mm(SoleRules::kBeyondCop));
}

std::string TipText(const FootEstimate& foot) {
  switch (foot.tip_from) {
    case SoleEnd::kMarker:
      return "front end at the foremost marker";
    case SoleEnd::kCop:
      return fmt::format("front end {} mm before the foremost 5 % of the centre of pressure",
                         Mm(SoleRules::kBeyondCop));
    case SoleEnd::kRatio:
      return fmt::format("front end so that the toes' joint is at {} of the length (ANSUR II)",
                         SoleRules::kBall);
  }
  return "";
}

std::string WidthSentence(const FootEstimate& foot, std::size_t patch) {
  if (patch == 2) return "width: as the forefoot";
  switch (foot.patches[patch].width_from) {
    case SoleWidth::kMarkers:
      return fmt::format("width: between the markers at both sides, less {} mm at each",
                         Mm(SoleRules::kMarkerStandOff));
    case SoleWidth::kCop:
      return fmt::format("width: the path of the centre of pressure and {} mm beside it",
                         Mm(SoleRules::kInsideSides));
    case SoleWidth::kRatio:
      return patch == 0 ? fmt::format("width: {} of the length (heel, ANSUR II)", SoleRules::kHeelBreadth)
                        : fmt::format("width: {} of the length (breadth, ANSUR II)", SoleRules::kBreadth);
  }
  return "";
}

std::string StandText(const FlatStand& stand) {
  return fmt::format(
      "{} frames, {:.2f} rad/s; the floor's direction scatters by {:.1f} degrees, its height by {} mm",
      stand.frames, stand.turning, stand.tilt_scatter * kDegrees, Mm(stand.height_scatter));
}

std::string FootComment(const ProposedFoot& foot) {
  const FootEstimate& e = foot.estimate;
  std::string text =
      Comment(fmt::format("'{}'{}: {}.", Join(foot.bodies, "' and '"),
                          foot.source == SoleSource::kNoPlate ? "" : " on " + Join(foot.plates, ", "),
                          SourceOf(foot)),
              4);
  text +=
      Comment(fmt::format("Plane: the floor seen from '{}' while the loaded foot turns slowest ({}). It is "
                          "{:.1f} degrees off the body's own axes.",
                          foot.bodies.front(), StandText(e.flat), e.flat.tilt * kDegrees),
              4);
  if (foot.bodies.size() > 1) {
    text +=
        Comment(e.toes_alone ? fmt::format("Plane of '{}': the same while it carries load ({}).",
                                           foot.bodies.back(), StandText(e.toes_flat))
                             : fmt::format("Plane of '{}': in those frames too; under load it does not rest.",
                                           foot.bodies.back()),
                4);
  }
  text += Comment(
      fmt::format(
          "Length {} mm: {}; {}. Ball at {}. Rearfoot and forefoot meet half way: the arch carries too "
          "(Cavanagh and Rodgers 1987).",
          Mm(e.length), HeelText(e), TipText(e),
          e.ball_from == SoleEnd::kMarker ? std::string("the toes' joint")
                                          : fmt::format("{} of the length (ANSUR II)", SoleRules::kBall)),
      4);
  return text;
}

std::string RegionYaml(const ProposedRegion& r, const FootEstimate& foot) {
  std::string text = fmt::format("    - name: {}\n", Quoted(r.name));
  text += fmt::format("      body: {}\n", Quoted(r.body));
  text += fmt::format("      plate: {}\n", Quoted(r.plate));
  text +=
      fmt::format("      position: [{:.4f}, {:.4f}, {:.4f}]     # centre of the patch, in its plane [m]\n",
                  r.position.x(), r.position.y(), r.position.z());
  text +=
      fmt::format("      orientation: [{:.4f}, {:.4f}, {:.4f}]  # of the plane, and along the foot [rad]\n",
                  r.orientation.x(), r.orientation.y(), r.orientation.z());
  text += fmt::format(
      "      mesh: {{box: {{size: [{:.4f}, {:.4f}, {:.4f}], strips: [{}, {}]}}}}  # {}; {} springs along the "
      "sole\n",
      r.size.x(), r.size.y(), r.size.z(), r.strips[0], r.strips[1], WidthSentence(foot, r.patch),
      SoleRules::kSpringsAlong);
  return text;
}

std::string BeltComment(const BeltVelocity& belt) {
  return fmt::format(
      "{} of flat feet in {} stances move at {:.3f} m/s along x and {:.3f} along z; a component of less than "
      "three "
      "standard errors ({:.3f}, {:.3f}) is no belt.",
      belt.by_markers ? "Markers" : "Bodies", belt.stances, belt.found_x, belt.found_z, belt.error_x,
      belt.error_z);
}

std::string FloorVelocityYaml(const BeltVelocity& belt) {
  std::string text = fmt::format("  floor_velocity: [{:.3f}, {:.3f}]  # [m/s]\n", belt.x, belt.z);
  if (belt.x != 0 || belt.z != 0)
    text += fmt::format(
        "  floor_velocity_error: [{:.3f}, {:.3f}]  # standard deviation [m/s]: the fit estimates the "
        "velocity; 0: known exactly\n",
        belt.x != 0 ? belt.error_x : 0, belt.z != 0 ? belt.error_z : 0);
  return text;
}

std::string FindingText(const PlateFinding& f) {
  const std::string where = fmt::format("trial '{}', plate '{}': ", f.trial, f.plate);
  switch (f.found.fault) {
    case PlateFault::kNone:
      return "";
    case PlateFault::kNotLoaded:
      return where + "never loaded with a twentieth of body weight: no foot touches it";
    case PlateFault::kPartial:
      return where + "the record begins or ends within the stance; expected a whole one (sinew data stances)";
    case PlateFault::kUpsideDown:
      return where +
             "its vertical force points down; expected the force on the foot, y up: is it upside down?";
    case PlateFault::kNoFoot:
      return where +
             fmt::format("no foot is on it: the nearest body '{}' is {:.2f} m from its centre of pressure",
                         f.body, f.found.distance);
    case PlateFault::kTurned:
      return where +
             fmt::format(
                 "its centre of pressure is under '{}' only if its x and z are {}: its axes are turned",
                 f.body, f.found.axes);
    case PlateFault::kMillimetres:
      return where + fmt::format("its centre of pressure is under '{}' only if it is in mm, not m", f.body);
    case PlateFault::kTwoFeet:
      return where + fmt::format(
                         "two feet: its centre of pressure is nearest to '{}' in {:.0f} % of the stance, "
                         "else to '{}'",
                         f.other_body, 100 * f.found.share, f.body);
    case PlateFault::kCopAcross:
      return where +
             fmt::format("its centre of pressure moves across '{}', not along it: axes turned by 90 degrees?",
                         f.body);
    case PlateFault::kForceAcross:
      return where +
             fmt::format(
                 "its horizontal force brakes and drives across '{}', not along it: axes turned by 90 "
                 "degrees?",
                 f.body);
    case PlateFault::kForceReversed:
      return where + fmt::format("its horizontal force drives '{}' first and brakes it later: reversed axes?",
                                 f.body);
  }
  return "";
}

}  // namespace

std::string SolesYaml(const SoleProposal& proposal, const std::string& data, const std::string& model) {
  std::string text = Comment(
      fmt::format(
          "Proposed by `sinew data soles` from {}. Geometry is from training trials. ANSUR II: Gordon et al. "
          "2014, 2012 Anthropometric Survey of U.S. Army Personnel, NATICK/TR-15/007 (6068 people).",
          data),
      0);
  text += "contact:\n";
  text += fmt::format("  model: {}\n", Quoted(model));
  text += fmt::format("  floor_height: {:.4f}  # as stated (--floor-height) [m]\n", proposal.floor_height);
  text += Comment(BeltComment(proposal.belt), 2);
  text += FloorVelocityYaml(proposal.belt);
  text +=
      "  transition_velocity: 0.05  # of the friction [m/s]: as fast as markers let a standing foot slide "
      "(Jackson et "
      "al. 2016)\n";
  text += Comment(proposal.not_fit.empty() ? "Every plate measures all channels."
                                           : fmt::format("Not measured by every plate, or constant: {}.",
                                                         Join(proposal.not_fit, ", ")),
                  2);
  text += fmt::format("  fit: [{}]\n", Join(proposal.fit, ", "));
  text += "  motion_errors: {}  # how far the motion may deviate: from the residuals of the foot's markers\n";
  text += "  regions:\n";
  std::size_t last = proposal.feet.size();
  for (const ProposedRegion& region : proposal.regions) {
    const ProposedFoot& foot = proposal.feet[region.foot];
    if (region.foot != last) text += FootComment(foot);
    last = region.foot;
    text += RegionYaml(region, foot.estimate);
  }
  text += "  parameters:\n";
  text += Comment(
      "Wide: from foam to a hard floor. The search starts where the largest load presses all patches of a "
      "foot in "
      "by a hundredth of its length; it has several minima, so try several starts. The foot had sunk in when "
      "the "
      "floor under it was seen: sole_height takes that up (its range is 0.05 m both ways); sole_forward and "
      "sole_outward "
      "take up where markers and model place the foot on the floor.",
      4);
  text += fmt::format("    stiffness: {{lower: 1.0e4, upper: 1.0e9, start: {:.1e}}}  # [N/m3]\n",
                      std::clamp(proposal.stiffness_start, 1e4, 1e9));
  text += "    dissipation: {lower: 0, upper: 50, start: 1}  # [s/m]\n";
  for (const char* place : kSolePlaceNames) text += fmt::format("    {}: {{}}\n", place);
  return text;
}

std::vector<std::string> SolesNotes(const SoleProposal& proposal) {
  std::vector<std::string> notes;
  for (const PlateFinding& finding : proposal.findings) notes.push_back(FindingText(finding));
  for (const std::string& skipped : proposal.skipped) notes.push_back(skipped);
  return notes;
}

std::string SolesText(const SoleProposal& proposal) {
  std::vector<std::vector<std::string>> rows{
      {"region", "body", "plate", "length [mm]", "width [mm]", "angles [deg]", "springs"}};
  for (const ProposedRegion& r : proposal.regions) {
    rows.push_back({r.name, r.body, r.plate, fmt::format("{:.0f}", 1e3 * r.size.x()),
                    fmt::format("{:.0f}", 1e3 * r.size.z()),
                    fmt::format("{:.1f} {:.1f} {:.1f}", kDegrees * r.orientation.x(),
                                kDegrees * r.orientation.y(), kDegrees * r.orientation.z()),
                    std::to_string(2 * r.strips[0] * r.strips[1])});
  }
  std::string text = Table(rows, 0);
  for (const ProposedFoot& foot : proposal.feet)
    text += Wrapped(fmt::format("{}: {}", foot.bodies.front(), SourceOf(foot)), 0);
  text += Wrapped(BeltComment(proposal.belt), 0);
  return text;
}

nlohmann::ordered_json SolesJson(const SoleProposal& proposal) {
  using Json = nlohmann::ordered_json;
  const auto vector = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
  const auto stand = [](const FlatStand& s) {
    return Json{{"frames", s.frames},
                {"tilt_rad", s.tilt},
                {"tilt_scatter_rad", s.tilt_scatter},
                {"height_scatter_m", s.height_scatter},
                {"turning_rad_per_s", s.turning}};
  };
  Json json{{"schema", "sinew.soles/1"}, {"floor_height_m", proposal.floor_height}};
  json["feet"] = Json::array();
  for (const ProposedFoot& foot : proposal.feet) {
    const FootEstimate& e = foot.estimate;
    json["feet"].push_back({{"bodies", foot.bodies},
                            {"plates", foot.plates},
                            {"source", SourceName(foot.source)},
                            {"other", foot.other},
                            {"differs_rad", foot.differs_angle},
                            {"differs_m", foot.differs_height},
                            {"trials", e.trials},
                            {"length_m", e.length},
                            {"heel_from", EndText(e.heel_from)},
                            {"front_from", EndText(e.tip_from)},
                            {"flat", stand(e.flat)},
                            {"toes_flat", foot.bodies.size() > 1 ? stand(e.toes_flat) : Json()},
                            {"toes_own_plane", e.toes_alone}});
  }
  json["regions"] = Json::array();
  for (const ProposedRegion& r : proposal.regions) {
    json["regions"].push_back(
        {{"name", r.name},
         {"body", r.body},
         {"plate", r.plate},
         {"position_m", vector(r.position)},
         {"orientation_rad", vector(r.orientation)},
         {"size_m", vector(r.size)},
         {"strips", r.strips},
         {"width_from", WidthText(proposal.feet[r.foot].estimate.patches[r.patch].width_from)}});
  }
  const BeltVelocity& belt = proposal.belt;
  json["floor_velocity_m_per_s"] = {belt.x, belt.z};
  json["floor_velocity_found_m_per_s"] = {belt.found_x, belt.found_z};
  json["floor_velocity_error_m_per_s"] = {belt.error_x, belt.error_z};
  json["fit"] = proposal.fit;
  json["not_fit"] = proposal.not_fit;
  json["findings"] = Json::array();
  for (const PlateFinding& f : proposal.findings) {
    json["findings"].push_back({{"trial", f.trial},
                                {"plate", f.plate},
                                {"fault", ToString(f.found.fault)},
                                {"message", FindingText(f)}});
  }
  json["skipped"] = proposal.skipped;
  return json;
}

}  // namespace sinew
