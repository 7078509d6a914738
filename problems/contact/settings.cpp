#include "problems/contact/settings.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/text.h"

namespace sinew {

const std::vector<std::string> kContactChannels{"force_x", "force_y", "force_z",
                                                "cop_x",   "cop_z",   "moment_y"};

std::string PlateChannelUnit(const std::string& channel) {
  if (channel == "moment_y") return "N*m";
  return channel.rfind("cop", 0) == 0 ? "m" : "N";
}

const std::array<const char*, kSolePlaces> kSolePlaceNames{"sole_forward", "sole_height", "sole_outward"};

namespace {

// Ranges of the thesis for k and c of a robot's sole are narrower (1e4..1e6 N/m3, 10..600 s/m); a person's
// shoe needs more stiffness and any dissipation.
const std::map<std::string, ParameterRange> kDefaultRanges{
    {"stiffness", {1e4, 1e9, 1e6}},     {"dissipation", {0, 600, 10}},      {"static_friction", {0, 15, 0.8}},
    {"dynamic_friction", {0, 15, 0.5}}, {"viscous_friction", {0, 15, 0.1}},
};

// Where a model's foot has its sole is known to a few centimetres.
constexpr ParameterRange kRangeOfSolePlace{-0.05, 0.05, 0};
constexpr double kMostFloorVelocityError = 1;  // [m/s]

Result<Vec3> ReadVec3(const YamlReader& yaml, const std::string& key, const Vec3& fallback) {
  if (!yaml.Has(key)) return fallback;
  SINEW_ASSIGN(const YamlReader value, yaml.At(key));
  SINEW_ASSIGN(const auto numbers, value.Numbers(3));
  return Vec3(numbers[0], numbers[1], numbers[2]);
}

Result<std::pair<int, int>> ReadStrips(const YamlReader& mesh) {
  SINEW_ASSIGN(const YamlReader strips, mesh.At("strips"));
  SINEW_ASSIGN(const auto items, strips.Items());
  if (items.size() != 2) return FailAt(mesh.file(), strips.line(), "strips: expected two whole numbers");
  SINEW_ASSIGN(const long along_x, items[0].Integer());
  SINEW_ASSIGN(const long along_z, items[1].Integer());
  return std::pair{static_cast<int>(std::clamp(along_x, -1L, 100000L)),
                   static_cast<int>(std::clamp(along_z, -1L, 100000L))};
}

Result<ContactMesh> ReadBox(const YamlReader& box) {
  SINEW_TRY(box.OnlyKeys({"size", "strips"}));
  SINEW_TRY(box.At("size"));
  SINEW_ASSIGN(const Vec3 size, ReadVec3(box, "size", Vec3::Zero()));
  SINEW_ASSIGN(const auto strips, ReadStrips(box));
  return BoxMesh(size, strips.first, strips.second);
}

Result<ContactMesh> ReadOutline(const YamlReader& outline) {
  SINEW_TRY(outline.OnlyKeys({"corners", "thickness", "strips"}));
  SINEW_ASSIGN(const YamlReader list, outline.At("corners"));
  SINEW_ASSIGN(const auto items, list.Items());
  std::vector<std::array<double, 2>> corners;
  for (const YamlReader& item : items) {
    SINEW_ASSIGN(const auto corner, item.Numbers(2));
    corners.push_back({corner[0], corner[1]});
  }
  SINEW_ASSIGN(const YamlReader thickness_value, outline.At("thickness"));
  SINEW_ASSIGN(const double thickness, thickness_value.Number());
  SINEW_ASSIGN(const auto strips, ReadStrips(outline));
  return OutlineMesh(corners, thickness, strips.first, strips.second);
}

Result<ContactMesh> ReadObjMesh(const YamlReader& obj, const std::map<std::string, std::string>& files) {
  SINEW_TRY(obj.OnlyKeys({"file", "scale"}));
  SINEW_ASSIGN(const YamlReader name_value, obj.At("file"));
  SINEW_ASSIGN(const std::string name, name_value.Text());
  SINEW_ASSIGN(const double scale, obj.NumberOr("scale", 1));
  const auto file = files.find(name);
  if (file == files.end()) {
    return FailAt(obj.file(), name_value.line(), "the data set holds no file '{}': import it first", name);
  }
  return ReadObj(file->second, name, scale);
}

Result<ContactMesh> ReadMesh(const YamlReader& mesh, const std::map<std::string, std::string>& files) {
  SINEW_TRY(mesh.OnlyKeys({"box", "outline", "obj"}));
  SINEW_ASSIGN(const auto keys, mesh.Keys());
  if (keys.size() != 1) return FailAt(mesh.file(), mesh.line(), "mesh: expected one of box, outline, obj");
  SINEW_ASSIGN(const YamlReader shape, mesh.At(keys.front()));
  Result<ContactMesh> read = keys.front() == "box"       ? ReadBox(shape)
                             : keys.front() == "outline" ? ReadOutline(shape)
                                                         : ReadObjMesh(shape, files);
  const bool has_place = !read && read.error().message.rfind(mesh.file() + ":", 0) == 0;
  if (!read && !has_place) return FailAt(mesh.file(), shape.line(), "{}", read.error().message);
  return read;
}

Result<ContactRegionSettings> ReadRegion(const YamlReader& yaml,
                                         const std::map<std::string, std::string>& files) {
  SINEW_TRY(yaml.OnlyKeys({"name", "body", "plate", "group", "position", "orientation", "springs", "mesh"}));
  ContactRegionSettings settings;
  for (const auto& [key, target] : {std::pair{"name", &settings.region.name},
                                    std::pair{"body", &settings.body}, std::pair{"plate", &settings.plate}}) {
    SINEW_ASSIGN(const YamlReader value, yaml.At(key));
    SINEW_ASSIGN(*target, value.Text());
  }
  SINEW_ASSIGN(settings.group, yaml.TextOr("group", "sole"));
  SINEW_ASSIGN(settings.region.position, ReadVec3(yaml, "position", Vec3::Zero()));
  SINEW_ASSIGN(const Vec3 angles, ReadVec3(yaml, "orientation", Vec3::Zero()));
  settings.region.rotation =
      (Eigen::AngleAxisd(angles.x(), Vec3::UnitX()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
       Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()))
          .toRotationMatrix();
  SINEW_ASSIGN(const YamlReader mesh, yaml.At("mesh"));
  SINEW_ASSIGN(settings.region.mesh, ReadMesh(mesh, files));
  SINEW_ASSIGN(const std::string springs, yaml.TextOr("springs", "bottom"));
  if (springs != "bottom" && springs != "all") {
    return FailAt(yaml.file(), yaml.line(), "springs: '{}', expected bottom or all", springs);
  }
  settings.region.springs = springs == "all" ? SpringFaces::kAll : SpringFaces::kBottom;
  if (settings.region.SpringFaceIndices().empty()) {
    return FailAt(mesh.file(), mesh.line(),
                  "mesh: no face looks down (along -y); turn it, or set springs: all");
  }
  return settings;
}

Result<ContactObjective> ReadObjective(const YamlReader& yaml) {
  const bool likelihood = yaml.Has("motion_errors");
  SINEW_ASSIGN(const std::string name, yaml.TextOr("objective", likelihood ? "likelihood" : "normalised"));
  const std::vector<std::string> names{"thesis", "normalised", "likelihood"};
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    SINEW_ASSIGN(const YamlReader value, yaml.At("objective"));
    return FailAt(yaml.file(), value.line(), "objective '{}' does not exist{}", name,
                  Suggestion(name, names));
  }
  if (likelihood && name != "likelihood") {
    SINEW_ASSIGN(const YamlReader value, yaml.At("objective"));
    return FailAt(
        yaml.file(), value.line(),
        "objective '{}': motion_errors are weighed against forces by the accuracy of both, which takes "
        "objective likelihood",
        name);
  }
  return static_cast<ContactObjective>(found - names.begin());
}

Status ReadRanges(const YamlReader& yaml, std::map<std::string, ParameterRange>& ranges) {
  std::vector<std::string> names;
  for (const auto& [name, range] : ranges) names.push_back(name);
  for (const char* place : kSolePlaceNames) names.emplace_back(place);
  SINEW_TRY(yaml.OnlyKeys(names));
  const auto is_place = [](const std::string& name) {
    return std::find(kSolePlaceNames.begin(), kSolePlaceNames.end(), name) != kSolePlaceNames.end();
  };
  for (const char* place : kSolePlaceNames) {
    if (yaml.Has(place)) ranges[place] = kRangeOfSolePlace;
  }
  for (auto& [name, range] : ranges) {
    if (!yaml.Has(name)) continue;
    SINEW_ASSIGN(const YamlReader entry, yaml.At(name));
    SINEW_TRY(entry.OnlyKeys({"lower", "upper", "start"}));
    SINEW_ASSIGN(range.lower, entry.NumberOr("lower", range.lower));
    SINEW_ASSIGN(range.upper, entry.NumberOr("upper", range.upper));
    SINEW_ASSIGN(range.start, entry.NumberOr("start", range.start));
    if (range.lower < 0 && !is_place(name)) {
      return FailAt(entry.file(), entry.line(),
                    "{}: lower {}, expected 0 or more: nothing physical is negative here", name, range.lower);
    }
    if (!(range.lower < range.upper && range.start >= range.lower && range.start <= range.upper)) {
      return FailAt(entry.file(), entry.line(), "{}: expected lower {} <= start {} <= upper {}", name,
                    range.lower, range.start, range.upper);
    }
  }
  return {};
}

Result<ContactAccuracy> ReadAccuracy(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"force", "cop", "moment"}));
  ContactAccuracy accuracy;
  for (const auto& [key, target] : {std::pair{"force", &accuracy.force}, std::pair{"cop", &accuracy.cop},
                                    std::pair{"moment", &accuracy.moment}}) {
    if (!yaml.Has(key)) continue;
    SINEW_ASSIGN(const YamlReader entry, yaml.At(key));
    SINEW_ASSIGN(const double value, entry.Number());
    if (!(value > 0)) return FailAt(entry.file(), entry.line(), "{}: {}, expected above 0", key, value);
    *target = value;
  }
  return accuracy;
}

template <class Member>
std::vector<std::string> Distinct(const std::vector<ContactRegionSettings>& regions, Member member) {
  std::vector<std::string> names;
  for (const auto& region : regions) {
    if (std::find(names.begin(), names.end(), region.*member) == names.end()) names.push_back(region.*member);
  }
  return names;
}

}  // namespace

const std::map<std::string, ParameterRange>& DefaultContactRanges() {
  return kDefaultRanges;
}

const char* ToString(ContactObjective objective) {
  switch (objective) {
    case ContactObjective::kThesis:
      return "thesis";
    case ContactObjective::kNormalised:
      return "normalised";
    case ContactObjective::kLikelihood:
      return "likelihood";
  }
  return "?";
}

std::vector<std::string> ContactSettings::Groups() const {
  return Distinct(regions, &ContactRegionSettings::group);
}
std::vector<std::string> ContactSettings::Plates() const {
  return Distinct(regions, &ContactRegionSettings::plate);
}

std::array<double, 2> ContactSettings::FloorVelocityError() const {
  if (floor_velocity_error) return *floor_velocity_error;
  return {floor.velocity_x == 0 ? 0 : kStandingFoot, floor.velocity_z == 0 ? 0 : kStandingFoot};
}

std::vector<int> ContactSettings::SolePlaces() const {
  std::vector<int> places;
  for (int place = 0; place < kSolePlaces; ++place) {
    if (parameters.count(kSolePlaceNames[static_cast<std::size_t>(place)]) > 0) places.push_back(place);
  }
  return places;
}

Result<ContactSettings> ReadContactSettings(const YamlReader& yaml,
                                            const std::map<std::string, std::string>& files) {
  SINEW_TRY(yaml.OnlyKeys({"model", "floor_height", "floor_velocity", "floor_velocity_error",
                           "transition_velocity", "objective", "fit", "cop_force_share", "motion_errors",
                           "accuracy", "regions", "parameters"}));
  ContactSettings settings;
  settings.parameters = kDefaultRanges;
  SINEW_ASSIGN(settings.model, yaml.TextOr("model", settings.model));
  SINEW_ASSIGN(settings.floor.height, yaml.NumberOr("floor_height", settings.floor.height));
  if (yaml.Has("floor_velocity")) {
    SINEW_ASSIGN(const YamlReader velocity, yaml.At("floor_velocity"));
    SINEW_ASSIGN(const auto numbers, velocity.Numbers(2));
    settings.floor.velocity_x = numbers[0];
    settings.floor.velocity_z = numbers[1];
  }
  if (yaml.Has("floor_velocity_error")) {
    SINEW_ASSIGN(const YamlReader errors, yaml.At("floor_velocity_error"));
    SINEW_ASSIGN(const auto numbers, errors.Numbers(2));
    for (const double error : numbers) {
      if (!(error >= 0 && error <= kMostFloorVelocityError))
        return FailAt(errors.file(), errors.line(), "floor_velocity_error: {} m/s, expected 0 to {}", error,
                      kMostFloorVelocityError);
    }
    settings.floor_velocity_error = {numbers[0], numbers[1]};
  }
  SINEW_ASSIGN(settings.cop_force_share, yaml.NumberOr("cop_force_share", settings.cop_force_share));
  SINEW_ASSIGN(settings.transition_velocity,
               yaml.NumberOr("transition_velocity", settings.transition_velocity));
  if (!(settings.transition_velocity > 0)) {
    return FailAt(yaml.file(), yaml.line(), "transition_velocity: {} m/s, expected above 0",
                  settings.transition_velocity);
  }
  SINEW_ASSIGN(settings.objective, ReadObjective(yaml));
  if (yaml.Has("motion_errors")) {
    SINEW_ASSIGN(const YamlReader errors, yaml.At("motion_errors"));
    SINEW_ASSIGN(settings.motion_errors, ReadMotionErrors(errors));
  }
  if (yaml.Has("accuracy")) {
    SINEW_ASSIGN(const YamlReader accuracy, yaml.At("accuracy"));
    SINEW_ASSIGN(settings.accuracy, ReadAccuracy(accuracy));
  }
  if (yaml.Has("fit")) {
    SINEW_ASSIGN(const YamlReader fit, yaml.At("fit"));
    SINEW_ASSIGN(settings.fit, fit.Texts());
    for (const std::string& channel : settings.fit) {
      if (std::find(kContactChannels.begin(), kContactChannels.end(), channel) == kContactChannels.end()) {
        return FailAt(fit.file(), fit.line(), "fit: channel '{}' does not exist{}", channel,
                      Suggestion(channel, kContactChannels));
      }
    }
    if (settings.fit.empty()) return FailAt(fit.file(), fit.line(), "fit: expected at least one channel");
  }
  if (yaml.Has("parameters")) {
    SINEW_ASSIGN(const YamlReader ranges, yaml.At("parameters"));
    SINEW_TRY(ReadRanges(ranges, settings.parameters));
  }
  SINEW_ASSIGN(const YamlReader regions, yaml.At("regions"));
  SINEW_ASSIGN(const auto items, regions.Items());
  if (items.empty()) return FailAt(regions.file(), regions.line(), "regions: expected at least one");
  long faces = 0;
  for (const YamlReader& item : items) {
    SINEW_ASSIGN(auto region, ReadRegion(item, files));
    const std::string& name = region.region.name;
    if (name.empty()) return FailAt(item.file(), item.line(), "regions: a region has no name");
    for (const ContactRegionSettings& other : settings.regions) {
      if (other.region.name != name) continue;
      return FailAt(item.file(), item.line(), "regions: the name '{}' is used twice", name);
    }
    faces += region.region.mesh.face_count();
    if (faces > kMostMeshFaces)
      return FailAt(item.file(), item.line(), "regions: their meshes have more than {} triangles in all",
                    kMostMeshFaces);
    settings.regions.push_back(std::move(region));
  }
  return settings;
}

}  // namespace sinew
